//! Smooth dielectrics: a refracting interface, a thin pane, and nothing at all.

use super::{DELTA_REFLECTION, DELTA_TRANSMISSION, Lobe, NULL_TRANSMISSION, share, weighted};
use crate::bsdf::fresnel::dielectric;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// A smooth interface between two dielectrics.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Dielectric {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Lobe for Dielectric {
    #[inline]
    fn eval_pdf(&self, _: Vec3, _: Vec3, _: Transport) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, _: Vec2, transport: Transport) -> Option<BsdfSample> {
        let i = dielectric(wo.z, self.eta);
        let (r, t) = (self.reflectance * i.r, self.transmittance * (1.0 - i.r));
        let p = share(r.max_element(), t.max_element());
        if u_lobe < p {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return weighted(wi, r / p, p, 1.0, DELTA_REFLECTION);
        }
        let wi = Vec3::new(-i.eta_ti * wo.x, -i.eta_ti * wo.y, i.cos_t).normalize();
        // Radiance is compressed into a smaller solid angle; power is not.
        let scale = match transport {
            Transport::Radiance => i.eta_ti * i.eta_ti,
            Transport::Importance => 1.0,
        };
        weighted(
            wi,
            t * (scale / (1.0 - p)),
            1.0 - p,
            i.eta_it,
            DELTA_TRANSMISSION,
        )
    }

    fn flags(&self) -> LobeFlags {
        DELTA_REFLECTION | DELTA_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        self.reflectance.max(self.transmittance)
    }

    fn roughness(&self) -> Option<f32> {
        None
    }
}

/// A pane: reflections between its two sides are summed, what passes is not bent.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct ThinDielectric {
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Lobe for ThinDielectric {
    #[inline]
    fn eval_pdf(&self, _: Vec3, _: Vec3, _: Transport) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, _: Vec2, _: Transport) -> Option<BsdfSample> {
        // r + t r t + t r^3 t + ... = 2 r / (1 + r)
        let one = dielectric(wo.z.abs(), self.eta).r;
        let both = 2.0 * one / (1.0 + one);
        let (r, t) = (self.reflectance * both, self.transmittance * (1.0 - both));
        let p = share(r.max_element(), t.max_element());
        if u_lobe < p {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return weighted(wi, r / p, p, 1.0, DELTA_REFLECTION);
        }
        weighted(-wo, t / (1.0 - p), 1.0 - p, 1.0, NULL_TRANSMISSION)
    }

    fn flags(&self) -> LobeFlags {
        DELTA_REFLECTION | NULL_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        self.reflectance.max(self.transmittance)
    }

    fn roughness(&self) -> Option<f32> {
        None
    }
}

/// An index-matched surface.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Null;

impl Lobe for Null {
    #[inline]
    fn eval_pdf(&self, _: Vec3, _: Vec3, _: Transport) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    fn sample(&self, wo: Vec3, _: f32, _: Vec2, _: Transport) -> Option<BsdfSample> {
        weighted(-wo, Rgb::ONE, 1.0, 1.0, NULL_TRANSMISSION)
    }

    fn flags(&self) -> LobeFlags {
        NULL_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        Rgb::ONE
    }

    fn roughness(&self) -> Option<f32> {
        None
    }
}
