//! One Gaussian, and the most likely ones for what was counted.

use crate::math::Vec2;

/// Gaussians of a mixture, as many as in Vorba et al. 2014.
pub const LOBES: usize = 8;

/// The paper's priors on covariances and on weights.
const PRIOR_A: f64 = 2.01;
const PRIOR_V: f64 = 1.01;

/// A weighted Gaussian over the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lobe {
    /// Its share of the mixture.
    pub weight: f32,
    /// Its mean.
    pub mean: Vec2,
    /// Its covariance: xx, xy, yy.
    pub covariance: [f32; 3],
}

impl Lobe {
    /// The inverse of the covariance's Cholesky factor, `[a, b, d]` for the rows (a 0) and (b d);
    /// `None` unless the covariance is positive definite.
    pub fn inverse_cholesky(&self) -> Option<[f32; 3]> {
        let [xx, xy, yy] = self.covariance.map(f64::from);
        let l11 = xx.sqrt();
        let l21 = xy / l11;
        let l22 = (yy - l21 * l21).sqrt();
        let usable = l11 > 0.0 && l22 > 0.0 && (l11 + l22 + l21).is_finite();
        let found = [1.0 / l11, -l21 / (l11 * l22), 1.0 / l22].map(|v| v as f32);
        (usable && self.mean.is_finite()).then_some(found)
    }
}

/// Per lobe: sums or means of g, g x, g y, g xx, g xy, g yy, where (x, y) is a record's place and g
/// its weight times the lobe's responsibility.
pub type Statistics = [[f64; 6]; LOBES];

/// What is believed of covariances before anything was seen.
#[derive(Clone, Copy, Debug)]
pub struct Prior {
    /// The paper's b: a variance, which one record holds against all others.
    pub spread: f64,
    /// Smallest variance along an axis.
    pub least_variance: f64,
}

/// The positive definite covariance nearest to one that was computed: xx, xy, yy. No variance is
/// less than `least`.
pub fn positive([xx, xy, yy]: [f64; 3], least: f64) -> [f32; 3] {
    let (xx, yy) = (xx.max(least), yy.max(least));
    // Rounding must not carry the correlation beyond 1.
    let most = 0.999 * (xx * yy).sqrt();
    [xx, xy.clamp(-most, most), yy].map(|v| v as f32)
}

/// The maximum a posteriori for the statistics of `n` records of equal weight, in the unit of the
/// statistics' own sum: a Dirichlet prior (v) on the weights and a normal-inverse-Wishart prior (a,
/// b) on the covariances, which fade as 1/n. A lobe that nothing belongs to stays where it is.
/// Nothing happens without weight.
pub fn maximise(lobes: &mut [Lobe; LOBES], statistics: &Statistics, n: f64, prior: &Prior) {
    let total: f64 = statistics.iter().map(|s| s[0]).sum();
    if !(total > 0.0 && total.is_finite()) {
        return;
    }
    let n = n.max(1.0);
    let v = (PRIOR_V - 1.0) / n;
    for (lobe, s) in lobes.iter_mut().zip(statistics) {
        let share = s[0] / total;
        lobe.weight = ((share + v) / (1.0 + LOBES as f64 * v)) as f32;
        if share <= 1e-12 {
            continue;
        }
        let (mx, my) = (s[1] / s[0], s[2] / s[0]);
        let below = (PRIOR_A - 2.0) / n + share;
        let variance = |second: f64, square: f64, prior: f64| {
            (prior + (second - s[0] * square) / total) / below
        };
        let spread = prior.spread / n;
        let xx = variance(s[3], mx * mx, spread);
        let xy = variance(s[4], mx * my, 0.0);
        let yy = variance(s[5], my * my, spread);
        lobe.mean = Vec2::new(mx as f32, my as f32);
        lobe.covariance = positive([xx, xy, yy], prior.least_variance);
    }
}
