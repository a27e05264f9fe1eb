//! How many paths a pixel takes.

use std::ops::Range;

/// Samples of the image in a block: a pixel takes a whole number of paths for each block. (With one
/// path in 4, one in 2 or a whole number for each sample instead, rounding took most of what
/// spreading gains.)
pub const BLOCK: u8 = 8;
/// Paths of a pixel for a sample of the image, at least and at most.
pub const RANGE: [f32; 2] = [0.25, 16.0];

/// A pixel's share of the paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Paths that it took before.
    before: u32,
    /// Paths for a block of samples, and how early in it they come.
    many: u8,
    phase: u8,
}

/// The shares of a tile's pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct TileShares {
    pixels: Vec<Share>,
}

/// Those of all tiles, in their order.
pub type Shares = Vec<TileShares>;

impl Share {
    /// About `share` paths a sample after `before` others. Of two uniform numbers, one decides
    /// whether that is rounded up or down, so that the mean over many pixels is right, the other
    /// which samples rare paths belong to.
    pub fn new(share: f32, before: u32, u: [f32; 2]) -> Self {
        let block = f32::from(BLOCK);
        let many = share.clamp(RANGE[0], RANGE[1]) * block;
        Self {
            before,
            many: (many + u[0]) as u8,
            phase: (u[1] * block) as u8,
        }
    }

    /// Number of its first path.
    #[inline]
    pub fn begin(&self) -> u64 {
        u64::from(self.before)
    }

    /// The numbers of its paths for the sample that comes `after` others with this share.
    #[inline]
    pub fn paths(&self, after: u64) -> Range<u64> {
        let begin = self.taken(after);
        begin..self.taken(after + 1)
    }

    /// Paths that it has taken after so many samples with this share, and before.
    #[inline]
    pub fn taken(&self, after: u64) -> u64 {
        let begun = after * u64::from(self.many) + u64::from(self.phase);
        u64::from(self.before) + begun / u64::from(BLOCK)
    }

    /// What a path counts, in samples.
    #[inline]
    pub fn worth(&self) -> f32 {
        f32::from(BLOCK) / f32::from(self.many)
    }
}

impl TileShares {
    /// Of these pixels.
    pub fn new(pixels: Vec<Share>) -> Self {
        Self { pixels }
    }

    /// That of the tile's pixel `i`.
    #[inline]
    pub fn of(&self, i: usize) -> &Share {
        &self.pixels[i]
    }

    /// Paths of the whole tile for a sample, on average.
    pub fn per_sample(&self) -> f32 {
        self.pixels.iter().map(|p| p.worth().recip()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_numbered_without_gaps_and_count_as_many_samples_as_there_are() {
        for share in [0.1, 0.25, 0.3, 0.5, 0.8, 1.0, 1.5, 3.0, 15.5, 99.0] {
            for i in 0..64 {
                let share = Share::new(share, 7, [i as f32 / 64.0, (i % 8) as f32 / 8.0]);
                let mut next = 7;
                for after in 0..64 {
                    let paths = share.paths(after);
                    assert_eq!(paths.start, next, "{share:?}");
                    next = paths.end;
                }
                assert_eq!(next, share.taken(64));
                // Blocks count exactly as many samples as they have.
                let worth = (next - 7) as f32 * share.worth();
                assert!((worth - 64.0).abs() < 1e-4, "{share:?}: {worth}");
            }
        }
    }

    #[test]
    fn shares_are_right_on_average() {
        for share in [0.25, 0.4, 0.7, 1.0, 2.3, 7.9, 16.0] {
            let n = 1 << 14;
            let sum: f32 = (0..n)
                .map(|i| {
                    Share::new(share, 0, [(i as f32 + 0.5) / n as f32, 0.5])
                        .worth()
                        .recip()
                })
                .sum();
            assert!((sum / n as f32 - share).abs() < 1e-3 * share, "{share}");
        }
        let even = Share::new(1.0, 0, [0.3, 0.0]);
        assert_eq!((even.before, even.many, even.phase), (0, BLOCK, 0));
        assert_eq!(even.paths(5), 5..6);
        assert_eq!(even.worth(), 1.0);
    }

    #[test]
    fn rare_paths_of_a_tile_are_spread_over_the_samples() {
        let pixels = (0..4096).map(|i| Share::new(0.25, 0, [0.5, i as f32 / 4096.0]));
        let pixels: Vec<Share> = pixels.collect();
        for sample in 0..8 {
            let paths: u64 = pixels.iter().map(|p| p.paths(sample).count() as u64).sum();
            assert!((1000..1050).contains(&paths), "{paths} of 4096");
        }
    }
}
