//! A smooth refracting interface.

use super::{DELTA_REFLECTION, DELTA_TRANSMISSION, Lobe, share, weighted};
use crate::bsdf::fresnel::{dielectric, sane_eta};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Smooth dielectric interface.
#[derive(Clone, Debug)]
pub struct Dielectric {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    /// Factor on reflection.
    pub specular_reflectance: Texture,
    /// Factor on transmission.
    pub specular_transmittance: Texture,
}

impl Model for Dielectric {
    type Lobe = DielectricLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.relative_ior("bk7"),
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            specular_transmittance: p.reflectance("specular_transmittance", 1.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> DielectricLobe {
        DielectricLobe {
            eta: sane_eta(self.eta),
            reflectance: at.color(&self.specular_reflectance),
            transmittance: at.color(&self.specular_transmittance),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.specular_reflectance, &self.specular_transmittance],
            nonlinear: vec![],
        }
    }

    fn scatters(&self) -> bool {
        false
    }

    fn refracts(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        vec![("dielectric", crate::bsdf::tests::models::clear(1.5))]
    }
}

/// A smooth interface between two dielectrics.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct DielectricLobe {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    pub reflectance: Rgb,
    pub transmittance: Rgb,
}

impl Lobe for DielectricLobe {
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
}
