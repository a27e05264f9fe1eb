//! A diffuse base under a smooth dielectric coat, with the light that bounces between them.

use super::{
    DELTA_REFLECTION, GLOSSY_REFLECTION, Lobe, cosine_pdf, mean, sample_cosine, share, weighted,
};
use crate::bsdf::fresnel::{dielectric, internal_diffuse_transmittance, sane_eta};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Smooth dielectric coat over a diffuse base, with interreflection inside.
#[derive(Clone, Debug)]
pub struct Plastic {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    /// Reflectance of the base.
    pub diffuse_reflectance: Texture,
    /// Factor on the coat's reflection.
    pub specular_reflectance: Texture,
    /// Account for colour shifts by internal scattering.
    pub nonlinear: bool,
}

impl Model for Plastic {
    type Lobe = PlasticLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.relative_ior("polypropylene"),
            diffuse_reflectance: p.reflectance("diffuse_reflectance", 0.5),
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            nonlinear: p.boolean("nonlinear", false),
        })
    }

    fn lobe(&self, at: &Lookup) -> PlasticLobe {
        let eta = sane_eta(self.eta);
        let diffuse = at.color(&self.diffuse_reflectance);
        let specular = at.color(&self.specular_reflectance);
        let leaving = internal_diffuse_transmittance(eta);
        PlasticLobe {
            eta,
            specular,
            diffuse,
            base: interreflected(diffuse, leaving, self.nonlinear) / (eta * eta),
            specular_weight: share(mean(specular), mean(diffuse)),
        }
    }

    fn textures(&self) -> Textures<'_> {
        let (base, coat) = (&self.diffuse_reflectance, &self.specular_reflectance);
        match self.nonlinear {
            true => Textures {
                linear: vec![coat],
                nonlinear: vec![base],
            },
            false => Textures {
                linear: vec![coat, base],
                nonlinear: vec![],
            },
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::plastic;
        vec![
            ("plastic", plastic(false)),
            ("plastic_nonlinear", plastic(true)),
        ]
    }
}

/// Smooth plastic, Mitsuba's formulas.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PlasticLobe {
    eta: f32,
    specular: Rgb,
    diffuse: Rgb,
    /// Colour of the base after all bounces under the coat, over eta squared.
    base: Rgb,
    /// Share of the specular reflectance in both: steers sampling.
    specular_weight: f32,
}

/// The base's colour with interreflection under a coat that lets the fraction `leaving` of diffuse
/// light out: `d / (1 - d (1 - leaving))` if the shift of colour is wanted (`nonlinear`), else the
/// base's own colour scaled as if it were white. What returns more light than it gets has no limit,
/// and counts as white between the bounces.
#[inline]
pub(in crate::bsdf) fn interreflected(diffuse: Rgb, leaving: f32, nonlinear: bool) -> Rgb {
    if nonlinear {
        let d = diffuse.clamp(Rgb::ZERO, Rgb::ONE);
        diffuse / ((Rgb::ONE - d) + d * leaving)
    } else {
        diffuse / leaving
    }
}

impl PlasticLobe {
    /// Fresnel reflectance for `wo`, and the probability of sampling the coat.
    #[inline]
    fn choice(&self, wo: Vec3) -> (f32, f32) {
        let r = dielectric(wo.z, self.eta).r;
        let p = share(
            r * self.specular_weight,
            (1.0 - r) * (1.0 - self.specular_weight),
        );
        (r, p)
    }
}

impl Lobe for PlasticLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (r, p) = self.choice(wo);
        let through = (1.0 - r) * (1.0 - dielectric(wi.z, self.eta).r);
        let cosine = cosine_pdf(wi.z);
        (self.base * (cosine * through), cosine * (1.0 - p))
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (r, p) = self.choice(wo);
        if u_lobe < p {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return weighted(wi, self.specular * (r / p), p, 1.0, DELTA_REFLECTION);
        }
        let wi = sample_cosine(u);
        let through = (1.0 - r) * (1.0 - dielectric(wi.z, self.eta).r);
        let weight = self.base * (through / (1.0 - p));
        let pdf = cosine_pdf(wi.z) * (1.0 - p);
        weighted(wi, weight, pdf, 1.0, GLOSSY_REFLECTION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION | DELTA_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.diffuse
    }

    fn roughness(&self) -> Option<f32> {
        Some(1.0)
    }
}
