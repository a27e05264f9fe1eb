//! Measured materials, as tables of [`crate::bsdf::measured`].

use super::{GLOSSY_REFLECTION, Lobe, smooth_sample};
use crate::bsdf::measured::MeasuredBrdf;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// A measured material (Dupuy and Jakob 2018).
#[derive(Clone, Debug)]
pub struct Measured {
    /// What was measured.
    pub brdf: &'static MeasuredBrdf,
}

impl Model for Measured {
    type Lobe = MeasuredLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            brdf: p.measured("filename")?,
        })
    }

    fn lobe(&self, _: &Lookup) -> MeasuredLobe {
        MeasuredLobe(self.brdf)
    }

    fn textures(&self) -> Textures<'_> {
        Textures::default()
    }

    fn is_anisotropic(&self) -> bool {
        self.brdf.is_anisotropic()
    }

    fn casts_caustics(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::tabulated;
        vec![
            ("measured", tabulated("isotropic.bsdf")),
            ("measured_anisotropic", tabulated("anisotropic.bsdf")),
        ]
    }
}

/// A measured material's tables.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct MeasuredLobe(&'static MeasuredBrdf);

impl Lobe for MeasuredLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        self.0.eval_pdf(wo, wi)
    }

    fn sample(&self, wo: Vec3, _: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let wi = self.0.sample(wo, u).normalize();
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        smooth_sample(wi, value, pdf, 1.0, GLOSSY_REFLECTION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.0.albedo()
    }

    fn roughness(&self) -> Option<f32> {
        Some(self.0.roughness())
    }
}
