//! Metals, smooth and rough.

use super::{DELTA_REFLECTION, GLOSSY_REFLECTION, Lobe, weighted};
use crate::bsdf::fresnel::{conductor, reflect};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// A metal: its complex index of refraction `eta + i k`, and a factor that physics has at 1.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Metal {
    pub eta: Rgb,
    pub k: Rgb,
    pub reflectance: Rgb,
}

impl Metal {
    #[inline]
    fn reflect(&self, cos: f32) -> Rgb {
        self.reflectance * conductor(cos, self.eta, self.k)
    }
}

/// A smooth metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Conductor {
    pub metal: Metal,
}

impl Lobe for Conductor {
    #[inline]
    fn eval_pdf(&self, _: Vec3, _: Vec3, _: Transport) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    fn sample(&self, wo: Vec3, _: f32, _: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = Vec3::new(-wo.x, -wo.y, wo.z);
        weighted(wi, self.metal.reflect(wo.z), 1.0, 1.0, DELTA_REFLECTION)
    }

    fn flags(&self) -> LobeFlags {
        DELTA_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.metal.reflect(1.0)
    }

    fn roughness(&self) -> Option<f32> {
        None
    }
}

/// A rough metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct RoughConductor {
    pub metal: Metal,
    pub facets: Microfacet,
}

impl Lobe for RoughConductor {
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
