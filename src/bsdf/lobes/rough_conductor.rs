//! Rough metals.

use super::conductor::Metal;
use super::{GLOSSY_REFLECTION, Lobe, weighted};
use crate::bsdf::fresnel::reflect;
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::{Parameters, Roughness};
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Rough conductor.
#[derive(Clone, Debug)]
pub struct RoughConductor {
    /// Real part of the relative index of refraction.
    pub eta: Texture,
    /// Imaginary part.
    pub k: Texture,
    /// Microfacets.
    pub roughness: Roughness,
    /// Factor on reflection.
    pub specular_reflectance: Texture,
}

impl Model for RoughConductor {
    type Lobe = RoughConductorLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        let [eta, k] = p.conductor_ior();
        Ok(Self {
            eta,
            k,
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            roughness: p.roughness(),
        })
    }

    fn lobe(&self, at: &Lookup) -> RoughConductorLobe {
        RoughConductorLobe {
            metal: Metal::new(at, &self.eta, &self.k, &self.specular_reflectance),
            facets: at.facets(&self.roughness),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.specular_reflectance],
            nonlinear: vec![
                &self.eta,
                &self.k,
                &self.roughness.alpha_u,
                &self.roughness.alpha_v,
            ],
        }
    }

    fn is_anisotropic(&self) -> bool {
        self.roughness.is_anisotropic()
    }

    fn casts_caustics(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::microfacet::Distribution::{Beckmann, Ggx};
        use crate::bsdf::tests::models::{beckmann, facets, ggx, gold};
        vec![
            ("rough_conductor_beckmann", gold(beckmann(0.2))),
            ("rough_conductor_ggx", gold(ggx(0.3))),
            ("rough_conductor_anisotropic", gold(facets(Ggx, 0.15, 0.5))),
            (
                "rough_conductor_beckmann_anisotropic",
                gold(facets(Beckmann, 0.4, 0.1)),
            ),
        ]
    }
}

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct RoughConductorLobe {
    metal: Metal,
    facets: Microfacet,
}

impl Lobe for RoughConductorLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let m = (wo + wi).normalize();
        let pdf = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let value = self.metal.reflect(wo.dot(m)) * (pdf * self.facets.g1(wi, m));
        (value, pdf)
    }

    fn sample(&self, wo: Vec3, _: f32, u: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let m = self.facets.sample(wo, u);
        let wi = reflect(wo, m).normalize();
        if wi.z <= 0.0 {
            return None;
        }
        let pdf = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let weight = self.metal.reflect(wo.dot(m)) * self.facets.g1(wi, m);
        weighted(wi, weight, pdf, 1.0, GLOSSY_REFLECTION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.metal.reflect(1.0)
    }

    fn roughness(&self) -> Option<f32> {
        Some(self.facets.alpha())
    }
}
