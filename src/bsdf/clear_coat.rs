//! A clear varnish over another model, as glTF's `KHR_materials_clearcoat` has it: rough dielectric
//! facets of index 1.5, which take from what lies beneath as much as they reflect.
//!
//! Unlike Mitsuba's coatings it refracts nothing: light that has passed meets the model beneath
//! from the same side, and what is reflected there is not caught inside of the layer. So the model
//! keeps its colour. It is dimmed by `min(1 - E(wo), 1 - E(wi))` with the albedo E of the coat,
//! which is reciprocal and never returns more than was received.

use super::LobeFlags;
use super::albedo_scaling::AlbedoScaling;
use super::facet_albedo::{AlbedoCurve, facet_albedo};
use super::fresnel::{contrast, dielectric, reflect};
use super::lobes::{GLOSSY_REFLECTION, Lobe, mean, share};
use super::microfacet::{Distribution, Microfacet};
use crate::math::{Rgb, Vec2, Vec3};

/// Index of refraction: the extension fixes it.
const ETA: f32 = 1.5;
/// The narrowest facets.
const SMOOTHEST: f32 = 1e-3;

/// The coat at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct ClearCoat {
    weight: f32,
    facets: Microfacet,
    curve: AlbedoCurve,
}

impl ClearCoat {
    /// What the coat adds to the inner model.
    pub const FLAGS: LobeFlags = GLOSSY_REFLECTION;

    /// A coat on the share `weight` of the surface, of that perceptual roughness.
    pub fn new(weight: f32, roughness: f32) -> Self {
        let alpha = (roughness * roughness).max(SMOOTHEST);
        Self {
            weight: weight.clamp(0.0, 1.0),
            facets: Microfacet::new(Distribution::Ggx, alpha, alpha),
            curve: facet_albedo().curve(roughness, contrast(ETA)),
        }
    }

    /// The coat's roughness.
    pub fn alpha(&self) -> f32 {
        self.facets.alpha()
    }

    /// What the coat reflects of light from that side; nothing from inside.
    fn albedo(&self, w: Vec3) -> f32 {
        match w.z > 0.0 {
            true => self.weight * self.curve.at(w.z),
            false => 0.0,
        }
    }
}

impl AlbedoScaling for ClearCoat {
    fn through(&self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 - self.albedo(wo).max(self.albedo(wi)).min(1.0)
    }

    fn p_layer(&self, inner: &impl Lobe, wo: Vec3) -> f32 {
        let r = self.albedo(wo);
        if r == 0.0 {
            return 0.0;
        }
        // What is black for a picture of colours may be glass.
        share(r, (1.0 - r) * mean(inner.albedo()).clamp(0.1, 1.0))
    }

    fn reflected(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let m = (wo + wi).normalize();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let r = self.weight * dielectric(wo.dot(m), ETA).r;
        (
            Rgb::splat(r * seen * self.facets.shadowing(wo, wi, m)),
            seen,
        )
    }

    fn sample_layer(&self, wo: Vec3, u: Vec2) -> Option<Vec3> {
        let wi = reflect(wo, self.facets.sample(wo, u)).normalize();
        (wi.z > 0.0).then_some(wi)
    }
}
