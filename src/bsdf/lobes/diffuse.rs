//! Lambertian reflection.

use super::{GLOSSY_REFLECTION, Lobe, cosine_pdf, sample_cosine, weighted};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Lambertian reflection.
#[derive(Clone, Debug)]
pub struct Diffuse {
    /// Reflectance.
    pub reflectance: Texture,
}

impl Model for Diffuse {
    type Lobe = DiffuseLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        let name = p.either(&["reflectance", "diffuse_reflectance"]);
        Ok(Self {
            reflectance: p.reflectance(name, 0.5),
        })
    }

    fn lobe(&self, at: &Lookup) -> DiffuseLobe {
        DiffuseLobe {
            reflectance: at.color(&self.reflectance),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.reflectance],
            nonlinear: vec![],
        }
    }

    fn scatters(&self) -> bool {
        self.reflectance.constant() != Some(Rgb::ZERO)
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::rgb;
        let reflectance = rgb(0.2, 0.5, 0.8);
        vec![("diffuse", Self { reflectance })]
    }
}

/// Lambertian reflection from the front.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct DiffuseLobe {
    pub reflectance: Rgb,
}

impl DiffuseLobe {
    /// What every diffuse reflection does.
    pub const FLAGS: LobeFlags = GLOSSY_REFLECTION;
}

impl Lobe for DiffuseLobe {
    #[inline]
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let pdf = cosine_pdf(wi.z);
        (self.reflectance * pdf, pdf)
    }

    #[inline]
    fn sample(&self, wo: Vec3, _: f32, u: Vec2, _: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = sample_cosine(u);
        weighted(
            wi,
            self.reflectance,
            cosine_pdf(wi.z),
            1.0,
            GLOSSY_REFLECTION,
        )
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.reflectance
    }

    fn roughness(&self) -> Option<f32> {
        Some(1.0)
    }
}
