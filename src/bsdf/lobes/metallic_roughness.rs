//! The metallic-roughness model of glTF 2.0 (its specification's appendix B): a metal, a diffuse
//! base under rough dielectric facets, or as much of each as the file says.
//!
//! Facets are GGX with height-correlated masking (Heitz 2014). The specification leaves open how
//! the base gives way to the facets. Here it keeps what they reflect, seen from both directions
//! (Kelemen and Szirmay-Kalos 2001): a factor `(1 - E(wo)) (1 - E(wi)) / (1 - E_mean)` with the
//! facets' albedo E. It is reciprocal, and a white base returns all light.

use super::principled_parts::{facets, schlick_weight};
use super::{GLOSSY_REFLECTION, Lobe, cosine_pdf, mean, sample_over_diffuse, share};
use crate::bsdf::facet_albedo::{AlbedoCurve, facet_albedo};
use crate::bsdf::fresnel::{contrast, dielectric, reflect, sane_eta};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::transmittance::RoughTransmittance;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::FRAC_1_PI;

/// Parameters of glTF 2.0's metallic-roughness model; each in `[0, 1]` unless said otherwise.
#[derive(Clone, Debug)]
pub struct MetallicRoughness {
    /// Colour of the diffuse base, and of the metal.
    pub base_color: Texture,
    /// 0 is the dielectric, 1 the metal.
    pub metallic: Texture,
    /// Perceptual roughness, the square root of the facets' width.
    pub roughness: Texture,
    /// Relative index of refraction of the dielectric, 1 or more.
    pub eta: f32,
}

impl Model for MetallicRoughness {
    type Lobe = MetallicRoughnessLobe;

    fn read(_: &mut dyn Parameters) -> Result<Self, String> {
        Err("only glTF files have this model".into())
    }

    fn is_plugin() -> bool {
        false
    }

    fn lobe(&self, at: &Lookup) -> MetallicRoughnessLobe {
        let (color, roughness) = (at.color(&self.base_color), at.scalar(&self.roughness));
        let metallic = at.scalar(&self.metallic).clamp(0.0, 1.0);
        let eta = sane_eta(self.eta).max(1.0);
        let albedo = facet_albedo().curve(roughness, contrast(eta));
        MetallicRoughnessLobe {
            color,
            metallic,
            eta,
            facets: facets(roughness, 0.0),
            albedo,
            base: color * ((1.0 - metallic) * FRAC_1_PI / (1.0 - albedo.mean()).max(1e-3)),
        }
    }

    fn textures(&self) -> Textures<'_> {
        let (color, metallic) = (&self.base_color, &self.metallic);
        // Their product counts: one of the two may vary.
        match color.constant().or(metallic.constant()) {
            Some(_) => Textures {
                linear: vec![color, metallic],
                nonlinear: vec![&self.roughness],
            },
            None => Textures {
                linear: vec![],
                nonlinear: vec![color, metallic, &self.roughness],
            },
        }
    }

    fn prepare(&self) -> Option<&'static RoughTransmittance> {
        facet_albedo();
        None
    }

    fn casts_caustics(&self) -> bool {
        self.metallic.constant() != Some(Rgb::ZERO)
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::metallic_roughness;
        vec![
            ("metallic_roughness", metallic_roughness(0.4, 0.3)),
            (
                "metallic_roughness_dielectric",
                metallic_roughness(0.7, 0.0),
            ),
        ]
    }
}

/// The model at a point.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct MetallicRoughnessLobe {
    color: Rgb,
    metallic: f32,
    eta: f32,
    facets: Microfacet,
    albedo: AlbedoCurve,
    /// Colour of the base over pi and over what the facets leave of diffuse light.
    base: Rgb,
}

impl MetallicRoughnessLobe {
    /// Probability of sampling the facets.
    #[inline]
    fn choice(&self, albedo: f32) -> f32 {
        let (color, dielectric) = (mean(self.color), 1.0 - self.metallic);
        share(
            dielectric * albedo + self.metallic * color,
            dielectric * (1.0 - albedo) * color,
        )
    }

    /// Reflectance of a facet: Fresnel's for the dielectric, Schlick's for the metal.
    #[inline]
    fn fresnel(&self, cos: f32) -> Rgb {
        let metal = self.color.lerp(Rgb::ONE, schlick_weight(cos));
        Rgb::splat(dielectric(cos, self.eta).r).lerp(metal, self.metallic)
    }
}

impl Lobe for MetallicRoughnessLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let albedo = self.albedo.at(wo.z);
        let p = self.choice(albedo);
        let m = (wo + wi).normalize();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let facets = self.fresnel(wo.dot(m)) * (seen * self.facets.shadowing(wo, wi, m));
        let left = (1.0 - albedo).max(0.0) * (1.0 - self.albedo.at(wi.z)).max(0.0);
        let value = facets + self.base * (left * wi.z);
        (value, p * seen + (1.0 - p) * cosine_pdf(wi.z))
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let p = self.choice(self.albedo.at(wo.z));
        sample_over_diffuse(self, wo, (u_lobe, u), transport, p, || {
            reflect(wo, self.facets.sample(wo, u)).normalize()
        })
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.color
    }

    fn roughness(&self) -> Option<f32> {
        Some(self.facets.alpha())
    }
}
