//! A clear varnish over another model, as glTF's `KHR_materials_clearcoat` has it: rough dielectric
//! facets of index 1.5, which take from what lies beneath as much as they reflect.
//!
//! Unlike Mitsuba's coatings it refracts nothing: light that has passed meets the model beneath
//! from the same side, and what is reflected there is not caught inside of the layer. So the model
//! keeps its colour. It is dimmed by `min(1 - E(wo), 1 - E(wi))` with the albedo E of the coat,
//! which is reciprocal and never returns more than was received.

use super::facet_albedo::{AlbedoCurve, facet_albedo};
use super::fresnel::{contrast, dielectric, reflect};
use super::layer::split;
use super::lobes::{GLOSSY_REFLECTION, Lobe, mean, share, smooth_sample, weighted};
use super::microfacet::{Distribution, Microfacet};
use super::{BsdfSample, LobeFlags, Transport};
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
    albedo: AlbedoCurve,
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
            albedo: facet_albedo().curve(roughness, contrast(ETA)),
        }
    }

    /// The coat's roughness.
    pub fn alpha(&self) -> f32 {
        self.facets.alpha()
    }

    /// What the coat reflects of light from that side; nothing from inside.
    fn reflected(&self, w: Vec3) -> f32 {
        match w.z > 0.0 {
            true => self.weight * self.albedo.at(w.z),
            false => 0.0,
        }
    }

    /// What is left for the model beneath.
    fn through(&self, wo: Vec3, wi: Vec3) -> f32 {
        1.0 - self.reflected(wo).max(self.reflected(wi)).min(1.0)
    }

    /// Probability of sampling the coat.
    fn p_coat(&self, inner: &impl Lobe, wo: Vec3) -> f32 {
        let r = self.reflected(wo);
        if r == 0.0 {
            return 0.0;
        }
        // What is black for a picture of colours may be glass.
        share(r, (1.0 - r) * mean(inner.albedo()).clamp(0.1, 1.0))
    }

    pub fn eval_pdf(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Rgb, f32) {
        let p = self.p_coat(inner, wo);
        let (below, below_pdf) = inner.eval_pdf(wo, wi, transport);
        let (value, pdf) = (below * self.through(wo, wi), below_pdf * (1.0 - p));
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (value, pdf);
        }
        let m = (wo + wi).normalize();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let r = self.weight * dielectric(wo.dot(m), ETA).r;
        let coat = r * seen * self.facets.shadowing(wo, wi, m);
        (value + Rgb::splat(coat), pdf + p * seen)
    }

    pub fn sample(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        (u_lobe, u): (f32, Vec2),
        transport: Transport,
    ) -> Option<BsdfSample> {
        let p = self.p_coat(inner, wo);
        let (coat, u_lobe) = split(u_lobe, p);
        let (wi, eta, lobe) = if coat {
            let wi = reflect(wo, self.facets.sample(wo, u)).normalize();
            if wi.z <= 0.0 {
                return None;
            }
            (wi, 1.0, GLOSSY_REFLECTION)
        } else {
            let s = inner.sample(wo, u_lobe, u, transport)?;
            if s.lobe.has(LobeFlags::DELTA) {
                let weight = s.weight * (self.through(wo, s.wi) / (1.0 - p));
                return weighted(s.wi, weight, s.pdf * (1.0 - p), s.eta, s.lobe);
            }
            (s.wi, s.eta, s.lobe)
        };
        let (value, pdf) = self.eval_pdf(inner, wo, wi, transport);
        smooth_sample(wi, value, pdf, eta, lobe)
    }
}
