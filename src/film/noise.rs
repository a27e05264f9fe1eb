//! How noisy the film is: what `--noise` waits for.
//!
//! The noise is the root of the mean over pixels and channels of
//!
//! ```text
//! variance / (value^2 + 0.01 mean^2)
//! ```
//!
//! without the largest [`TRIM`] of the terms: that is the root of the relMSE, trimmed alike, that
//! the film is expected to have against the converged image when both are scaled to a mean of one.
//! So it does not depend on the unit of light. (The mean is that of all but the brightest
//! [`SPECKS`].)
//!
//! - The variance is that of [`super::variance`].
//! - The value is between the pixel's own and the mean over [`WINDOW`] x [`WINDOW`] pixels, as
//!   James and Stein shrink means: the own one as far as it differs from the other by more than
//!   noise. A pixel's noisy value goes with its variance: where a rare bright path was met both are
//!   large, elsewhere both are small, and their ratio says little of the error in either place.
//! - Terms are trimmed because one sample of 1e6 in a corner would keep a clean image rendering for
//!   ever.
//!
//! tests/variance.rs compares it with true errors.

use super::Film;

/// Share of the numbers, the largest, that are left out.
const TRIM: f64 = 1e-3;
/// Added to the square of a value, so that black pixels do not count for everything: relMSE's
/// usual, for an image of mean 1.
pub const FLOOR: f64 = 0.01;
/// Side of the square of pixels over which values are averaged.
const WINDOW: usize = 9;
/// Share of the numbers, the brightest, that do not count for the image's mean: a speck fills a
/// window.
const SPECKS: f64 = 0.02;
/// The estimate is called unreliable when its own relative error is above this,
const MOST_ERROR: f32 = 0.2;
/// or when the terms left out have more than this share of the variance.
const MOST_WORST: f32 = 0.5;

/// The noise of a film.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Noise {
    /// Root of the expected trimmed relMSE.
    pub value: f32,
    /// Standard error of the value, as a share of it. It is large where a few pixels have most of
    /// the variance: the light that they have met is missing in others.
    pub error: f32,
    /// Share of the variance that the terms have which are left out.
    pub worst: f32,
}

impl Noise {
    /// The value and its standard error: what `--noise` compares.
    pub fn at_most(&self) -> f32 {
        self.value * (1.0 + self.error)
    }

    /// Whether the value can be relied on.
    pub fn is_reliable(&self) -> bool {
        self.error <= MOST_ERROR && self.worst <= MOST_WORST
    }
}

impl Film {
    /// Noise of the image; `None` below two samples a pixel.
    ///
    /// Takes a moment: four passes over the film and 16 bytes a number.
    pub fn noise(&self) -> Option<Noise> {
        let fewest = self.pixels().map(|p| p.count).min()?;
        if fewest < 2 {
            return None;
        }
        let terms = self.relative_variances();
        let left_out = (terms.len() as f64 * TRIM) as usize;
        let (sum, square) = trimmed_sums(&terms, left_out);
        let kept = terms.len() - left_out;
        let value = (sum / kept as f64).sqrt() as f32;
        // Each term is known to about itself where few samples make it: the sum's error is the root
        // of the sum of squares. The root halves it.
        let error = if sum > 0.0 {
            0.5 * square.sqrt() / sum
        } else {
            0.0
        };
        let all: f64 = terms.iter().map(|term| f64::from(*term)).sum();
        let worst = if all > 0.0 { 1.0 - sum / all } else { 0.0 };
        Some(Noise {
            value,
            error: error as f32,
            worst: worst as f32,
        })
    }

    /// The terms of the mean, tile by tile.
    fn relative_variances(&self) -> Vec<f32> {
        // Trimming is to find specks: pixels' own variances, which neighbours do not share.
        let variances = self.own_variances();
        let smoothing = self.smoothing(&[1.0; WINDOW]);
        let values = self.row_by_row(|_, pixel| pixel.mean());
        let values = values.map(|image| smoothing.apply(&image));
        let numbers = 3 * self.held_pixels() as usize;
        let floor = FLOOR * usual(&values.concat(), numbers).powi(2);
        let mut terms = Vec::with_capacity(numbers);
        for tile in &self.tiles {
            for (i, pixel) in tile.pixels.iter().enumerate() {
                let at = self.row_major(tile.place(i));
                let own = pixel.mean();
                terms.extend((0..3).map(|c| {
                    let variance = f64::from(variances[c][at]);
                    let value = shrunk(own[c], f64::from(values[c][at]), variance);
                    relative(variance, value, floor)
                }));
            }
        }
        terms
    }
}

/// Mean of the values without the brightest; `count` of them are not of missing tiles, which are 0.
fn usual(values: &[f32], count: usize) -> f64 {
    let brightest = (count as f64 * SPECKS) as usize;
    trimmed_sums(values, brightest).0 / (count - brightest) as f64
}

/// Sum of the terms and of their squares without the largest.
fn trimmed_sums(terms: &[f32], left_out: usize) -> (f64, f64) {
    let kept = terms.len() - left_out;
    let mut sorted = terms.to_vec();
    let (_, limit, _) = sorted.select_nth_unstable_by(kept - 1, f32::total_cmp);
    let limit = *limit;
    // In the given order, whatever the selection did to it above: the same bits every time.
    let (mut sum, mut square, mut below) = (0.0, 0.0, 0);
    for &term in terms.iter().filter(|term| **term < limit) {
        let term = f64::from(term);
        (sum, square, below) = (sum + term, square + term * term, below + 1);
    }
    // Those at the limit itself, of which there may be many.
    let at_limit = (kept - below) as f64;
    let limit = f64::from(limit);
    (sum + at_limit * limit, square + at_limit * limit * limit)
}

/// A value of this variance, shrunk towards the mean around it (James and Stein 1961, one
/// dimension).
fn shrunk(own: f64, around: f64, variance: f64) -> f64 {
    let distance = own - around;
    if distance * distance <= variance {
        return around;
    }
    around + distance * (1.0 - variance / (distance * distance))
}

/// A term; 0 where there is neither light nor variance.
fn relative(variance: f64, value: f64, floor: f64) -> f32 {
    let scale = value * value + floor;
    if variance > 0.0 && scale > 0.0 {
        (variance / scale).min(f64::from(f32::MAX)) as f32
    } else {
        0.0
    }
}
