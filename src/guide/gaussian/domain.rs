//! What part of the plane stands for directions, and how much of a Gaussian lies inside it.

use super::lobe::Lobe;
use crate::math::Vec2;
use crate::math::special::{erf, exp_negative};
use crate::math::warp::concentric_disk;
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

/// A lobe whose mean is this many standard deviations inside every border has all its mass there,
/// to 6e-7.
const INSIDE: f32 = 5.0;
/// Points of the quadrature rule.
const POINTS: usize = 8;
/// Nodes of Gauss and Legendre's rule on [-1, 1].
const NODES: [f32; POINTS] = [
    -0.960_289_84,
    -0.796_666_5,
    -0.525_532_4,
    -0.183_434_65,
    0.183_434_65,
    0.525_532_4,
    0.796_666_5,
    0.960_289_84,
];
/// Their weights.
const WEIGHTS: [f32; POINTS] = [
    0.101_228_535,
    0.222_381_04,
    0.313_706_64,
    0.362_683_78,
    0.362_683_78,
    0.313_706_64,
    0.222_381_04,
    0.101_228_535,
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

    /// A way along x, from 0 to 1 as `s` goes from 0 to 1, on which borders have no steep ends: for
    /// the disk x = s^2 (3 - 2 s), on which the root in its border's height is s (1 - s) times a
    /// smooth function. Returns x, dx/ds and from where to where the domain goes along y.
    #[inline]
    fn column(self, s: f32) -> (f32, f32, f32, f32) {
        match self {
            Self::Square => (s, 1.0, 0.0, 1.0),
            Self::Disk => {
                let rise = s * (1.0 - s);
                let half = rise * ((3.0 - 2.0 * s) * (1.0 + 2.0 * s)).sqrt();
                (s * s * (3.0 - 2.0 * s), 6.0 * rise, 0.5 - half, 0.5 + half)
            }
        }
    }

    /// The s of an x.
    fn way(self, x: f32) -> f32 {
        match self {
            Self::Square => x,
            Self::Disk => 0.5 - ((1.0 - 2.0 * x).asin() / 3.0).sin(),
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

    /// A lobe of the same mass, which is easier to integrate: the disk may be turned, so that what
    /// is narrow lies along x and nothing is steep along y.
    fn turned(self, lobe: &Lobe) -> Lobe {
        if self == Self::Square {
            return *lobe;
        }
        let [xx, xy, yy] = lobe.covariance.map(f64::from);
        let turn = 0.5 * (2.0 * xy).atan2(xx - yy);
        let along = Vec2::from_angle(turn as f32);
        let long = 0.5 * (xx + yy + (xx - yy).hypot(2.0 * xy));
        let short = (xx * yy - xy * xy) / long;
        let offset = lobe.mean - 0.5;
        Lobe {
            weight: lobe.weight,
            mean: Vec2::new(along.perp_dot(offset), along.dot(offset)) + 0.5,
            covariance: [short as f32, 0.0, long as f32],
        }
    }

    /// The integral of a lobe's Gaussian over the domain. There is no closed form with correlation:
    /// along x by quadrature, along y, whose distribution given x is a Gaussian, by the error
    /// function.
    pub fn mass(self, lobe: &Lobe) -> f32 {
        let [xx, _, yy] = lobe.covariance;
        if self.holds(lobe, Vec2::new(xx.sqrt(), yy.sqrt())) {
            return 1.0;
        }
        let lobe = self.turned(lobe);
        let [xx, xy, yy] = lobe.covariance;
        let (sx, sy) = (xx.sqrt(), yy.sqrt());
        let slope = xy / xx;
        let rest = (yy - xy * slope).max(1e-12).sqrt();
        let [from, to] =
            [-6.0, 6.0].map(|reach| self.way((lobe.mean.x + reach * sx).clamp(0.0, 1.0)));
        if from >= to {
            return 0.0;
        }
        // The band within which y's distribution crosses a border is sy/rest times narrower than
        // sx.
        let panels = (4.0 * sy / rest).clamp(4.0, 128.0) as u32;
        let half = 0.5 * (to - from) / panels as f32;
        let scale = FRAC_1_SQRT_2 / rest;
        let mut sum = 0.0;
        for i in 0..panels {
            let middle = from + (2 * i + 1) as f32 * half;
            // All points of a panel at a time, as vector instructions.
            let mut shares = [0f32; POINTS];
            for (k, share) in shares.iter_mut().enumerate() {
                let (x, pace, low, high) = self.column(middle + half * NODES[k]);
                let t = (x - lobe.mean.x) / sx;
                let y = lobe.mean.y + slope * (x - lobe.mean.x);
                let inside = erf((high - y) * scale) - erf((low - y) * scale);
                *share = pace * WEIGHTS[k] * exp_negative(-0.5 * t * t) * inside;
            }
            sum += shares.iter().map(|&s| f64::from(s)).sum::<f64>();
        }
        let density = 1.0 / (f64::from(sx) * std::f64::consts::TAU.sqrt());
        (0.5 * sum * f64::from(half) * density) as f32
    }
}
