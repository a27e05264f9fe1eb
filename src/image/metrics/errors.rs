//! Errors that are means over pixels and channels, in `f64`. I is the image, R the reference:
//!
//! | name | mean of |
//! |---|---|
//! | L1 | abs(I - R) |
//! | MSE | (I - R)^2; RMSE is its root |
//! | relMSE | (I - R)^2 / (R^2 + 0.01), after Rousselle et al. 2011 |
//!
//! One speck can outweigh the rest of an image in all of them, relMSE most of all: the trimmed
//! relMSE leaves out the worst 0.1 % of the pixels. What was left out is what [`super::fireflies`]
//! counts.
//!
//! The relMSE of the means over blocks of 4 x 4 and 16 x 16 pixels tells whether an error averages
//! out: noise that pixels have independently falls to a 16th and a 256th, blotches stay.

use super::Pair;
use crate::math::Rgb;

/// Keeps black pixels of the reference from counting for everything.
const FLOOR: f64 = 0.01;
/// One pixel in so many, the worst, is left out of the trimmed mean.
const TRIM: usize = 1000;
/// Sides of the blocks whose means are looked at, in pixels.
pub const BLOCKS: [usize; 2] = [4, 16];

/// The mean errors of an image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Mean absolute difference.
    pub l1: f64,
    /// Mean squared difference.
    pub mse: f64,
    /// Mean squared difference relative to the reference.
    pub rel_mse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub rel_mse_trimmed: f64,
    /// The same of the means over blocks of as many pixels as [`BLOCKS`] says, all of them; `None`
    /// where the image has no such block.
    pub rel_mse_of_blocks: [Option<f64>; 2],
    /// Mean of the image over mean of the reference, for red, green and blue. NaN where both are
    /// black.
    pub mean_ratio_rgb: [f64; 3],
    /// The same over all channels.
    pub mean_ratio: f64,
}

impl Errors {
    /// All of them.
    pub fn of(pair: &Pair) -> Self {
        let count = 3.0 * pair.image.len() as f64;
        let mut relative = relative_squares(pair);
        let rel_mse = mean(&relative);
        relative.sort_unstable_by(f64::total_cmp);
        let kept = &relative[..relative.len() - relative.len() / TRIM];
        let (image, reference) = (sums(&pair.image), sums(&pair.reference));
        Self {
            l1: pair.numbers().map(|(x, r)| (x - r).abs()).sum::<f64>() / count,
            mse: mse(pair),
            rel_mse,
            rel_mse_trimmed: mean(kept),
            rel_mse_of_blocks: BLOCKS
                .map(|side| Some(mean(&relative_squares(&pair.blocks(side)?)))),
            mean_ratio_rgb: [0, 1, 2].map(|c| image[c] / reference[c]),
            mean_ratio: image.iter().sum::<f64>() / reference.iter().sum::<f64>(),
        }
    }

    /// Root of the mean squared difference.
    pub fn rmse(&self) -> f64 {
        self.mse.sqrt()
    }
}

/// Mean squared difference.
pub fn mse(pair: &Pair) -> f64 {
    let sum: f64 = pair.numbers().map(|(x, r)| (x - r) * (x - r)).sum();
    sum / (3.0 * pair.image.len() as f64)
}

/// Peak signal-to-noise ratio in decibels, for numbers that span `data_range`; infinite where image
/// and reference are the same.
pub fn psnr(pair: &Pair, data_range: f64) -> f64 {
    10.0 * (data_range * data_range / mse(pair)).log10()
}

/// Squared differences relative to the reference, a number for each pixel.
fn relative_squares(pair: &Pair) -> Vec<f64> {
    let pixels = pair.image.iter().zip(&pair.reference);
    let of = |(x, r): (&Rgb, &Rgb)| (0..3).map(|c| relative_square(x[c], r[c])).sum::<f64>() / 3.0;
    pixels.map(of).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn relative_square(x: f32, r: f32) -> f64 {
    let (x, r) = (f64::from(x), f64::from(r));
    (x - r) * (x - r) / (r * r + FLOOR)
}

fn sums(pixels: &[Rgb]) -> [f64; 3] {
    let add = |sum: [f64; 3], p: &Rgb| {
        let p = p.to_array().map(f64::from);
        [sum[0] + p[0], sum[1] + p[1], sum[2] + p[2]]
    };
    pixels.iter().fold([0.0; 3], add)
}
