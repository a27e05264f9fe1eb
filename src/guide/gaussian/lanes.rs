//! Eight Gaussians side by side, laid out for vector instructions.

use super::lobe::Lobe;
use crate::math::special::exp_negative;
use std::f32::consts::TAU;

/// Gaussians of a mixture: the paper's number.
pub const LOBES: usize = 8;

/// A number for each lobe.
pub type Eight = [f32; LOBES];

/// Gaussians over the plane: `scale * exp(-q/2)` with q = (a dx)^2 + (b dx + d dy)^2, the squared length of
/// the offset from the mean under the inverse Cholesky factor of the covariance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lanes {
    pub scale: Eight,
    pub x: Eight,
    pub y: Eight,
    pub a: Eight,
    pub b: Eight,
    pub d: Eight,
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
    #[inline]
    pub fn densities(&self, x: f32, y: f32) -> Eight {
        let mut out = [0.0; LOBES];
        for (j, out) in out.iter_mut().enumerate() {
            let (dx, dy) = (x - self.x[j], y - self.y[j]);
            let (s, t) = (self.a[j] * dx, self.b[j] * dx + self.d[j] * dy);
            *out = self.scale[j] * exp_negative(-0.5 * (s * s + t * t));
        }
        out
    }

    /// Their sum.
    #[inline]
    pub fn density(&self, x: f32, y: f32) -> f32 {
        let p = self.densities(x, y);
        ((p[0] + p[4]) + (p[1] + p[5])) + ((p[2] + p[6]) + (p[3] + p[7]))
    }
}
