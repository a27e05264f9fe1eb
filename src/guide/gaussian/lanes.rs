//! Eight Gaussians side by side, laid out for vector instructions.

use super::lobe::Lobe;
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
            *out = self.scale[j] * exp(-0.5 * (s * s + t * t));
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

/// e^x for x <= 0, to 2e-7; 0 below -87. Without a branch, so that loops over it become vector code, and the
/// same bits on every machine.
#[inline]
fn exp(x: f32) -> f32 {
    /// Adding it leaves the nearest integer in the lowest bits.
    const MAGIC: f32 = 12_582_912.0;
    let x = x.max(-87.0);
    let shifted = x * std::f32::consts::LOG2_E + MAGIC;
    let n = shifted - MAGIC;
    // ln 2 in two parts: n times the first is exact.
    let r = (x - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let p = ((((1.987_569_1e-4 * r + 1.398_2e-3) * r + 8.333_452e-3) * r + 4.166_579_6e-2) * r
        + 1.666_666_5e-1)
        * r
        + 5e-1;
    let p = p * r * r + r + 1.0;
    let power = f32::from_bits(
        ((shifted.to_bits() as i32).wrapping_shl(23)).wrapping_add(0x3f80_0000) as u32,
    );
    let value = p * power;
    if x <= -87.0 { 0.0 } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_exact_to_a_few_roundings() {
        for i in 0..=8600 {
            let x = -f64::from(i) / 100.0;
            let exact = (f64::from(x as f32)).exp();
            let relative = (f64::from(exp(x as f32)) / exact - 1.0).abs();
            assert!(relative < 4e-7, "{x}: {relative}");
        }
        assert_eq!(exp(0.0), 1.0);
        assert_eq!(exp(-1e30), 0.0);
        assert_eq!(exp(f32::NEG_INFINITY), 0.0);
    }
}
