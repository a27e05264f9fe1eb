//! What part of the plane stands for directions, and how much of a Gaussian lies inside it.

use super::lobe::Lobe;
use crate::math::Vec2;
use crate::math::special::erf;
use crate::math::warp::concentric_disk;
use std::f32::consts::FRAC_PI_4;

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

/// A part of the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// All of it.
    Square,
    /// The disk inside it, of diameter 1.
    Disk,
}

impl Domain {
    /// Its area.
    #[inline]
    pub fn area(self) -> f32 {
        match self {
            Self::Square => 1.0,
            Self::Disk => FRAC_PI_4,
        }
    }

    /// Whether a point belongs to it.
    #[inline]
    pub fn contains(self, p: Vec2) -> bool {
        match self {
            Self::Square => p.cmpge(Vec2::ZERO).all() && p.cmple(Vec2::ONE).all(),
            Self::Disk => p.distance_squared(Vec2::splat(0.5)) <= 0.25,
        }
    }

    /// A point of it, uniform for uniform `u`.
    #[inline]
    pub fn uniform(self, u: Vec2) -> Vec2 {
        match self {
            Self::Square => u,
            Self::Disk => 0.5 * concentric_disk(u) + 0.5,
        }
    }

    /// From where to where it goes along y.
    #[inline]
    fn heights(self, x: f32) -> (f32, f32) {
        match self {
            Self::Square => (0.0, 1.0),
            Self::Disk => {
                let half = (0.25 - (x - 0.5) * (x - 0.5)).max(0.0).sqrt();
                (0.5 - half, 0.5 + half)
            }
        }
    }

    /// Whether a lobe has all its mass inside, as far as its mean and spread tell.
    fn holds(self, lobe: &Lobe, spread: Vec2) -> bool {
        match self {
            Self::Square => {
                let margin = lobe.mean.min(1.0 - lobe.mean) / spread;
                margin.min_element() >= INSIDE
            }
            // No axis of a Gaussian is longer than the root of both variances' sum.
            Self::Disk => 0.5 - lobe.mean.distance(Vec2::splat(0.5)) >= INSIDE * spread.length(),
        }
    }

    /// The integral of a lobe's Gaussian over the domain. There is no closed form with correlation: along x
    /// by quadrature, along y, whose distribution given x is a Gaussian, by the error function.
    pub fn mass(self, lobe: &Lobe) -> f32 {
        let [xx, xy, yy] = lobe.covariance;
        let (sx, sy) = (xx.sqrt(), yy.sqrt());
        if self.holds(lobe, Vec2::new(sx, sy)) {
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
        let panels = (8.0 * sy / rest).clamp(6.0, 256.0) as u32;
        let width = f64::from(to - from) / f64::from(panels);
        let mut sum = 0.0;
        for i in 0..panels {
            let middle = f64::from(from) + (f64::from(i) + 0.5) * width;
            for (node, weight) in RULE {
                let x = (middle + 0.5 * width * node) as f32;
                let t = (x - lobe.mean.x) / sx;
                let y = lobe.mean.y + slope * (x - lobe.mean.x);
                let scale = std::f32::consts::FRAC_1_SQRT_2 / rest;
                let (low, high) = self.heights(x);
                let share = 0.5 * (erf((high - y) * scale) - erf((low - y) * scale));
                sum += weight * f64::from((-0.5 * t * t).exp() * share);
            }
        }
        let density = 1.0 / (f64::from(sx) * std::f64::consts::TAU.sqrt());
        (sum * 0.5 * width * density) as f32
    }
}
