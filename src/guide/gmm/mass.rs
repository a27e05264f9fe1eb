//! How much of a Gaussian lies inside the unit square.

use super::em::Lobe;
use crate::math::special::erf;

/// A lobe whose mean is this many standard deviations inside every border has all its mass there, to 6e-7.
const INSIDE: f32 = 5.0;
/// Nodes and weights of Gauss and Legendre's rule of five points on [-1, 1].
const RULE: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_1),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.0, 0.568_888_888_888_888_9),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_5),
    (0.906_179_845_938_664, 0.236_926_885_056_189_1),
];

/// The integral of a lobe's Gaussian over the unit square. There is no closed form with correlation: along
/// x by quadrature, along y, whose distribution given x is a Gaussian, by the error function.
pub(super) fn inside(lobe: &Lobe) -> f32 {
    let [xx, xy, yy] = lobe.covariance;
    let (sx, sy) = (xx.sqrt(), yy.sqrt());
    let margin = |m: f32, s: f32| m.min(1.0 - m) / s;
    if margin(lobe.mean.x, sx).min(margin(lobe.mean.y, sy)) >= INSIDE {
        return 1.0;
    }
    let slope = xy / xx;
    let rest = (yy - xy * slope).max(1e-12).sqrt();
    let (from, to) = (
        (lobe.mean.x - 6.0 * sx).max(0.0),
        (lobe.mean.x + 6.0 * sx).min(1.0),
    );
    if from >= to {
        return 0.0;
    }
    // The band within which y's distribution crosses a border is sy/rest times narrower than sx.
    let panels = (8.0 * sy / rest).clamp(12.0, 256.0) as u32;
    let width = f64::from(to - from) / f64::from(panels);
    let mut sum = 0.0;
    for i in 0..panels {
        let middle = f64::from(from) + (f64::from(i) + 0.5) * width;
        for (node, weight) in RULE {
            let x = (middle + 0.5 * width * node) as f32;
            let t = (x - lobe.mean.x) / sx;
            let y = lobe.mean.y + slope * (x - lobe.mean.x);
            let scale = std::f32::consts::FRAC_1_SQRT_2 / rest;
            let share = 0.5 * (erf((1.0 - y) * scale) - erf(-y * scale));
            sum += weight * f64::from((-0.5 * t * t).exp() * share);
        }
    }
    let density = 1.0 / (f64::from(sx) * std::f64::consts::TAU.sqrt());
    (sum * 0.5 * width * density) as f32
}
