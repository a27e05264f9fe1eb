//! What reading a file tells of its texels as a whole.

use crate::image::header::Level;
use crate::math::Rgb;

/// What reading the finest level brings to light, apart from the texels.
#[derive(Default)]
pub(super) struct Census {
    sum: [f64; 3],
    largest: f32,
    pub bad: u64,
}

/// The same, summed up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Survey {
    /// Mean of all texels.
    pub mean: Rgb,
    /// The largest number of any channel; 0 if all are negative.
    pub largest: f32,
    /// Texels that held something else than a value.
    pub bad: u64,
}

impl Census {
    pub fn add(&mut self, texel: &[f32]) {
        for (sum, x) in self.sum.iter_mut().zip(texel) {
            *sum += f64::from(*x);
            self.largest = self.largest.max(*x);
        }
    }

    pub fn summary(&self, size: Level, grey: bool) -> Survey {
        Survey {
            mean: self.mean(size, grey),
            largest: self.largest,
            bad: self.bad,
        }
    }

    fn mean(&self, size: Level, grey: bool) -> Rgb {
        let n = f64::from(size.width) * f64::from(size.height);
        let [r, g, b] = self.sum.map(|s| (s / n) as f32);
        if grey {
            Rgb::splat(r)
        } else {
            Rgb::new(r, g, b)
        }
    }
}
