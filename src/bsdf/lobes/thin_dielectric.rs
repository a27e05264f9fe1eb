//! A thin pane.

use super::{DELTA_REFLECTION, Lobe, NULL_TRANSMISSION, share, weighted};
use crate::bsdf::fresnel::{dielectric, sane_eta};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Two parallel smooth interfaces, without refraction.
#[derive(Clone, Debug)]
pub struct ThinDielectric {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    /// Factor on reflection.
    pub specular_reflectance: Texture,
    /// Factor on transmission.
    pub specular_transmittance: Texture,
}

impl Model for ThinDielectric {
    type Lobe = ThinDielectricLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.relative_ior("bk7"),
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            specular_transmittance: p.reflectance("specular_transmittance", 1.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> ThinDielectricLobe {
        ThinDielectricLobe {
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

    fn casts_caustics(&self) -> bool {
        true
    }

    fn transmits(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::material::white;
        let example = Self {
            eta: 1.5,
            specular_reflectance: white(),
            specular_transmittance: white(),
        };
        vec![("thin_dielectric", example)]
    }
}

/// A pane: reflections between its two sides are summed, what passes is not bent.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct ThinDielectricLobe {
    eta: f32,
    reflectance: Rgb,
    transmittance: Rgb,
}

impl Lobe for ThinDielectricLobe {
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
}
