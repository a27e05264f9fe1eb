//! How noisy the film is: what `--noise` waits for.
//!
//! The measure is relative: the variance of a pixel's mean over the square of its value, averaged over
//! pixels and channels. Its plain mean is at the mercy of the brightest speck: one sample of 1e6 in a
//! corner would keep a clean image rendering for ever, and a median over sub-buffers, the usual remedy,
//! takes several films. Here the noisiest [`TRIM`] of the numbers are left out instead. Specks are by
//! nature few, so that what is left is what an eye, or an outlier-proof metric, sees; and where noise is
//! even the share is too small to matter (the tests say how little).

use super::Film;

/// Share of the numbers, the largest, that are left out.
const TRIM: f64 = 1e-3;
/// Added to the square of a value, so that black pixels do not count for everything: relMSE's usual.
pub const FLOOR: f64 = 0.01;

impl Film {
    /// Noise of the image: the square root of the mean over pixels and channels of
    /// `variance / (value^2 + 0.01)`, without the noisiest 0.1 %. It is the root of the relMSE that a
    /// comparison with the converged image is expected to show. `None` below two samples a pixel.
    ///
    /// Takes a moment: two passes over the film and 4 bytes a number.
    pub fn noise(&self) -> Option<f32> {
        let fewest = self.pixels().map(|p| p.count).min()?;
        if fewest < 2 {
            return None;
        }
        let mut sorted: Vec<f32> = self.relative_variances().map(|x| x as f32).collect();
        let kept = sorted.len() - (sorted.len() as f64 * TRIM) as usize;
        let (_, limit, _) = sorted.select_nth_unstable_by(kept - 1, f32::total_cmp);
        let limit = *limit;
        // In film order, whatever the selection did to the order above: the same bits every time.
        let below = self.relative_variances().filter(|x| (*x as f32) < limit);
        let (count, sum) = below.fold((0, 0.0), |(n, sum), x| (n + 1, sum + x));
        // Those at the limit itself, of which there may be many.
        let at_limit = (kept - count) as f64 * f64::from(limit);
        Some(((sum + at_limit) / kept as f64).sqrt() as f32)
    }

    fn relative_variances(&self) -> impl Iterator<Item = f64> + '_ {
        self.pixels().flat_map(|pixel| {
            let (mean, variance) = (pixel.mean(), pixel.variance_of_mean());
            (0..3).map(move |c| variance[c] / (mean[c] * mean[c] + FLOOR))
        })
    }
}
