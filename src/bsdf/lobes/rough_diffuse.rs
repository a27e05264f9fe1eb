//! Oren and Nayar's rough diffuse reflection.

use super::{GLOSSY_REFLECTION, Lobe, cosine_pdf, sample_cosine, weighted};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::{FRAC_1_PI, FRAC_1_SQRT_2};

/// Oren-Nayar reflection (Mitsuba 0.x `roughdiffuse`).
#[derive(Clone, Debug)]
pub struct RoughDiffuse {
    /// Reflectance of the facets.
    pub reflectance: Texture,
    /// Roughness as the standard deviation of the slope, converted as Mitsuba 0.x does.
    pub alpha: Texture,
    /// Use the faster qualitative model.
    pub fast_approx: bool,
}

impl Model for RoughDiffuse {
    type Lobe = RoughDiffuseLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        let name = p.either(&["reflectance", "diffuse_reflectance"]);
        Ok(Self {
            reflectance: p.reflectance(name, 0.5),
            alpha: p.number("alpha", 0.2),
            fast_approx: p.boolean("use_fast_approx", false),
        })
    }

    fn lobe(&self, at: &Lookup) -> RoughDiffuseLobe {
        // Mitsuba's alpha is a Beckmann-style root mean square slope, from which it takes sigma.
        let sigma = at.scalar(&self.alpha).max(0.0) * FRAC_1_SQRT_2;
        RoughDiffuseLobe {
            reflectance: at.color(&self.reflectance),
            sigma2: sigma * sigma,
            fast_approx: self.fast_approx,
        }
    }

    fn textures(&self) -> Textures<'_> {
        // Light between the facets has the colour twice.
        Textures {
            linear: vec![],
            nonlinear: vec![&self.reflectance, &self.alpha],
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{grey, rgb};
        let example = |fast_approx| Self {
            reflectance: rgb(0.2, 0.5, 0.8),
            alpha: grey(0.5),
            fast_approx,
        };
        vec![
            ("rough_diffuse", example(false)),
            ("rough_diffuse_fast", example(true)),
        ]
    }
}

/// Rough diffuse reflection (Oren and Nayar 1994), with the constants and the choice of Mitsuba
/// 0.6: the full model with one interreflection, or the paper's qualitative model.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct RoughDiffuseLobe {
    reflectance: Rgb,
    /// Squared standard deviation of the slope angle.
    sigma2: f32,
    fast_approx: bool,
}

impl RoughDiffuseLobe {
    /// f times pi.
    fn shape(&self, wo: Vec3, wi: Vec3) -> Rgb {
        let sin = |w: Vec3| (1.0 - w.z * w.z).max(0.0).sqrt();
        let (sin_o, sin_i) = (sin(wo), sin(wi));
        let cos_phi = if sin_o > 1e-4 && sin_i > 1e-4 {
            ((wo.x * wi.x + wo.y * wi.y) / (sin_o * sin_i)).clamp(-1.0, 1.0)
        } else {
            0.0
        };
        // "alpha" is the larger angle to the normal, "beta" the smaller.
        let (sin_alpha, sin_beta, cos_alpha, cos_beta) = if wo.z > wi.z {
            (sin_i, sin_o, wi.z, wo.z)
        } else {
            (sin_o, sin_i, wo.z, wi.z)
        };
        let tan_beta = sin_beta / cos_beta;
        let s2 = self.sigma2;
        let c1 = 1.0 - 0.5 * s2 / (s2 + 0.33);
        let spread = s2 / (s2 + 0.09);
        if self.fast_approx {
            return self.reflectance
                * (c1 + 0.45 * spread * cos_phi.max(0.0) * sin_alpha * tan_beta);
        }
        let (alpha, beta) = (cos_alpha.min(1.0).acos(), cos_beta.min(1.0).acos());
        let b = 2.0 * FRAC_1_PI * beta;
        let c2 = 0.45
            * spread
            * if cos_phi > 0.0 {
                sin_alpha
            } else {
                sin_alpha - b * b * b
            };
        let product = 4.0 * FRAC_1_PI * FRAC_1_PI * alpha * beta;
        let c3 = 0.125 * spread * product * product;
        let c4 = 0.17 * s2 / (s2 + 0.13);
        let tan_half = (sin_alpha + sin_beta) / (cos_alpha + cos_beta);
        let single = c1 + cos_phi * c2 * tan_beta + (1.0 - cos_phi.abs()) * c3 * tan_half;
        let double = c4 * (1.0 - cos_phi * b * b);
        self.reflectance * single + self.reflectance * self.reflectance * double
    }
}

impl Lobe for RoughDiffuseLobe {
    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let pdf = cosine_pdf(wi.z);
        (self.shape(wo, wi) * pdf, pdf)
    }

    fn sample(&self, wo: Vec3, _: f32, u: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = sample_cosine(u);
        let weight = self.shape(wo, wi);
        weighted(wi, weight, cosine_pdf(wi.z), 1.0, GLOSSY_REFLECTION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.reflectance
    }

    fn roughness(&self) -> Option<f32> {
        Some(1.0)
    }
}
