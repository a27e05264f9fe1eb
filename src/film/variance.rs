//! How far the film is from the converged image.
//!
//! From the spread of a pixel's samples, `S^2`, follows the variance of their mean if they are independent:
//! `S^2 / N`. It is not that of Sobol points, which avoid each other, nor does it tell how the errors of
//! neighbours go together where paths are shared. So the film keeps the sum over the later half of the
//! samples, too ([`super::Late`]), and compares the means of both halves.
//!
//! With the contrast `C = m_0 - m_1` of the halves' means, `r = C^2 / (S^2 (1/n_0 + 1/n_1))` has the mean 1
//! for independent samples, whatever their distribution (the samples of both halves can be exchanged).
//! Its mean over a neighbourhood of many pixels, `rho`, tells how the samples are linked.
//!
//! - Halves of sequences of their own are independent: then the variance of the mean is `rho S^2 / N`.
//! - Halves of one sequence avoid each other: their contrast is larger than the error of their mean. By the
//!   law `V(n) = S^2 n^-p`, under which scrambled nets converge (Owen 1997: p between 1 and 3), and
//!   `Var(m_0 + m_1)` being that of the whole, `rho = k(p) N^(1 - p)`; that is solved for p, and the
//!   variance of the mean is `S^2 N^-p`. With halves of like size k = 2^p - 1.
//!
//! [`Variances::realisation`] is the contrast scaled to that variance: an image of noise like that of the film,
//! whose mean over any block has on average the square of the error that the film's mean has there.
//!
//! tests/variance.rs holds all of it to the truth.

use super::{Film, Late, Pixel, Tile};
use std::ops::AddAssign;

/// Pixels of an average neighbourhood's ratio that the ratio of the whole film counts for.
const PRIOR: f64 = 64.0;
/// Largest exponent of convergence that is believed: that of smooth integrands in many dimensions is less.
const MAX_EXPONENT: f64 = 2.0;

/// What links the samples of a tile's pixels does to their variances.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Linked {
    /// Variance of the mean over that of independent samples.
    variance: f64,
    /// The same over that of the contrast of the halves, when both are scaled alike.
    of_contrast: f64,
}

/// Variances of a film's pixels.
#[derive(Clone, Debug)]
pub struct Variances {
    /// Tile by tile.
    linked: Vec<Linked>,
}

/// The contrast between the halves of a pixel's samples.
struct Contrast {
    /// Difference between their means.
    difference: [f64; 3],
    /// Variance of that for a sample of variance 1, if samples are independent.
    scale: f64,
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

impl Linked {
    const INDEPENDENT: Self = Self {
        variance: 1.0,
        of_contrast: 1.0,
    };

    /// From the mean ratio in a neighbourhood of `tile`.
    fn new(ratio: f64, tile: &Tile) -> Self {
        let from = Late::begin(tile.done);
        if from == 0 {
            return Self::INDEPENDENT;
        }
        let one_sequence = tile.pixels.iter().any(|p| p.late.is_continued());
        if !one_sequence {
            return Self {
                variance: ratio,
                of_contrast: 1.0,
            };
        }
        let halves = [from as f64, (tile.done - from) as f64];
        let exponent = exponent(ratio, halves);
        Self {
            variance: (halves[0] + halves[1]).powf(1.0 - exponent),
            of_contrast: 1.0 / excess(exponent, halves),
        }
    }
}

/// Variance of the contrast of two halves of a sequence, scaled as for independent samples, over that of the mean
/// of all, where `n` points have the variance `n^-p`.
fn excess(p: f64, [a, b]: [f64; 2]) -> f64 {
    let n = a + b;
    let [first, second, whole] = [a, b, n].map(|n| n.powf(-p));
    // Var(mean) n^2 = a^2 Var(first) + b^2 Var(second) + 2 a b Cov.
    let covariance = (n * n * whole - a * a * first - b * b * second) / (2.0 * a * b);
    a * b / (n * n) * (first + second - 2.0 * covariance) / whole
}

/// The exponent under which the ratio would be the one observed; it falls as the exponent grows.
fn exponent(ratio: f64, halves: [f64; 2]) -> f64 {
    let n = halves[0] + halves[1];
    let expected = |p: f64| excess(p, halves) * n.powf(1.0 - p);
    let (mut low, mut high) = (1.0, MAX_EXPONENT);
    for _ in 0..30 {
        let middle = 0.5 * (low + high);
        if expected(middle) > ratio {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

impl Film {
    /// The variances of its pixels. Takes a pass over the film.
    pub fn variances(&self) -> Variances {
        let ratios: Vec<Ratios> = self.tiles.iter().map(Ratios::of).collect();
        let mut all = Ratios::default();
        ratios.iter().for_each(|r| all += *r);
        let usual = if all.count > 0.0 {
            all.sum / all.count
        } else {
            1.0
        };
        let linked = (0..self.tiles.len()).map(|i| {
            let mut near = Ratios {
                sum: PRIOR * usual,
                count: PRIOR,
            };
            self.tiles_around(i).for_each(|j| near += ratios[j]);
            Linked::new(near.sum / near.count, &self.tiles[i])
        });
        Variances {
            linked: linked.collect(),
        }
    }

    /// A tile and its neighbours.
    fn tiles_around(&self, tile: usize) -> impl Iterator<Item = usize> + use<> {
        let across = self.width().div_ceil(super::TILE_SIZE) as usize;
        let (rows, count) = (self.tiles.len() / across, self.tiles.len());
        let near = |at: usize, end: usize| at.saturating_sub(1)..(at + 2).min(end);
        let columns = near(tile % across, across);
        near(tile / across, rows)
            .flat_map(move |y| columns.clone().map(move |x| y * across + x))
            .filter(move |i| *i < count)
    }
}

impl Variances {
    /// Variance of [`Pixel::mean`], of a pixel in tile number `tile`, over renders with other seeds.
    pub fn of_mean(&self, tile: usize, pixel: &Pixel) -> [f64; 3] {
        let factor = self.linked[tile].variance;
        pixel.variance_of_mean().map(|v| v * factor)
    }

    /// A number of the size that the pixel's error has. The mean of its square is the variance of the
    /// pixel's mean; and that of the square of its sum over any pixels the variance of theirs. 0 where a half of the
    /// samples is missing.
    pub fn realisation(&self, (number, tile): (usize, &Tile), pixel: &Pixel) -> [f64; 3] {
        let Some(contrast) = Contrast::of(pixel, tile.done) else {
            return [0.0; 3];
        };
        let mean = pixel.worth_squares / (pixel.worth * pixel.worth);
        let scale = (mean / contrast.scale * self.linked[number].of_contrast).sqrt();
        contrast.difference.map(|d| d * scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_of_like_size_exceed_by_what_the_exponent_says() {
        for p in [1.0, 1.3, 2.0] {
            let expected = f64::powf(2.0, p) - 1.0;
            assert!((excess(p, [32.0, 32.0]) - expected).abs() < 1e-12);
        }
        // Independent samples: whatever the sizes.
        assert!((excess(1.0, [64.0, 3.0]) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn the_exponent_is_found_again() {
        for halves in [[2.0, 2.0], [32.0, 32.0], [64.0, 32.0], [512.0, 64.0]] {
            for p in [1.0, 1.1, 1.4, 1.9] {
                let n: f64 = halves[0] + halves[1];
                let ratio = excess(p, halves) * n.powf(1.0 - p);
                let found = exponent(ratio, halves);
                assert!((found - p).abs() < 1e-6, "{halves:?} {p} {found}");
            }
            assert!(exponent(1.2, halves) < 1.001);
        }
    }
}
