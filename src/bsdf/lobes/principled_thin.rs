//! Mitsuba 3's `principledthin`: the principled model for sheets without thickness (Burley 2015).
//! Both sides look alike, and what is transmitted is not bent but blurred.

use super::principled_parts::{Base, facets, schlick, schlick_r0, tint};
use super::{
    GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, cosine_pdf, sample_cosine, smooth_sample,
};
use crate::bsdf::fresnel::{dielectric, reflect, sane_eta};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Parameters of Mitsuba 3's `principledthin`.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct PrincipledThin {
    pub base_color: Texture,
    pub roughness: Texture,
    pub anisotropic: Texture,
    pub spec_trans: Texture,
    pub eta: Texture,
    pub spec_tint: Texture,
    pub sheen: Texture,
    pub sheen_tint: Texture,
    pub flatness: Texture,
    /// Diffuse transmission, 0 to 2.
    pub diff_trans: Texture,
}

impl Model for PrincipledThin {
    type Lobe = PrincipledThinLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        p.ignore(&[
            "specular_reflectance_sampling_rate",
            "specular_transmittance_sampling_rate",
            "diffuse_reflectance_sampling_rate",
            "diffuse_transmittance_sampling_rate",
        ]);
        Ok(Self {
            eta: p.number("eta", 1.5),
            diff_trans: p.number("diff_trans", 0.0),
            base_color: p.reflectance("base_color", 0.5),
            roughness: p.reflectance("roughness", 0.5),
            anisotropic: p.reflectance("anisotropic", 0.0),
            spec_trans: p.reflectance("spec_trans", 0.0),
            spec_tint: p.reflectance("spec_tint", 0.0),
            sheen: p.reflectance("sheen", 0.0),
            sheen_tint: p.reflectance("sheen_tint", 0.0),
            flatness: p.reflectance("flatness", 0.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> PrincipledThinLobe {
        let base_color = at.color(&self.base_color);
        let (roughness, anisotropic) = (at.scalar(&self.roughness), at.scalar(&self.anisotropic));
        let eta = sane_eta(at.scalar(&self.eta));
        let sheen_color = Rgb::ONE.lerp(tint(base_color), at.scalar(&self.sheen_tint));
        let scaled = (0.65 * eta - 0.35) * roughness;
        PrincipledThinLobe {
            base: Base {
                color: base_color,
                roughness,
                flatness: at.scalar(&self.flatness),
                sheen: sheen_color * at.scalar(&self.sheen),
            },
            reflecting: facets(roughness, anisotropic),
            transmitting: facets(scaled, anisotropic),
            eta,
            spec_tint: at.scalar(&self.spec_tint),
            spec_trans: at.scalar(&self.spec_trans).clamp(0.0, 1.0),
            diff_trans: (0.5 * at.scalar(&self.diff_trans)).clamp(0.0, 1.0),
        }
    }

    fn textures(&self) -> Textures<'_> {
        // Tints and sheens multiply, roughnesses bend.
        Textures {
            linear: vec![],
            nonlinear: vec![
                &self.base_color,
                &self.roughness,
                &self.anisotropic,
                &self.spec_trans,
                &self.eta,
                &self.spec_tint,
                &self.sheen,
                &self.sheen_tint,
                &self.flatness,
                &self.diff_trans,
            ],
        }
    }

    fn is_anisotropic(&self) -> bool {
        self.anisotropic.constant() != Some(Rgb::ZERO)
    }

    fn transmits(&self) -> bool {
        true
    }

    fn casts_caustics(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{base, grey};
        let example = Self {
            base_color: base(),
            roughness: grey(0.5),
            anisotropic: grey(0.4),
            spec_trans: grey(0.6),
            eta: grey(1.4),
            spec_tint: grey(0.3),
            sheen: grey(0.5),
            sheen_tint: grey(0.5),
            flatness: grey(0.4),
            diff_trans: grey(0.7),
        };
        vec![("principled_thin", example)]
    }
}

/// The thin principled model.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PrincipledThinLobe {
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

impl PrincipledThinLobe {
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

impl Lobe for PrincipledThinLobe {
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
