//! The modified Phong model (Lafortune and Willems 1994), as Mitsuba 0.6 has it.

use super::{GLOSSY_REFLECTION, Lobe, conserving, cosine_pdf, mean, sample_over_diffuse, share};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Frame, Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::{FRAC_1_PI, TAU};

/// Modified Phong (Lafortune and Willems 1994).
#[derive(Clone, Debug)]
pub struct Phong {
    /// Diffuse part.
    pub diffuse_reflectance: Texture,
    /// Specular part.
    pub specular_reflectance: Texture,
    /// Exponent.
    pub exponent: Texture,
}

impl Model for Phong {
    type Lobe = PhongLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            diffuse_reflectance: p.reflectance("diffuse_reflectance", 0.5),
            specular_reflectance: p.reflectance("specular_reflectance", 0.2),
            exponent: p.number("exponent", 30.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> PhongLobe {
        let diffuse = at.color(&self.diffuse_reflectance);
        let specular = at.color(&self.specular_reflectance);
        let (diffuse, specular) = conserving(diffuse, specular);
        PhongLobe {
            diffuse,
            specular,
            exponent: at.scalar(&self.exponent).max(0.0),
            specular_weight: share(mean(specular), mean(diffuse)),
        }
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.diffuse_reflectance, &self.specular_reflectance],
            nonlinear: vec![&self.exponent],
        }
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{grey, rgb};
        let example = Self {
            diffuse_reflectance: rgb(0.3, 0.2, 0.1),
            specular_reflectance: grey(0.4),
            exponent: grey(20.0),
        };
        vec![("phong", example)]
    }
}

/// A diffuse part and a power of the cosine around the mirror direction.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PhongLobe {
    diffuse: Rgb,
    specular: Rgb,
    exponent: f32,
    specular_weight: f32,
}

impl Lobe for PhongLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let mirror = Vec3::new(-wo.x, -wo.y, wo.z);
        let power = mirror.dot(wi).clamp(0.0, 1.0).powf(self.exponent) / TAU;
        let value = self.diffuse * FRAC_1_PI + self.specular * (power * (self.exponent + 2.0));
        let p = self.specular_weight;
        let pdf = p * power * (self.exponent + 1.0) + (1.0 - p) * cosine_pdf(wi.z);
        (value * wi.z, pdf)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        sample_over_diffuse(
            self,
            wo,
            (u_lobe, u),
            transport,
            self.specular_weight,
            || {
                let cos = u.y.powf(1.0 / (self.exponent + 1.0));
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let (sin_phi, cos_phi) = (TAU * u.x).sin_cos();
                Frame::new(Vec3::new(-wo.x, -wo.y, wo.z)).to_world(Vec3::new(
                    sin * cos_phi,
                    sin * sin_phi,
                    cos,
                ))
            },
        )
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.diffuse + self.specular
    }

    /// The Beckmann roughness whose lobe is about as wide (Walter et al. 2007).
    fn roughness(&self) -> Option<f32> {
        if self.specular_weight == 0.0 {
            return Some(1.0);
        }
        Some((2.0 / (self.exponent + 2.0)).sqrt())
    }
}
