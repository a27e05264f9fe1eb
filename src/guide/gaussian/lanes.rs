//! Eight Gaussians side by side, laid out for vector instructions.

use super::lobe::{LOBES, Lobe};
use crate::math::special::{VANISHING, exp_negative};
use std::f32::consts::TAU;

/// A number for each lobe.
pub type Eight = [f32; LOBES];

/// Gaussians over the plane: `scale * exp(-q/2)` with q = (a dx)^2 + (b dx + d dy)^2, the squared
/// length of the offset from the mean under the inverse Cholesky factor of the covariance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lanes {
    pub scale: Eight,
    pub x: Eight,
    pub y: Eight,
    pub a: Eight,
    pub b: Eight,
    pub d: Eight,
}

/// Eight absent lobes: of no weight, and so far from every point that nobody needs to look at them.
impl Default for Lanes {
    fn default() -> Self {
        Self {
            scale: [0.0; LOBES],
            x: [0.0; LOBES],
            y: [1e3; LOBES],
            a: [0.0; LOBES],
            b: [0.0; LOBES],
            d: [1.0; LOBES],
        }
    }
}

impl Lanes {
    /// The Gaussians without regard to any borders; one without a usable covariance is absent.
    pub fn unbounded(lobes: &[Lobe; LOBES]) -> Self {
        let mut lanes = Self::default();
        for (j, lobe) in lobes.iter().enumerate() {
            let Some([a, b, d]) = lobe.inverse_cholesky() else {
                continue;
            };
            (lanes.x[j], lanes.y[j]) = (lobe.mean.x, lobe.mean.y);
            (lanes.a[j], lanes.b[j], lanes.d[j]) = (a, b, d);
            lanes.scale[j] = lobe.weight * a * d / TAU;
        }
        lanes
    }

    /// Each lobe's density at a point.
    #[inline(always)]
    pub fn densities(&self, x: f32, y: f32) -> Eight {
        self.densities_for(&self.exponents(x, y))
    }

    /// Their sum. Narrow lobes are nowhere near most points: then there is nothing to add up.
    #[inline(always)]
    pub fn density(&self, x: f32, y: f32) -> f32 {
        let exponents = self.exponents(x, y);
        if exponents.iter().fold(VANISHING, |a, &b| b.max(a)) <= VANISHING {
            return 0.0;
        }
        let p = self.densities_for(&exponents);
        ((p[0] + p[4]) + (p[1] + p[5])) + ((p[2] + p[6]) + (p[3] + p[7]))
    }

    /// -q/2 of each lobe.
    #[inline(always)]
    fn exponents(&self, x: f32, y: f32) -> Eight {
        let mut out = [0.0; LOBES];
        for (j, out) in out.iter_mut().enumerate() {
            let (dx, dy) = (x - self.x[j], y - self.y[j]);
            let (s, t) = (self.a[j] * dx, self.b[j] * dx + self.d[j] * dy);
            *out = -0.5 * (s * s + t * t);
        }
        out
    }

    #[inline(always)]
    fn densities_for(&self, exponents: &Eight) -> Eight {
        let mut out = [0.0; LOBES];
        for (j, out) in out.iter_mut().enumerate() {
            *out = self.scale[j] * exp_negative(exponents[j]);
        }
        out
    }
}
