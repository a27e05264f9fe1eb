//! Structural similarity: Wang et al. 2004, *Image Quality Assessment: From Error Visibility to
//! Structural Similarity*, in the variant that scikit-image computes by default.
//!
//! Means, variances and the covariance are of windows of 7 x 7 pixels, all of one weight; variances
//! are those of a sample (divided by 48). Only windows that lie inside the image count. Each
//! channel is compared by itself and the three results are averaged (`channel_axis=2`):
//!
//! SSIM = (2 mx my + c1) (2 sxy + c2) / ((mx^2 + my^2 + c1) (sx^2 + sy^2 + c2)),
//! c1 = (0.01 range)^2, c2 = (0.03 range)^2.

use super::Pair;
use crate::math::Rgb;
use glam::DVec3;
use rayon::prelude::*;

/// Side of a window.
const SIDE: usize = 7;
/// Numbers in a window.
const COUNT: f64 = (SIDE * SIDE) as f64;

/// Mean structural similarity, at most 1, of numbers that span `data_range` (1 for images as
/// shown). `None` where the image is smaller than a window.
pub fn ssim(pair: &Pair, data_range: f64) -> Option<f64> {
    let (width, height) = (pair.width(), pair.height());
    if width < SIDE || height < SIDE {
        return None;
    }
    let c = [0.01, 0.03].map(|k: f64| (k * data_range).powi(2));
    let rows: Vec<f64> = (0..=height - SIDE)
        .into_par_iter()
        .map(|y| row(pair, y, c))
        .collect();
    let windows = (width - SIDE + 1) * (height - SIDE + 1);
    Some(rows.iter().sum::<f64>() / (3 * windows) as f64)
}

/// Sums over a window, or a column of it.
#[derive(Clone, Copy, Default)]
struct Moments {
    x: DVec3,
    y: DVec3,
    xx: DVec3,
    yy: DVec3,
    xy: DVec3,
}

impl Moments {
    fn of_pixel(x: Rgb, y: Rgb) -> Self {
        let (x, y) = (x.as_dvec3(), y.as_dvec3());
        Self {
            x,
            y,
            xx: x * x,
            yy: y * y,
            xy: x * y,
        }
    }

    fn plus(self, o: Self) -> Self {
        Self {
            x: self.x + o.x,
            y: self.y + o.y,
            xx: self.xx + o.xx,
            yy: self.yy + o.yy,
            xy: self.xy + o.xy,
        }
    }

    /// Similarity of the window, summed over the channels.
    fn similarity(&self, [c1, c2]: [f64; 2]) -> f64 {
        let (mx, my) = (self.x / COUNT, self.y / COUNT);
        let sample = COUNT / (COUNT - 1.0);
        let vx = sample * (self.xx / COUNT - mx * mx);
        let vy = sample * (self.yy / COUNT - my * my);
        let vxy = sample * (self.xy / COUNT - mx * my);
        let above = (2.0 * mx * my + c1) * (2.0 * vxy + c2);
        let below = (mx * mx + my * my + c1) * (vx + vy + c2);
        (above / below).element_sum()
    }
}

/// Similarities of the windows whose first row is `y`, summed.
fn row(pair: &Pair, y: usize, c: [f64; 2]) -> f64 {
    let width = pair.width();
    let mut columns = vec![Moments::default(); width];
    for line in y..y + SIDE {
        let pixels = line * width..(line + 1) * width;
        let both = pair.image[pixels.clone()]
            .iter()
            .zip(&pair.reference[pixels]);
        for (column, (x, r)) in columns.iter_mut().zip(both) {
            *column = column.plus(Moments::of_pixel(*x, *r));
        }
    }
    // Each window is summed anew: a running sum would carry the rounding of a bright lamp along the
    // row.
    columns
        .windows(SIDE)
        .map(|w| {
            let all = w.iter().fold(Moments::default(), |sum, m| sum.plus(*m));
            all.similarity(c)
        })
        .sum()
}
