//! Ward's anisotropic model in three variants, as Mitsuba 0.6 has it.

use super::{GLOSSY_REFLECTION, Lobe, conserving, cosine_pdf, mean, sample_over_diffuse, share};
use crate::bsdf::fresnel::reflect;
use crate::bsdf::material::WardVariant;
use crate::bsdf::microfacet::{MIN_ALPHA, sample_gaussian_half};
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// A diffuse part and an elliptical Gaussian of half vectors.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Ward {
    variant: WardVariant,
    diffuse: Rgb,
    specular: Rgb,
    alpha: Vec2,
    specular_weight: f32,
}

impl Ward {
    pub fn new(variant: WardVariant, diffuse: Rgb, specular: Rgb, alpha: Vec2) -> Self {
        let (diffuse, specular) = conserving(diffuse, specular);
        Self {
            variant,
            diffuse,
            specular,
            alpha: Vec2::new(alpha.x.max(MIN_ALPHA), alpha.y.max(MIN_ALPHA)),
            specular_weight: share(mean(specular), mean(diffuse)),
        }
    }

    /// The specular f and its density.
    fn specular(&self, wo: Vec3, wi: Vec3) -> (f32, f32) {
        let h = wo + wi;
        let (x, y) = (h.x / self.alpha.x, h.y / self.alpha.y);
        let bell = (-(x * x + y * y) / (h.z * h.z)).exp() / (PI * self.alpha.x * self.alpha.y);
        let h2 = h.length_squared();
        let factor = match self.variant {
            WardVariant::Ward => 0.25 / (wo.z * wi.z).sqrt(),
            WardVariant::WardDuer => 0.25 / (wo.z * wi.z),
            WardVariant::Balanced => h2 / (h.z * h.z * h.z * h.z),
        };
        // 1 / (4 (h . wo) cos^3), with h normalised: h . wo = |h|/2.
        let pdf = bell * h2 / (2.0 * h.z * h.z * h.z);
        let value = bell * factor;
        // Tiny values have no digits left, and neither has their density.
        if value > 1e-10 && value.is_finite() && pdf.is_finite() {
            (value, pdf)
        } else {
            (0.0, 0.0)
        }
    }
}

impl Lobe for Ward {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (specular, specular_pdf) = self.specular(wo, wi);
        let value = self.diffuse * FRAC_1_PI + self.specular * specular;
        let p = self.specular_weight;
        let pdf = p * specular_pdf + (1.0 - p) * cosine_pdf(wi.z);
        (value * wi.z, pdf)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        sample_over_diffuse(
            self,
            wo,
            (u_lobe, u),
            transport,
            self.specular_weight,
            || reflect(wo, sample_gaussian_half(self.alpha, u)).normalize(),
        )
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.diffuse + self.specular
    }

    fn roughness(&self) -> Option<f32> {
        if self.specular_weight == 0.0 {
            return Some(1.0);
        }
        Some(self.alpha.min_element())
    }
}
