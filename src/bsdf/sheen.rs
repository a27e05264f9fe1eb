//! A sheen of fibres over another model, as glTF's `KHR_materials_sheen` has it: Estevez and Kulla's
//! "Charlie" ("Production Friendly Microfacet Sheen BRDF", 2017), with the extension's scaling of
//! what lies beneath.
//!
//! The fibres' distribution is `(2 + 1/alpha) sin^(1/alpha) / 2 pi` in the half vector's angle, and
//! their shadowing that of the paper's fit. What lies beneath is dimmed by
//! `1 - max(color) max(E(wo), E(wi))` with the albedo E of white fibres, which is reciprocal and
//! never returns more than was received.

use super::LobeFlags;
use super::albedo_scaling::AlbedoScaling;
use super::lobes::{GLOSSY_REFLECTION, Lobe, mean, share};
use super::transmittance::gauss_legendre;
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::math::{Rgb, Vec2, Vec3};
use glam::FloatExt;
use std::f32::consts::{PI, TAU};
use std::sync::OnceLock;

/// The smoothest fibres: smoother ones shine in a line along the horizon that nothing resolves.
const SMOOTHEST: f32 = 0.07;
/// Cosines 0 to 1 of the table of albedos.
const COSINES: usize = 64;
/// Its roughnesses, [`SMOOTHEST`] to 1.
const ROUGHNESSES: usize = 16;
/// Points of the quadrature on each axis.
const NODES: usize = 32;

/// The layer at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sheen {
    color: Rgb,
    fibres: Fibres,
    /// The row of the table before the roughness, and how far beyond it.
    row: (u16, f32),
}

/// White fibres of one roughness.
#[derive(Clone, Copy, Debug)]
struct Fibres {
    inverse_alpha: f32,
    /// Where the paper's fit lies between its two ends, `(1 - alpha)^2`.
    narrow: f32,
}

impl Sheen {
    /// What it adds to the inner model.
    pub const FLAGS: LobeFlags = GLOSSY_REFLECTION;

    /// Fibres of a colour and a perceptual roughness, the square root of alpha.
    pub fn new(color: Rgb, roughness: f32) -> Self {
        // What is no number counts as the smoothest.
        let roughness = match roughness > SMOOTHEST {
            true => roughness.min(1.0),
            false => SMOOTHEST,
        };
        let x = (roughness - SMOOTHEST) / (1.0 - SMOOTHEST) * (ROUGHNESSES - 1) as f32;
        let i = (x as usize).min(ROUGHNESSES - 2);
        Self {
            color: color.clamp(Rgb::ZERO, Rgb::ONE),
            fibres: Fibres::new(roughness),
            row: (i as u16, x - i as f32),
        }
    }

    /// Albedo of white fibres seen from that direction; nothing from inside.
    fn albedo(&self, w: Vec3) -> f32 {
        if w.z <= 0.0 {
            return 0.0;
        }
        let (i, beyond) = (usize::from(self.row.0), self.row.1);
        let x = w.z.min(1.0) * (COSINES - 1) as f32;
        let j = (x as usize).min(COSINES - 2);
        let at = |row: &[f32; COSINES]| row[j].lerp(row[j + 1], x - j as f32);
        let table = albedos();
        at(&table[i]).lerp(at(&table[i + 1]), beyond)
    }
}

impl AlbedoScaling for Sheen {
    fn through(&self, wo: Vec3, wi: Vec3) -> f32 {
        let most = self.albedo(wo).max(self.albedo(wi));
        1.0 - (self.color.max_element() * most).min(1.0)
    }

    fn p_layer(&self, inner: &impl Lobe, wo: Vec3) -> f32 {
        let r = self.albedo(wo) * mean(self.color);
        if r == 0.0 {
            return 0.0;
        }
        // What is black for a picture of colours may be glass.
        share(r, (1.0 - r).max(0.0) * mean(inner.albedo()).clamp(0.1, 1.0))
    }

    fn reflected(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let fibres = self.color * self.fibres.reflected(wo, wi);
        (fibres, cosine_hemisphere_pdf(wi.z))
    }

    fn sample_layer(&self, _: Vec3, u: Vec2) -> Option<Vec3> {
        Some(cosine_hemisphere(u))
    }
}

impl Fibres {
    fn new(roughness: f32) -> Self {
        let alpha = roughness * roughness;
        Self {
            inverse_alpha: 1.0 / alpha,
            narrow: (1.0 - alpha) * (1.0 - alpha),
        }
    }

    /// Value times the cosine of `wi`; both directions are above the surface.
    fn reflected(&self, wo: Vec3, wi: Vec3) -> f32 {
        let cos = (wo + wi).normalize_or(Vec3::Z).z;
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let d = (2.0 + self.inverse_alpha) * sin.powf(self.inverse_alpha) / TAU;
        d / ((1.0 + self.lambda(wo.z) + self.lambda(wi.z)) * 4.0 * wo.z.max(1e-4))
    }

    /// The paper's fit of Smith's function, equation 3 and table 1.
    fn lambda(&self, cos: f32) -> f32 {
        let fit = |x: f32| {
            let between = |wide: f32, narrow: f32| wide.lerp(narrow, self.narrow);
            let (a, b) = (between(21.5473, 25.3245), between(3.82987, 3.32435));
            let (c, d) = (between(0.19823, 0.16801), between(-1.97760, -1.27393));
            a / (1.0 + b * x.powf(c)) + d * x + between(-4.32054, -4.85967)
        };
        match cos < 0.5 {
            true => fit(cos.max(1e-4)).exp(),
            false => (2.0 * fit(0.5) - fit((1.0 - cos).max(1e-4))).exp(),
        }
    }

    /// The part of light from `wo` that is reflected in all: an integral over directions whose
    /// cosine is a square, as the fibres shine along the horizon.
    fn albedo(&self, wo: Vec3, rule: &[(f32, f32)]) -> f32 {
        let mut sum = 0.0;
        for (t, weight) in rule {
            let cos = t * t;
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            for (turn, share) in rule {
                let (y, x) = (turn * PI).sin_cos();
                let wi = Vec3::new(x * sin, y * sin, cos);
                sum += weight * share * 2.0 * t * TAU * self.reflected(wo, wi);
            }
        }
        sum
    }
}

/// Albedos of white fibres by roughness and cosine, made at the first use.
pub(super) fn albedos() -> &'static [[f32; COSINES]; ROUGHNESSES] {
    static TABLE: OnceLock<[[f32; COSINES]; ROUGHNESSES]> = OnceLock::new();
    TABLE.get_or_init(|| {
        let rule = gauss_legendre::<NODES>();
        std::array::from_fn(|i| {
            let x = i as f32 / (ROUGHNESSES - 1) as f32;
            let fibres = Fibres::new(SMOOTHEST.lerp(1.0, x));
            std::array::from_fn(|j| {
                let cos = (j as f32 / (COSINES - 1) as f32).max(1e-2);
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                fibres.albedo(wo, &rule).min(1.0)
            })
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    /// The table against uniform directions, whose means have an error of 0.5 %.
    #[test]
    fn albedos_are_those_of_the_fibres() {
        let mut rng = Pcg32::new(8, 1);
        for roughness in [0.2f32, 0.35, 0.5, 0.8, 1.0] {
            let sheen = Sheen::new(Rgb::ONE, roughness);
            for cos in [0.15f32, 0.4, 0.7, 0.97] {
                let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
                let draws = 200_000;
                let mut sum = 0.0;
                for _ in 0..draws {
                    let u = Vec2::new(rng.next_f32(), rng.next_f32());
                    let any = crate::math::warp::uniform_sphere(u);
                    let wi = Vec3::new(any.x, any.y, any.z.abs());
                    sum += f64::from(sheen.fibres.reflected(wo, wi));
                }
                let found = (sum / f64::from(draws)) as f32 * TAU;
                let table = sheen.albedo(wo);
                assert!(
                    (table - found).abs() < 0.01 * found + 1e-3,
                    "roughness {roughness} cos {cos}: {table} for {found}"
                );
            }
        }
    }

    /// By hand, from the paper: alpha 0.25 seen along the normal, light at 60 degrees.
    #[test]
    fn fibres_follow_the_papers_equations() {
        let fibres = Fibres::new(0.5);
        let wi = Vec3::new(0.75f32.sqrt(), 0.0, 0.5);
        // The half vector is at 30 degrees: sin^4 = 1/16, so D = 6 / 16 / 2 pi.
        let d = 6.0 / 16.0 / TAU;
        let n = 0.5625f32;
        let between = |p0: f32, p1: f32| p0 * n + p1 * (1.0 - n);
        let l = |x: f32| {
            between(25.3245, 21.5473)
                / (1.0 + between(3.32435, 3.82987) * x.powf(between(0.16801, 0.19823)))
                + between(-1.27393, -1.97760) * x
                + between(-4.85967, -4.32054)
        };
        let (at_normal, at_light) = ((2.0 * l(0.5) - l(1e-4)).exp(), l(0.5).exp());
        let expected = d / ((1.0 + at_normal + at_light) * 4.0);
        let found = fibres.reflected(Vec3::Z, wi);
        assert!((found / expected - 1.0).abs() < 1e-4, "{found} {expected}");
    }
}
