//! One von Mises-Fisher lobe, safe from nearly uniform to a needle of 0.2 degrees.

use crate::math::{DVec3, Frame, Vec2, Vec3};
use std::f32::consts::PI;

/// Concentration limits: nearly uniform, and 0.2 degrees.
const MIN_KAPPA: f64 = 1e-2;
const MAX_KAPPA: f64 = 1e5;
/// Prior records of mean cosine 0 in each lobe: a single record must not make a delta.
const PRIOR: f64 = 0.5;

/// Weighted sums of a lobe's records: weight, direction, inverse distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub weight: f64,
    pub direction: DVec3,
    pub inverse_distance: f64,
}

/// A lobe as it is evaluated; one of weight 0 is absent.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lobe {
    pub weight: f32,
    pub mean: Vec3,
    pub kappa: f32,
    /// Density at the mean.
    norm: f32,
    /// 1 / distance to the light; 0: infinitely far.
    pub inverse_distance: f32,
}

impl Lobe {
    /// A lobe around `mean`.
    pub fn new(weight: f32, mean: Vec3, kappa: f32, inverse_distance: f32) -> Self {
        Self {
            weight,
            mean,
            kappa,
            norm: kappa / (2.0 * PI * -(-2.0 * kappa).exp_m1()),
            inverse_distance,
        }
    }

    /// The lobe of largest likelihood for the sums, its share out of `total`.
    pub fn fit(s: &Sums, total: f64) -> Self {
        if s.weight <= 1e-6 * total || !s.weight.is_finite() {
            return Self::default();
        }
        let length = s.direction.length();
        let mean = if length > 1e-12 * s.weight {
            s.direction / length
        } else {
            DVec3::Z
        };
        let r = (length / (s.weight + PRIOR)).clamp(0.0, 1.0 - 1e-9);
        // Banerjee et al. 2005, eq. 4.4 for the sphere.
        let kappa = r * (3.0 - r * r) / (1.0 - r * r);
        Self::new(
            (s.weight / total) as f32,
            mean.as_vec3().normalize_or(Vec3::Z),
            kappa.clamp(MIN_KAPPA, MAX_KAPPA) as f32,
            (s.inverse_distance / s.weight).clamp(0.0, 1e30) as f32,
        )
    }

    /// Density. Written with the chord, |w - mean|^2 / 2 = 1 - cos, which keeps its digits where
    /// cos is near 1.
    #[inline]
    pub fn pdf(&self, w: Vec3) -> f32 {
        self.norm * (-0.5 * self.kappa * w.distance_squared(self.mean)).exp()
    }

    /// A direction.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        // 1 - cos = -ln(u + (1-u) e^{-2k}) / k, between 0 and 2.
        let tail = u.x + (1.0 - u.x) * (-2.0 * self.kappa).exp();
        let one_minus_cos = (-tail.max(1e-38).ln() / self.kappa).clamp(0.0, 2.0);
        let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
        let (s, c) = (2.0 * PI * u.y).sin_cos();
        Frame::new(self.mean)
            .to_world(Vec3::new(sin * c, sin * s, 1.0 - one_minus_cos))
            .normalize()
    }

    /// The mean as seen from `to` instead of `from`.
    #[inline]
    pub fn reaimed(&self, from: Vec3, to: Vec3) -> Vec3 {
        // In units of the distance, so that an infinite one needs no case of its own.
        (self.mean + (from - to) * self.inverse_distance).normalize_or(self.mean)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    /// The closed-form mean cosine, coth k - 1/k, and the density's integral, over seven decades.
    #[test]
    fn lobes_are_safe_from_flat_to_needle() {
        let mut rng = Pcg32::new(2, 3);
        for kappa in [1e-2f32, 1.0, 10.0, 1e3, 1e5] {
            let lobe = Lobe::new(1.0, Vec3::Y, kappa, 0.0);
            let n = 200_000;
            let mut mean = 0f64;
            for _ in 0..n {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let w = lobe.sample(u);
                mean += 0.5 * f64::from(w.distance_squared(Vec3::Y));
            }
            let k = f64::from(kappa);
            let expected = 1.0 - (1.0 / k.tanh() - 1.0 / k);
            let got = mean / f64::from(n);
            assert!(
                (got / expected - 1.0).abs() < 0.01,
                "{kappa}: {got} {expected}"
            );
            // Midpoint rule in h = 1 - cos, as far as the lobe reaches.
            let reach = (30.0 / kappa).min(2.0);
            let steps = 20_000;
            let integral: f64 = (0..steps)
                .map(|i| {
                    let h = (i as f32 + 0.5) / steps as f32 * reach;
                    let sin = (h * (2.0 - h)).max(0.0).sqrt();
                    f64::from(lobe.pdf(Vec3::new(sin, 1.0 - h, 0.0)))
                })
                .sum::<f64>()
                * f64::from(2.0 * PI * reach)
                / f64::from(steps);
            assert!((integral - 1.0).abs() < 2e-3, "{kappa}: {integral}");
        }
        for u in [0.0, 1.0 - 1.0 / 16_777_216.0] {
            for kappa in [1e-2f32, 1.0, 1e5] {
                let lobe = Lobe::new(1.0, Vec3::Z, kappa, 0.0);
                let w = lobe.sample(Vec2::splat(u));
                assert!((w.length() - 1.0).abs() < 1e-5);
                assert!(lobe.pdf(w).is_finite());
            }
        }
    }
}
