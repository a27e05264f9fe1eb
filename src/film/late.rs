//! The later half of a pixel's samples, summed apart.

/// Sums over the later half of a pixel's samples: those from the largest power of two on that is
/// below their number. What the halves differ by tells the noise of their mean whatever links the
/// samples (see [`super::variance`]).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Late {
    /// The first sample of the image among them: 0 or a power of two.
    pub from: u64,
    /// Sum of worth times weight times radiance.
    pub radiance: [f64; 3],
    /// Sum of worth.
    pub worth: f64,
    /// Sum of its squares.
    pub worth_squares: f64,
}

impl Late {
    /// Of no samples.
    pub const EMPTY: Late = Late {
        from: 0,
        radiance: [0.0; 3],
        worth: 0.0,
        worth_squares: 0.0,
    };

    /// The later half of `samples` samples of the image starts with this one.
    pub fn begin(samples: u64) -> u64 {
        match samples {
            0 | 1 => 0,
            _ => 1 << (samples - 1).ilog2(),
        }
    }

    /// Adds a sample's `values`, already weighted.
    #[inline]
    pub(super) fn add(&mut self, values: [f64; 3], worth: f64) {
        for (sum, value) in self.radiance.iter_mut().zip(values) {
            *sum += value;
        }
        self.worth += worth;
        self.worth_squares += worth * worth;
    }

    /// Forgets what is of the earlier half by the time that sample number `index` comes.
    #[inline]
    pub(super) fn advance(&mut self, index: u64) {
        let from = Self::begin(index + 1);
        if from > self.from {
            *self = Self {
                from,
                ..Self::EMPTY
            };
        }
    }
}
