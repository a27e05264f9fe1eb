//! What the eye resolves: the contrast sensitivity of each opponent channel as a blur (section
//! 4.1.1).
//!
//! Each filter is a Gaussian, or two for blue and yellow, and a Gaussian of two dimensions is the
//! product of two of one. So four numbers go through a row filter and a column filter at once: the
//! three channels, and blue and yellow once more for its second Gaussian. Beyond the border the
//! image goes on as its last pixel.

use super::PIXELS_PER_DEGREE;
use crate::math::Rgb;
use glam::{Vec4, Vec4Swizzles};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Weight and width (squared degrees) of each Gaussian: a and b of the paper's table 1. Lightness,
/// red and green, blue and yellow, blue and yellow again.
const GAUSSIANS: [[f64; 2]; 4] = [[1.0, 0.0047], [1.0, 0.0053], [34.1, 0.04], [13.5, 0.025]];
/// The widest of them.
const WIDEST: f64 = 0.04;

/// The image after the eye's blur.
pub fn resolved(width: usize, opponent: &[Rgb]) -> Vec<Rgb> {
    let (taps, share) = taps();
    let split: Vec<Vec4> = opponent.iter().map(|c| c.extend(c.z)).collect();
    separable(width, &split, &taps, &taps)
        .into_iter()
        .map(|c| c.xy().extend(c.z * share + c.w * (1.0 - share)))
        .collect()
}

/// The filter of one dimension, and the share of blue and yellow's first Gaussian in two.
fn taps() -> (Vec<Vec4>, f32) {
    let deviation = (WIDEST / (2.0 * PI * PI)).sqrt();
    let radius = (3.0 * deviation * PIXELS_PER_DEGREE).ceil() as i32;
    let at = |x: i32, b: f64| (-(PI * f64::from(x) / PIXELS_PER_DEGREE).powi(2) / b).exp();
    let sums = GAUSSIANS.map(|[_, b]| (-radius..=radius).map(|x| at(x, b)).sum::<f64>());
    let taps = (-radius..=radius)
        .map(|x| Vec4::from_array([0, 1, 2, 3].map(|i| (at(x, GAUSSIANS[i][1]) / sums[i]) as f32)))
        .collect();
    let weight = |i: usize| {
        let [a, b] = GAUSSIANS[i];
        a * (PI / b).sqrt() * sums[i] * sums[i]
    };
    (taps, (weight(2) / (weight(2) + weight(3))) as f32)
}

/// Filters along the rows, then along the columns; the taps are centred, an odd number.
pub fn separable(width: usize, image: &[Vec4], rows: &[Vec4], columns: &[Vec4]) -> Vec<Vec4> {
    along_columns(width, &along_rows(width, image, rows), columns)
}

fn along_rows(width: usize, image: &[Vec4], taps: &[Vec4]) -> Vec<Vec4> {
    let radius = taps.len() / 2;
    let mut out = vec![Vec4::ZERO; image.len()];
    let lines = out.par_chunks_mut(width).zip(image.par_chunks(width));
    lines.for_each_init(Vec::new, |padded: &mut Vec<Vec4>, (out, line)| {
        padded.clear();
        padded.extend(std::iter::repeat_n(line[0], radius));
        padded.extend_from_slice(line);
        padded.extend(std::iter::repeat_n(line[line.len() - 1], radius));
        for (out, window) in out.iter_mut().zip(padded.windows(taps.len())) {
            *out = window.iter().zip(taps).map(|(x, t)| *x * *t).sum();
        }
    });
    out
}

fn along_columns(width: usize, image: &[Vec4], taps: &[Vec4]) -> Vec<Vec4> {
    let radius = taps.len() / 2;
    let last = image.len() / width - 1;
    let mut out = vec![Vec4::ZERO; image.len()];
    out.par_chunks_mut(width).enumerate().for_each(|(y, out)| {
        for (i, tap) in taps.iter().enumerate() {
            let line = (y + i).saturating_sub(radius).min(last);
            let line = &image[line * width..][..width];
            for (out, x) in out.iter_mut().zip(line) {
                *out += *x * *tap;
            }
        }
    });
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Size of a test image, wider and narrower than the filter in turn.
    const SIZES: [(usize, usize); 3] = [(40, 30), (3, 50), (1, 1)];

    #[test]
    fn blurs_keep_a_constant() {
        for (width, height) in SIZES {
            let image = vec![Rgb::new(50.0, -3.0, 20.0); width * height];
            for c in resolved(width, &image) {
                assert!((c - image[0]).length() < 1e-3, "{c}");
            }
        }
    }

    #[test]
    fn the_filter_is_the_sum_of_its_gaussians_in_two_dimensions() {
        let (width, height) = (31, 29);
        let (cx, cy) = (15, 14);
        let mut image = vec![Rgb::ZERO; width * height];
        image[cy * width + cx] = Rgb::ONE;
        let out = resolved(width, &image);
        let kernel = |dx: i32, dy: i32| {
            let d = f64::from(dx * dx + dy * dy) / PIXELS_PER_DEGREE.powi(2);
            let g = |i: usize| {
                let [a, b] = GAUSSIANS[i];
                a * (PI / b).sqrt() * (-PI * PI * d / b).exp()
            };
            [g(0), g(1), g(2) + g(3)]
        };
        let all = (-10..=10).flat_map(|y| (-10..=10).map(move |x| (x, y)));
        let sum = all.fold([0.0; 3], |s: [f64; 3], (x, y)| {
            let k = kernel(x, y);
            [s[0] + k[0], s[1] + k[1], s[2] + k[2]]
        });
        for (dx, dy) in [(0, 0), (1, 0), (3, -2), (-7, 5)] {
            let at = (cy as i32 + dy) as usize * width + (cx as i32 + dx) as usize;
            for c in 0..3 {
                let expected = kernel(dx, dy)[c] / sum[c];
                assert!((f64::from(out[at][c]) - expected).abs() < 1e-7, "{dx} {dy}");
            }
        }
    }
}
