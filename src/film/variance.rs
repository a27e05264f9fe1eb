//! How far the film is from the converged image.
//!
//! From the spread of a pixel's samples, `S^2`, follows the variance of their mean if they are
//! independent: `S^2 / N`. It is not that of Sobol points, which avoid each other, nor does it tell
//! how the errors of neighbours go together where paths are shared. So the film keeps the sum over
//! the later half of the samples, too ([`super::Late`]), and compares the means of both halves.
//!
//! With the contrast `C = m_0 - m_1` of the halves' means, `r = C^2 / (S^2 (1/n_0 + 1/n_1))` has
//! the mean 1 for independent samples, whatever their distribution (the samples of both halves can
//! be exchanged). Its mean over a neighbourhood of many pixels, `rho`, tells how the samples are
//! linked.
//!
//! The variance of the mean is then `rho S^2 / N`. That is exact for halves that are independent of
//! each other. Those of one Sobol sequence avoid each other, in the dimensions in which they are
//! stratified: what such dimensions explain is small in the contrast, and yet smaller in the mean;
//! the rest, which is most of what is left of the variance of paths, is as in independent halves.
//! So for one sequence the variance is told rather too large than too small.
//!
//! A pixel that has missed a rare bright path knows neither its error nor that it does not know.
//! Its neighbours may: what is told of a pixel is the mean of its own variance and of those around
//! it.
//!
//! [`Tile::realisation`] is the contrast, scaled as the error of the mean: an image of noise like
//! that of the film, whose mean over any block has on average the square of the error that the
//! film's mean has there.
//!
//! tests/variance.rs holds all of it to the truth.

use super::{Film, Late, Pixel, Tile};
use crate::math::smooth::smooth;
use std::ops::AddAssign;

/// A pixel's variance is averaged with those around it by these weights on each axis.
const SMOOTH: [f32; 5] = [1.0, 2.0, 3.0, 2.0, 1.0];
/// Largest number of an image: sums over a window of 81 pixels stay finite.
const LARGEST: f64 = f32::MAX as f64 / 256.0;
/// Pixels of an average neighbourhood's ratio that the ratio of the whole film counts for.
const PRIOR: f64 = 64.0;
/// Variances of the means of a film's pixels over renders with other seeds.
#[derive(Clone, Debug)]
pub struct Variances {
    /// Channel by channel, row by row.
    channels: [Vec<f32>; 3],
}

/// The contrast between the halves of a pixel's samples.
struct Contrast {
    /// Difference between their means.
    difference: [f64; 3],
    /// Variance of that for a sample of variance 1, if samples are independent.
    scale: f64,
}

/// A kernel over the pixels that a film holds.
pub(super) struct Smoothing<'a> {
    kernel: &'a [f32],
    size: [usize; 2],
    /// Where some are missing: 1 for those held, and that smoothed.
    held: Option<(Vec<f32>, Vec<f32>)>,
}

/// Sums of ratios.
#[derive(Clone, Copy, Debug, Default)]
struct Ratios {
    sum: f64,
    count: f64,
}

impl AddAssign for Ratios {
    fn add_assign(&mut self, other: Self) {
        self.sum += other.sum;
        self.count += other.count;
    }
}

impl Contrast {
    /// That of a pixel after `done` samples of the image; `None` where a half has no samples.
    fn of(pixel: &Pixel, done: u64) -> Option<Self> {
        let late = &pixel.late;
        let worth = [pixel.worth - late.worth, late.worth];
        if late.from != Late::begin(done) || !(worth[0] > 0.0 && worth[1] > 0.0) {
            return None;
        }
        let squares = [pixel.worth_squares - late.worth_squares, late.worth_squares];
        let difference = std::array::from_fn(|c| {
            (pixel.radiance[c] - late.radiance[c]) / worth[0] - late.radiance[c] / worth[1]
        });
        let scale = squares[0] / (worth[0] * worth[0]) + squares[1] / (worth[1] * worth[1]);
        Some(Self { difference, scale })
    }
}

impl Ratios {
    /// Those of a tile.
    fn of(tile: &Tile) -> Self {
        let mut ratios = Self::default();
        for pixel in &tile.pixels {
            let Some(contrast) = Contrast::of(pixel, tile.done) else {
                continue;
            };
            let variance = pixel.variance_of_sample();
            for (difference, variance) in contrast.difference.iter().zip(variance) {
                let ratio = difference * difference / (variance * contrast.scale);
                if ratio.is_finite() {
                    ratios.sum += ratio;
                    ratios.count += 1.0;
                }
            }
        }
        ratios
    }
}

impl Film {
    /// The variances of its pixels. Takes some passes over the film.
    pub fn variances(&self) -> Variances {
        let mut channels = self.own_variances();
        let smoothing = self.smoothing(&SMOOTH);
        for own in &mut channels {
            let around = smoothing.apply(own);
            for (own, around) in own.iter_mut().zip(around) {
                *own = 0.5 * (*own + around);
            }
        }
        Variances { channels }
    }

    /// What each pixel's own samples tell of the variance of its mean, channel by channel, row by
    /// row.
    pub(super) fn own_variances(&self) -> [Vec<f32>; 3] {
        let linked = self.linked();
        self.row_by_row(|tile, pixel| pixel.variance_of_mean().map(|v| v * linked[tile]))
    }

    /// Variance of the mean over that of independent samples, tile by tile.
    fn linked(&self) -> Vec<f64> {
        let ratios: Vec<Ratios> = self.tiles.iter().map(Ratios::of).collect();
        let mut all = Ratios::default();
        ratios.iter().for_each(|r| all += *r);
        let usual = if all.count > 0.0 {
            all.sum / all.count
        } else {
            1.0
        };
        let around = |tile| {
            let mut near = Ratios {
                sum: PRIOR * usual,
                count: PRIOR,
            };
            self.tiles_around(tile).for_each(|i| near += ratios[i]);
            near.sum / near.count
        };
        (0..self.tiles.len()).map(around).collect()
    }

    /// A tile and its neighbours.
    fn tiles_around(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let across = self.width().div_ceil(super::TILE_SIZE) as usize;
        let rows = self.tiles.len() / across;
        let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
        let columns = near(tile % across, across);
        near(tile / across, rows).flat_map(move |y| columns.clone().map(move |x| y * across + x))
    }

    /// Numbers of each pixel, each kind row by row; 0 where the film holds no tile.
    pub(super) fn row_by_row<const N: usize>(
        &self,
        numbers: impl Fn(usize, &Pixel) -> [f64; N],
    ) -> [Vec<f32>; N] {
        let pixels = self.width() as usize * self.height() as usize;
        let mut images = std::array::from_fn(|_| vec![0.0; pixels]);
        for (number, tile) in self.tiles.iter().enumerate() {
            for (i, pixel) in tile.pixels.iter().enumerate() {
                let at = self.row_major(tile.place(i));
                for (image, number) in images.iter_mut().zip(numbers(number, pixel)) {
                    image[at] = number.min(LARGEST) as f32;
                }
            }
        }
        images
    }

    /// What smooths images of this film.
    pub(super) fn smoothing<'a>(&self, kernel: &'a [f32]) -> Smoothing<'a> {
        let size = [self.width() as usize, self.height() as usize];
        let some_are_missing = self.tiles.iter().any(|t| !t.is_held());
        let held = some_are_missing.then(|| {
            let [held] = self.row_by_row(|_, _| [1.0]);
            let weights = smooth(&held, size, kernel);
            (held, weights)
        });
        Smoothing { kernel, size, held }
    }
}

impl Smoothing<'_> {
    /// An image of the film, row by row, smoothed over the pixels that the film holds.
    pub(super) fn apply(&self, image: &[f32]) -> Vec<f32> {
        let mut smoothed = smooth(image, self.size, self.kernel);
        if let Some((held, weights)) = &self.held {
            for ((mean, held), weight) in smoothed.iter_mut().zip(held).zip(weights) {
                *mean = if *held > 0.0 { *mean / weight } else { 0.0 };
            }
        }
        smoothed
    }
}

impl Variances {
    /// Those of a pixel's channels; `at` counts the pixels of the film's region row by row.
    pub fn of(&self, at: usize) -> [f32; 3] {
        [0, 1, 2].map(|c| self.channels[c][at])
    }
}

impl Tile {
    /// A number of the size that the error of one of its pixels has. The mean of its square is the
    /// variance of the pixel's mean, and that of the square of its mean over any pixels the
    /// variance of theirs. 0 where a half of the samples is missing.
    pub fn realisation(&self, pixel: &Pixel) -> [f64; 3] {
        let Some(contrast) = Contrast::of(pixel, self.done) else {
            return [0.0; 3];
        };
        let mean = pixel.worth_squares / (pixel.worth * pixel.worth);
        let scale = (mean / contrast.scale).sqrt();
        contrast.difference.map(|d| d * scale)
    }
}
