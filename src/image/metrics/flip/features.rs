//! Edges and points, which the eye notices where their colours alone would not tell (section 4.2).
//!
//! The detectors are the first and the second derivative of a Gaussian as wide as the eye's
//! receptive field. Their positive weights sum to 1 and their negative ones to -1. All four (edges
//! and points along x and y) are products of filters of one dimension and go through them at once.

use super::PIXELS_PER_DEGREE;
use super::filter::separable;
use crate::math::Rgb;
use glam::Vec4;

/// Width of the detectors in degrees.
const WIDTH: f64 = 0.082;

/// Strength of the edge and of the point at each pixel, from Y of YCxCz.
pub fn of(width: usize, opponent: &[Rgb]) -> Vec<[f32; 2]> {
    let bright: Vec<Vec4> = opponent
        .iter()
        .map(|c| Vec4::splat((c.x + 16.0) / 116.0))
        .collect();
    let taps = taps();
    let rows: Vec<Vec4> = taps
        .iter()
        .map(|[g, edge, point]| Vec4::new(*edge, *g, *point, *g))
        .collect();
    let columns: Vec<Vec4> = taps
        .iter()
        .map(|[g, edge, point]| Vec4::new(*g, *edge, *g, *point))
        .collect();
    separable(width, &bright, &rows, &columns)
        .into_iter()
        .map(|f| [f.x.hypot(f.y), f.z.hypot(f.w)])
        .collect()
}

/// How much more an edge or a point there is in one image than in the other, 0 to 1.
pub fn difference(a: [f32; 2], b: [f32; 2]) -> f32 {
    let largest = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
    (largest * std::f32::consts::FRAC_1_SQRT_2).sqrt().min(1.0)
}

/// The Gaussian, its first and its second derivative.
fn taps() -> Vec<[f32; 3]> {
    let deviation = 0.5 * WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let raw: Vec<[f64; 3]> = (-radius..=radius)
        .map(|x| {
            let t = f64::from(x) / deviation;
            let g = (-0.5 * t * t).exp();
            [g, -t * g, (t * t - 1.0) * g]
        })
        .collect();
    let sum = |i: usize, sign: f64| raw.iter().map(|r| (sign * r[i]).max(0.0)).sum::<f64>();
    let above = [0, 1, 2].map(|i| sum(i, 1.0));
    let below = [0, 1, 2].map(|i| sum(i, -1.0));
    let balanced = |i: usize, x: f64| (x / if x < 0.0 { below[i] } else { above[i] }) as f32;
    raw.iter()
        .map(|r| [0, 1, 2].map(|i| balanced(i, r[i])))
        .collect()
}
