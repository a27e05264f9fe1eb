//! A layer over another model that takes from what lies beneath as much as it reflects itself: the
//! albedo scaling of glTF's `KHR_materials_clearcoat` and `KHR_materials_sheen`. Light that has
//! passed meets the model beneath from the same side.

use super::layer::split;
use super::lobes::{GLOSSY_REFLECTION, Lobe, smooth_sample, weighted};
use super::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// Such a layer, at a point.
pub(super) trait AlbedoScaling {
    /// What is left for the model beneath, 0 to 1; the same for both orders of the directions.
    fn through(&self, wo: Vec3, wi: Vec3) -> f32;

    /// Probability of sampling the layer, below 1.
    fn p_layer(&self, inner: &impl Lobe, wo: Vec3) -> f32;

    /// What the layer itself reflects, times the cosine of `wi`, and the density of
    /// [`AlbedoScaling::sample_layer`]; both directions are above the surface.
    fn reflected(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32);

    /// A direction by the layer, for `wo` above the surface.
    fn sample_layer(&self, wo: Vec3, u: Vec2) -> Option<Vec3>;

    fn eval_pdf(&self, inner: &impl Lobe, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let p = self.p_layer(inner, wo);
        let (below, below_pdf) = inner.eval_pdf(wo, wi, transport);
        let (value, pdf) = (below * self.through(wo, wi), below_pdf * (1.0 - p));
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (value, pdf);
        }
        let (layer, density) = self.reflected(wo, wi);
        (value + layer, pdf + p * density)
    }

    fn sample(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        (u_lobe, u): (f32, Vec2),
        transport: Transport,
    ) -> Option<BsdfSample> {
        let p = self.p_layer(inner, wo);
        let (layer, u_lobe) = split(u_lobe, p);
        let (wi, eta, lobe) = if layer {
            (self.sample_layer(wo, u)?, 1.0, GLOSSY_REFLECTION)
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
