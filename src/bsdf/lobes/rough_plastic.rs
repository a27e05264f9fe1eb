//! A diffuse base under a rough dielectric coat.

use super::{
    GLOSSY_REFLECTION, Lobe, cosine_pdf, mean, plastic::interreflected, sample_over_diffuse, share,
};
use crate::bsdf::fresnel::{dielectric, reflect, sane_eta};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::{Parameters, Roughness};
use crate::bsdf::transmittance::RoughTransmittance;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;

/// Rough dielectric coat over a diffuse base.
#[derive(Clone, Debug)]
pub struct RoughPlastic {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    /// Microfacets of the coat (isotropic: `alpha_u` is used).
    pub roughness: Roughness,
    /// Reflectance of the base.
    pub diffuse_reflectance: Texture,
    /// Factor on the coat's reflection.
    pub specular_reflectance: Texture,
    /// Account for colour shifts by internal scattering.
    pub nonlinear: bool,
}

impl Model for RoughPlastic {
    type Lobe = RoughPlasticLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.relative_ior("polypropylene"),
            diffuse_reflectance: p.reflectance("diffuse_reflectance", 0.5),
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            nonlinear: p.boolean("nonlinear", false),
            roughness: p.roughness(),
        })
    }

    fn lobe(&self, at: &Lookup) -> RoughPlasticLobe {
        let eta = sane_eta(self.eta);
        let diffuse = at.color(&self.diffuse_reflectance);
        let specular = at.color(&self.specular_reflectance);
        let table = at.coat_table(&self.roughness, self.eta);
        let base = interreflected(diffuse, 1.0 - table.internal_reflectance, self.nonlinear);
        RoughPlasticLobe {
            eta,
            facets: at.coat(&self.roughness),
            specular,
            diffuse,
            base: base * (FRAC_1_PI / (eta * eta)),
            specular_weight: share(mean(specular), mean(diffuse)),
            table,
            part: Part::Both,
        }
    }

    fn textures(&self) -> Textures<'_> {
        let (base, coat) = (&self.diffuse_reflectance, &self.specular_reflectance);
        let alpha = &self.roughness.alpha_u;
        match self.nonlinear {
            true => Textures {
                linear: vec![coat],
                nonlinear: vec![alpha, base],
            },
            false => Textures {
                linear: vec![coat, base],
                nonlinear: vec![alpha],
            },
        }
    }

    fn prepare(&self) -> Option<&'static RoughTransmittance> {
        Some(self.roughness.coat_table(self.eta))
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{base, beckmann, ggx};
        let example = |eta, roughness, nonlinear| Self {
            eta,
            roughness,
            diffuse_reflectance: base(),
            specular_reflectance: crate::bsdf::material::white(),
            nonlinear,
        };
        vec![
            (
                "rough_plastic_beckmann",
                example(1.49, beckmann(0.15), false),
            ),
            ("rough_plastic_ggx", example(1.7, ggx(0.4), true)),
        ]
    }
}

/// Rough plastic, Mitsuba 3's formulas.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct RoughPlasticLobe {
    eta: f32,
    facets: Microfacet,
    specular: Rgb,
    diffuse: Rgb,
    /// Colour of the base after all bounces under the coat, over pi eta^2.
    base: Rgb,
    specular_weight: f32,
    table: &'static RoughTransmittance,
    part: Part,
}

/// What of it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Both,
    Coat,
    Base,
}

/// Neither part is chosen less often: the coat is dim, but may mirror a bright lamp. (Relative
/// variance times time of a kitchen for 0.25 and 0.02: 47.4, 49.9.)
const LEAST_CHANCE: f32 = 0.25;

impl RoughPlasticLobe {
    /// Transmittance towards `wo`, and the probability of sampling the coat.
    #[inline]
    fn choice(&self, wo: Vec3) -> (f32, f32) {
        let t = self.table.entering(wo.z);
        let p = match self.part {
            Part::Both => share(
                (1.0 - t).max(0.0) * self.specular_weight,
                t * (1.0 - self.specular_weight),
            ),
            Part::Coat => 1.0,
            Part::Base => 0.0,
        };
        (t, p)
    }

    /// Leaves one of its parts away, by a uniform `u`, as seen at this cosine. What is left is to
    /// be multiplied by the factor returned.
    #[inline]
    pub fn choose_part(&mut self, cos: f32, u: f32) -> f32 {
        let (_, p) = self.choice(Vec3::new(0.0, 0.0, cos));
        let p = p.clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE);
        if u < p {
            self.part = Part::Coat;
            return 1.0 / p;
        }
        self.part = Part::Base;
        1.0 / (1.0 - p)
    }

    /// What its radiance is in proportion to, whatever falls on it: the transmittance towards the
    /// eye. None with its coat.
    #[inline]
    pub fn view(&self) -> Option<&'static RoughTransmittance> {
        (self.part == Part::Base).then_some(self.table)
    }
}

impl Lobe for RoughPlasticLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (t, p) = self.choice(wo);
        let base = self.base * (wi.z * t * self.table.entering(wi.z));
        if self.part == Part::Base {
            return (base, cosine_pdf(wi.z));
        }
        let m = (wo + wi).normalize();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let coat = dielectric(wo.dot(m), self.eta).r * seen * self.facets.g1(wi, m);
        let coat = self.specular * coat;
        let value = if self.part == Part::Coat {
            coat
        } else {
            coat + base
        };
        (value, p * seen + (1.0 - p) * cosine_pdf(wi.z))
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (_, p) = self.choice(wo);
        sample_over_diffuse(self, wo, (u_lobe, u), transport, p, || {
            reflect(wo, self.facets.sample(wo, u)).normalize()
        })
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.diffuse
    }

    fn roughness(&self) -> Option<f32> {
        match self.part {
            Part::Base => Some(1.0),
            Part::Both | Part::Coat => Some(self.facets.alpha()),
        }
    }
}
