//! Exposures at which high dynamic range is looked at (sections 3 and 4 of the paper of 2021).
//!
//! The tone curve is Narkowicz's fit of ACES. The darkest exposure puts the brightest pixel of the
//! reference, the brightest its median, at 0.85 of the curve; between them lies about one a stop.

use crate::math::Rgb;
use rayon::prelude::*;

/// Numerator and denominator of the curve, each from the square to the constant. The factor 0.6
/// that goes with the curve is multiplied in.
const CURVE: [[f32; 3]; 2] = [
    [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0],
    [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14],
];
/// Where on the curve the brightest and the median pixel are put.
const TARGET: f64 = 0.85;

/// Exposures in stops, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The darkest.
    pub start: f64,
    /// The brightest.
    pub stop: f64,
    /// How many, at least one.
    pub count: usize,
}

impl Exposures {
    /// The exposures that show a reference; the picture as it is, if it is black.
    pub fn of(reference: &[Rgb]) -> Self {
        let mut bright: Vec<f32> = reference.iter().map(|c| y_of(*c)).collect();
        let most = bright.iter().copied().fold(0.0, f32::max);
        if most <= 0.0 {
            return Self {
                start: 0.0,
                stop: 0.0,
                count: 1,
            };
        }
        let middle = bright.len() / 2;
        let (_, median, _) = bright.select_nth_unstable_by(middle, f32::total_cmp);
        // A median of 0 has no exposure; the authors' program takes this number, and so all agree.
        let median = median.max(f32::EPSILON).min(most);
        let shown = before_target();
        let [start, stop] = [most, median].map(|y| (shown / f64::from(y)).log2());
        Self {
            start,
            stop,
            count: ((stop - start).ceil() as usize).max(2),
        }
    }

    /// Each exposure.
    pub fn list(self) -> impl Iterator<Item = f32> {
        let step = (self.stop - self.start) / (self.count.max(2) - 1) as f64;
        (0..self.count).map(move |i| (self.start + step * i as f64) as f32)
    }
}

/// The value that the curve takes to [`TARGET`]: the positive root of a quadratic equation.
fn before_target() -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| f64::from(CURVE[0][i]) - TARGET * f64::from(CURVE[1][i]));
    ((b * b - 4.0 * a * c).sqrt() - b) / (2.0 * a)
}

/// Relative luminance as the authors have it; negative light counts as none.
fn y_of(c: Rgb) -> f32 {
    let c = c.max(Rgb::ZERO);
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// Linear light in 0..1: the picture at an exposure, through the tone curve.
pub fn tone_mapped(pixels: &[Rgb], exposure: f32) -> Vec<Rgb> {
    let gain = exposure.exp2();
    // Beyond this the curve is at its limit, and the squares of the largest floats would overflow.
    const LARGEST: f32 = 1e15;
    let curve = |x: f32| {
        let x = (x * gain).clamp(0.0, LARGEST);
        let [above, below] = CURVE.map(|[a, b, c]| (a * x + b) * x + c);
        (above / below).clamp(0.0, 1.0)
    };
    pixels.par_iter().map(|c| c.map(curve)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_brightest_and_the_median_are_put_where_they_can_be_seen() {
        let pixels = [3.0, 0.25, 40.0].map(Rgb::splat);
        let exposures = Exposures::of(&pixels);
        let list: Vec<f32> = exposures.list().collect();
        assert_eq!(list.len(), 4);
        let first = tone_mapped(&pixels, list[0])[2].x;
        let last = tone_mapped(&pixels, list[3])[0].x;
        assert!((first - 0.85).abs() < 1e-5 && (last - 0.85).abs() < 1e-5);
    }

    #[test]
    fn black_and_extreme_references_have_exposures() {
        for pixels in [
            vec![Rgb::ZERO; 4],
            vec![Rgb::splat(-1.0); 4],
            vec![Rgb::splat(f32::MAX), Rgb::ZERO, Rgb::ZERO],
            vec![Rgb::splat(1e-30); 4],
        ] {
            let exposures = Exposures::of(&pixels);
            assert!(exposures.start.is_finite() && exposures.stop >= exposures.start);
            for exposure in exposures.list() {
                assert!(tone_mapped(&pixels, exposure).iter().all(|c| c.is_finite()));
            }
        }
    }
}
