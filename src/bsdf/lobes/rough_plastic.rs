//! A diffuse base under a rough dielectric coat.

use super::{
    GLOSSY_REFLECTION, Lobe, cosine_pdf, mean, plastic::interreflected, sample_over_diffuse, share,
};
use crate::bsdf::fresnel::{dielectric, reflect};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::transmittance::RoughTransmittance;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Rough plastic, Mitsuba 3's formulas.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct RoughPlastic {
    eta: f32,
    facets: Microfacet,
    specular: Rgb,
    diffuse: Rgb,
    /// Colour of the base after all bounces under the coat, over pi eta^2.
    base: Rgb,
    specular_weight: f32,
    table: &'static RoughTransmittance,
    part: Part,
}

/// What of it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Both,
    Coat,
    Base,
}

/// Neither part is chosen less often: the coat is dim, but may mirror a bright lamp. (Relative
/// variance times time of a kitchen for 0.25 and 0.02: 47.4, 49.9.)
const LEAST_CHANCE: f32 = 0.25;

impl RoughPlastic {
    pub fn new(
        eta: f32,
        facets: Microfacet,
        (diffuse, specular): (Rgb, Rgb),
        nonlinear: bool,
        table: &'static RoughTransmittance,
    ) -> Self {
        let base = interreflected(diffuse, 1.0 - table.internal_reflectance, nonlinear);
        Self {
            eta,
            facets,
            specular,
            diffuse,
            base: base * (FRAC_1_PI / (eta * eta)),
            specular_weight: share(mean(specular), mean(diffuse)),
            table,
            part: Part::Both,
        }
    }

    /// Transmittance towards `wo`, and the probability of sampling the coat.
    #[inline]
    fn choice(&self, wo: Vec3) -> (f32, f32) {
        let t = self.table.entering(wo.z);
        let p = match self.part {
            Part::Both => share(
                (1.0 - t).max(0.0) * self.specular_weight,
                t * (1.0 - self.specular_weight),
            ),
            Part::Coat => 1.0,
            Part::Base => 0.0,
        };
        (t, p)
    }

    /// Leaves one of its parts away, by a uniform `u`, as seen at this cosine. What is left is to
    /// be multiplied by the factor returned.
    #[inline]
    pub fn choose_part(&mut self, cos: f32, u: f32) -> f32 {
        let (_, p) = self.choice(Vec3::new(0.0, 0.0, cos));
        let p = p.clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE);
        if u < p {
            self.part = Part::Coat;
            return 1.0 / p;
        }
        self.part = Part::Base;
        1.0 / (1.0 - p)
    }

    /// What its radiance is in proportion to, whatever falls on it: the transmittance towards the
    /// eye. None with its coat.
    #[inline]
    pub fn view(&self) -> Option<&'static RoughTransmittance> {
        (self.part == Part::Base).then_some(self.table)
    }
}

impl Lobe for RoughPlastic {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z <= 0.0 || wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let (t, p) = self.choice(wo);
        let base = self.base * (wi.z * t * self.table.entering(wi.z));
        if self.part == Part::Base {
            return (base, cosine_pdf(wi.z));
        }
        let m = (wo + wi).normalize();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z);
        let coat = dielectric(wo.dot(m), self.eta).r * seen * self.facets.g1(wi, m);
        let coat = self.specular * coat;
        let value = if self.part == Part::Coat {
            coat
        } else {
            coat + base
        };
        (value, p * seen + (1.0 - p) * cosine_pdf(wi.z))
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z <= 0.0 {
            return None;
        }
        let (_, p) = self.choice(wo);
        sample_over_diffuse(self, wo, (u_lobe, u), transport, p, || {
            reflect(wo, self.facets.sample(wo, u)).normalize()
        })
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION
    }

    fn albedo(&self) -> Rgb {
        self.diffuse
    }

    fn roughness(&self) -> Option<f32> {
        match self.part {
            Part::Base => Some(1.0),
            Part::Both | Part::Coat => Some(self.facets.alpha()),
        }
    }
}
