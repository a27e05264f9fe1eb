//! Lambertian transmission.

use super::{GLOSSY_TRANSMISSION, Lobe, cosine_pdf, sample_cosine, weighted};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Lambertian transmission (Mitsuba 0.x `difftrans`).
#[derive(Clone, Debug)]
pub struct DiffuseTransmitter {
    /// Transmittance.
    pub transmittance: Texture,
}

impl Model for DiffuseTransmitter {
    type Lobe = DiffuseTransmitterLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            transmittance: p.reflectance("transmittance", 0.5),
        })
    }

    fn lobe(&self, at: &Lookup) -> DiffuseTransmitterLobe {
        DiffuseTransmitterLobe {
            transmittance: at.color(&self.transmittance),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.transmittance],
            nonlinear: vec![],
        }
    }

    fn transmits(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::rgb;
        let transmittance = rgb(0.2, 0.5, 0.8);
        vec![("diffuse_transmitter", Self { transmittance })]
    }
}

/// Lambertian transmission, both ways.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct DiffuseTransmitterLobe {
    pub transmittance: Rgb,
}

impl Lobe for DiffuseTransmitterLobe {
    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z * wi.z >= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let pdf = cosine_pdf(wi.z.abs());
        (self.transmittance * pdf, pdf)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _: f32, u: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let mut wi = sample_cosine(u);
        let pdf = cosine_pdf(wi.z);
        wi.z = -wi.z * wo.z.signum();
        weighted(wi, self.transmittance, pdf, 1.0, GLOSSY_TRANSMISSION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        self.transmittance
    }

    fn roughness(&self) -> Option<f32> {
        Some(1.0)
    }
}
