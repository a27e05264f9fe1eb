//! How much light passes a rough dielectric interface: tables for the models that put one over
//! something else (rough plastic, rough coating).
//!
//! The tables are those of Mitsuba 3: 64 cosines, each integrated over visible normals by Gauss and
//! Legendre's rule. A table depends on the distribution, roughness and index alone, so each is made
//! once and kept for the life of the process: at most a few hundred bytes for every distinct coat,
//! and a [`super::Bsdf`] can hold a plain reference to it.

use super::fresnel::{dielectric, reflect, refract};
use super::microfacet::{Distribution, Microfacet};
use crate::math::{Vec2, Vec3};
use std::collections::HashMap;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Entries of a table, Mitsuba's number.
const SIZE: usize = 64;
/// Points of the quadrature on each axis for light from outside.
const NODES: usize = 32;
/// The same for light from inside, where total reflection begins with a kink.
const NODES_INSIDE: usize = 64;

/// Transmittance of one rough interface for directional and for diffuse light.
#[derive(Clone, Debug)]
pub(super) struct RoughTransmittance {
    /// Fraction of light that arrives from outside at cosine `i / (SIZE - 1)` and gets inside.
    from_outside: [f32; SIZE],
    /// Fraction of diffuse light from inside that is sent back.
    pub internal_reflectance: f32,
}

/// What a table depends on: distribution and the bits of alpha and eta.
type Key = (Distribution, u32, u32);

/// The table for an isotropic coat, made at its first use.
pub(super) fn rough_transmittance(
    distribution: Distribution,
    alpha: f32,
    eta: f32,
) -> &'static RoughTransmittance {
    static TABLES: OnceLock<Mutex<HashMap<Key, &'static RoughTransmittance>>> = OnceLock::new();
    let mut tables = TABLES
        .get_or_init(Mutex::default)
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    let facets = Microfacet::new(distribution, alpha, alpha);
    let key = (distribution, facets.alpha().to_bits(), eta.to_bits());
    tables
        .entry(key)
        .or_insert_with(|| Box::leak(Box::new(RoughTransmittance::integrate(&facets, eta))))
}

impl RoughTransmittance {
    /// Transmittance from outside at the given cosine, 0 to 1.
    #[inline]
    pub fn entering(&self, cos: f32) -> f32 {
        let x = cos.clamp(0.0, 1.0) * (SIZE - 1) as f32;
        let i = (x as usize).min(SIZE - 2);
        let (a, b) = (self.from_outside[i], self.from_outside[i + 1]);
        a + (b - a) * (x - i as f32)
    }

    fn integrate(facets: &Microfacet, eta: f32) -> Self {
        let rule = gauss_legendre::<NODES>();
        let rule_inside = gauss_legendre::<NODES_INSIDE>();
        let mut from_outside = [0.0; SIZE];
        let mut inside = 0.0;
        for (i, t) in from_outside.iter_mut().enumerate() {
            let cos = (i as f32 / (SIZE - 1) as f32).max(1e-6);
            let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
            *t = over_normals(facets, wo, &rule, |m| transmitted(facets, wo, m, eta));
            inside += cos
                * over_normals(facets, wo, &rule_inside, |m| {
                    reflected(facets, wo, m, 1.0 / eta)
                });
        }
        Self {
            from_outside,
            // Mitsuba's mean over the 64 cosines, end points included. It is about 1.5 % below the
            // integral, which makes rough plastic a little darker; kept so that images agree.
            internal_reflectance: (2.0 * inside / SIZE as f32).clamp(0.0, 0.999),
        }
    }
}

fn transmitted(facets: &Microfacet, wo: Vec3, m: Vec3, eta: f32) -> f32 {
    let i = dielectric(wo.dot(m), eta);
    let wi = refract(wo, m, &i);
    if wi.z >= 0.0 {
        return 0.0;
    }
    facets.g1(wi, m) * (1.0 - i.r)
}

fn reflected(facets: &Microfacet, wo: Vec3, m: Vec3, eta: f32) -> f32 {
    let wi = reflect(wo, m);
    if wi.z <= 0.0 {
        return 0.0;
    }
    facets.g1(wi, m) * dielectric(wo.dot(m), eta).r
}

/// Mean of `f` over the normals visible from `wo`.
pub(super) fn over_normals(
    facets: &Microfacet,
    wo: Vec3,
    rule: &[(f32, f32)],
    f: impl Fn(Vec3) -> f32,
) -> f32 {
    let mut sum = 0.0f64;
    for &(x, weight_x) in rule {
        for &(y, weight_y) in rule {
            let value = f(facets.sample(wo, Vec2::new(x, y)));
            sum += f64::from(value * weight_x * weight_y);
        }
    }
    sum as f32
}

/// Nodes and weights of Gauss and Legendre's rule on `[0, 1]`: the roots of the Legendre polynomial
/// by Newton's method, from the asymptotic guess.
pub(super) fn gauss_legendre<const N: usize>() -> [(f32, f32); N] {
    let n = N as f64;
    std::array::from_fn(|i| {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
        let mut derivative = 1.0;
        for _ in 0..8 {
            let (mut p0, mut p1) = (1.0, x);
            for k in 2..=N {
                let k = k as f64;
                (p0, p1) = (p1, ((2.0 * k - 1.0) * x * p1 - (k - 1.0) * p0) / k);
            }
            derivative = n * (x * p1 - p0) / (x * x - 1.0);
            x -= p1 / derivative;
        }
        let weight = 1.0 / ((1.0 - x * x) * derivative * derivative);
        ((0.5 + 0.5 * x) as f32, weight as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rule_integrates_polynomials() {
        let rule = gauss_legendre::<NODES>();
        for power in [0, 1, 2, 7, 20] {
            let sum: f64 = rule
                .iter()
                .map(|&(x, w)| f64::from(w) * f64::from(x).powi(power))
                .sum();
            assert!((sum * f64::from(power + 1) - 1.0).abs() < 1e-5, "{power}");
        }
    }

    #[test]
    fn a_nearly_smooth_table_is_fresnels_transmittance() {
        let table = rough_transmittance(Distribution::Ggx, 1e-4, 1.5);
        for i in 8..SIZE {
            let cos = i as f32 / (SIZE - 1) as f32;
            let exact = 1.0 - dielectric(cos, 1.5).r;
            assert!((table.entering(cos) - exact).abs() < 1e-3, "{cos}");
        }
        assert!((table.internal_reflectance - 0.5959 * 63.0 / 64.0).abs() < 5e-3);
    }
}
