//! Smooth metals.

use super::{DELTA_REFLECTION, Lobe, weighted};
use crate::bsdf::fresnel::conductor;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Smooth conductor.
#[derive(Clone, Debug)]
pub struct Conductor {
    /// Real part of the relative index of refraction. A perfect mirror (`material` = none) has
    /// eta 0 and k 1.
    pub eta: Texture,
    /// Imaginary part.
    pub k: Texture,
    /// Factor on reflection.
    pub specular_reflectance: Texture,
}

impl Model for Conductor {
    type Lobe = ConductorLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        let [eta, k] = p.conductor_ior();
        Ok(Self {
            eta,
            k,
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> ConductorLobe {
        ConductorLobe {
            metal: Metal::new(at, &self.eta, &self.k, &self.specular_reflectance),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.specular_reflectance],
            nonlinear: vec![&self.eta, &self.k],
        }
    }

    fn scatters(&self) -> bool {
        false
    }

    fn casts_caustics(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::material::white;
        use crate::bsdf::tests::models::rgb;
        let example = Self {
            eta: rgb(0.143, 0.375, 1.442),
            k: rgb(3.983, 2.386, 1.603),
            specular_reflectance: white(),
        };
        vec![("conductor", example)]
    }
}

/// A metal: its complex index of refraction `eta + i k`, and a factor that physics has at 1.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Metal {
    eta: Rgb,
    k: Rgb,
    reflectance: Rgb,
}

impl Metal {
    pub fn new(at: &Lookup, eta: &Texture, k: &Texture, reflectance: &Texture) -> Self {
        Self {
            eta: at.color(eta),
            k: at.color(k),
            reflectance: at.color(reflectance),
        }
    }

    #[inline]
    pub fn reflect(&self, cos: f32) -> Rgb {
        self.reflectance * conductor(cos, self.eta, self.k)
    }
}

/// A smooth metal.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct ConductorLobe {
    metal: Metal,
}

impl Lobe for ConductorLobe {
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
}
