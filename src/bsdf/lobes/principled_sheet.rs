//! Mitsuba 3's `principledthin`: the principled model for sheets without thickness (Burley 2015).
//! Both sides look alike, and what is transmitted is not bent but blurred.

use super::principled::{Base, facets, schlick, schlick_r0, tint};
use super::{
    GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, cosine_pdf, sample_cosine, smooth_sample,
};
use crate::bsdf::fresnel::{dielectric, reflect};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// What the scene says at a point.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct SheetInput {
    pub base_color: Rgb,
    pub roughness: f32,
    pub anisotropic: f32,
    pub spec_trans: f32,
    pub eta: f32,
    pub spec_tint: f32,
    pub sheen: f32,
    pub sheen_tint: f32,
    pub flatness: f32,
    /// 0 to 2.
    pub diff_trans: f32,
}

/// The thin principled model.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PrincipledSheet {
    base: Base,
    reflecting: Microfacet,
    /// Facets of the transmitting lobe, whose roughness follows the index (Burley 2015, figure 15).
    transmitting: Microfacet,
    eta: f32,
    spec_tint: f32,
    spec_trans: f32,
    /// Share of transmission in the diffuse part, 0 to 1.
    diff_trans: f32,
}

impl PrincipledSheet {
    pub fn new(p: &SheetInput) -> Self {
        let sheen = Rgb::ONE.lerp(tint(p.base_color), p.sheen_tint) * p.sheen;
        let scaled = (0.65 * p.eta - 0.35) * p.roughness;
        Self {
            base: Base {
                color: p.base_color,
                roughness: p.roughness,
                flatness: p.flatness,
                sheen,
            },
            reflecting: facets(p.roughness, p.anisotropic),
            transmitting: facets(scaled, p.anisotropic),
            eta: p.eta,
            spec_tint: p.spec_tint,
            spec_trans: p.spec_trans.clamp(0.0, 1.0),
            diff_trans: (0.5 * p.diff_trans).clamp(0.0, 1.0),
        }
    }

    /// Probabilities of specular reflection and transmission (alike), and of diffuse reflection;
    /// the rest is diffuse transmission. They sum to 1 because all of Mitsuba's sampling rates are
    /// 1.
    fn odds(&self) -> (f32, f32) {
        let diffuse = 1.0 - self.spec_trans;
        (0.5 * self.spec_trans, diffuse * (1.0 - self.diff_trans))
    }

    fn eval_reflection(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let (p_specular, p_diffuse) = self.odds();
        let m = (wo + wi).normalize();
        let mut value = Rgb::ZERO;
        let mut pdf = p_diffuse * cosine_pdf(wi.z);
        if self.spec_trans > 0.0 {
            let o = wo.dot(m);
            let seen = self.reflecting.d(m) * self.reflecting.g1(wo, m) / (4.0 * wo.z);
            let exact = Rgb::splat(dielectric(o, self.eta).r);
            let tinted = schlick(tint(self.base.color) * schlick_r0(self.eta), o, self.eta);
            let fresnel = exact.lerp(tinted, self.spec_tint);
            value += fresnel * (self.spec_trans * seen * self.reflecting.g1(wi, m));
            pdf += p_specular * seen;
        }
        if p_diffuse > 0.0 {
            let (diffuse, sheen) = self.base.eval(wo.z, wi.z, m.dot(wi));
            value += (diffuse + sheen) * p_diffuse;
        }
        (value, pdf)
    }

    /// `wi.z` < 0: a reflection turned to the other side.
    fn eval_transmission(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let (p_specular, p_diffuse) = self.odds();
        let p_through = (1.0 - self.spec_trans - p_diffuse).max(0.0);
        let mut pdf = p_through * cosine_pdf(-wi.z);
        let mut value = self.base.color * pdf;
        let m = (wo + Vec3::new(wi.x, wi.y, -wi.z)).normalize();
        // Mitsuba asks that the facet's normal and the transmitted ray disagree in side.
        if self.spec_trans > 0.0 && wi.dot(m) < 0.0 {
            let facets = &self.transmitting;
            let seen = facets.d(m) * facets.g1(wo, m) / (4.0 * wo.z);
            let through = 1.0 - dielectric(wo.dot(m), self.eta).r;
            value += self.base.color * (self.spec_trans * through * seen * facets.g1(wi, m));
            pdf += p_specular * seen;
        }
        (value, pdf)
    }
}

impl Lobe for PrincipledSheet {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, _: Transport) -> (Rgb, f32) {
        if wo.z == 0.0 || wi.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let side = wo.z.signum();
        let (wo, wi) = (wo * side, wi * side);
        if wi.z > 0.0 {
            self.eval_reflection(wo, wi)
        } else {
            self.eval_transmission(wo, wi)
        }
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let side = wo.z.signum();
        let up = wo * side;
        let (p_specular, p_diffuse) = self.odds();
        let mut wi = if u_lobe < p_specular {
            reflect(up, self.reflecting.sample(up, u)).normalize()
        } else if u_lobe < 2.0 * p_specular {
            let m = self.transmitting.sample(up, u);
            let w = reflect(up, m).normalize();
            let turned = Vec3::new(w.x, w.y, -w.z);
            if turned.dot(m) >= 0.0 {
                return None;
            }
            turned
        } else {
            sample_cosine(u)
        };
        let specular = u_lobe < 2.0 * p_specular;
        let through = if specular {
            u_lobe >= p_specular
        } else {
            u_lobe >= 2.0 * p_specular + p_diffuse
        };
        if !specular && through {
            wi.z = -wi.z;
        }
        if through == (wi.z >= 0.0) {
            return None;
        }
        let lobe = if through {
            GLOSSY_TRANSMISSION
        } else {
            GLOSSY_REFLECTION
        };
        let wi = wi * side;
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        smooth_sample(wi, value, pdf, 1.0, lobe)
    }

    fn flags(&self) -> LobeFlags {
        if self.spec_trans > 0.0 || self.diff_trans > 0.0 {
            GLOSSY_REFLECTION | GLOSSY_TRANSMISSION
        } else {
            GLOSSY_REFLECTION
        }
    }

    fn albedo(&self) -> Rgb {
        self.base.color
    }

    fn roughness(&self) -> Option<f32> {
        if self.spec_trans == 0.0 {
            return Some(1.0);
        }
        Some(self.reflecting.alpha().min(self.transmitting.alpha()))
    }
}
