//! Mitsuba 3's `principled` (after Burley, "Physically Based Shading at Disney", 2012, and
//! "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", 2015): a rough
//! dielectric or metallic lobe, a diffuse lobe with retro-reflection and sheen, and a clear coat.

use super::principled_parts::{Base, facets, schlick, schlick_r0, tint};
use super::{
    GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, cosine_pdf, sample_cosine, smooth_sample,
};
use crate::bsdf::fresnel::{Interface, dielectric, reflect, refract, sane_eta};
use crate::bsdf::microfacet::{Distribution, Microfacet};
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::Parameters;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;
use std::f32::consts::{PI, TAU};

/// Parameters of Mitsuba 3's `principled`; each in `[0, 1]` unless said otherwise.
#[derive(Clone, Debug)]
#[allow(missing_docs)]
pub struct Principled {
    pub base_color: Texture,
    pub roughness: Texture,
    pub anisotropic: Texture,
    pub metallic: Texture,
    pub spec_trans: Texture,
    /// Interior index of refraction (`eta`; from `specular` where the scene gives that).
    pub eta: f32,
    pub spec_tint: Texture,
    pub sheen: Texture,
    pub sheen_tint: Texture,
    pub flatness: Texture,
    pub clearcoat: Texture,
    pub clearcoat_gloss: Texture,
    /// Relative sampling rates, as in Mitsuba 3.
    pub main_specular_sampling_rate: f32,
    pub clearcoat_sampling_rate: f32,
    pub diffuse_reflectance_sampling_rate: f32,
}

impl Model for Principled {
    type Lobe = PrincipledLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.principled_ior()?,
            base_color: p.reflectance("base_color", 0.5),
            roughness: p.reflectance("roughness", 0.5),
            anisotropic: p.reflectance("anisotropic", 0.0),
            metallic: p.reflectance("metallic", 0.0),
            spec_trans: p.reflectance("spec_trans", 0.0),
            spec_tint: p.reflectance("spec_tint", 0.0),
            sheen: p.reflectance("sheen", 0.0),
            sheen_tint: p.reflectance("sheen_tint", 0.0),
            flatness: p.reflectance("flatness", 0.0),
            clearcoat: p.reflectance("clearcoat", 0.0),
            clearcoat_gloss: p.reflectance("clearcoat_gloss", 0.0),
            main_specular_sampling_rate: p.float("main_specular_sampling_rate", 1.0),
            clearcoat_sampling_rate: p.float("clearcoat_sampling_rate", 1.0),
            diffuse_reflectance_sampling_rate: p.float("diffuse_reflectance_sampling_rate", 1.0),
        })
    }

    fn lobe(&self, at: &Lookup) -> PrincipledLobe {
        let base_color = at.color(&self.base_color);
        let roughness = at.scalar(&self.roughness);
        let (metallic, spec_trans) = (at.scalar(&self.metallic), at.scalar(&self.spec_trans));
        let clearcoat = at.scalar(&self.clearcoat);
        let eta = sane_eta(self.eta);
        let brdf = (1.0 - metallic) * (1.0 - spec_trans);
        let main = self.main_specular_sampling_rate;
        let coat = 0.25 * clearcoat * self.clearcoat_sampling_rate;
        let diffuse = brdf * self.diffuse_reflectance_sampling_rate;
        let sum = main + coat + diffuse;
        let inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let sheen_color = Rgb::ONE.lerp(tint(base_color), at.scalar(&self.sheen_tint));
        let sheen = if brdf > 0.0 {
            at.scalar(&self.sheen)
        } else {
            0.0
        };
        PrincipledLobe {
            base: Base {
                color: base_color,
                roughness,
                flatness: at.scalar(&self.flatness),
                sheen: sheen_color * (sheen * (1.0 - metallic)),
            },
            facets: facets(roughness, at.scalar(&self.anisotropic)),
            eta: if eta == 1.0 { 1.001 } else { eta },
            metallic,
            spec_tint: at.scalar(&self.spec_tint),
            clearcoat,
            coat_alpha: 0.1 + (0.001 - 0.1) * at.scalar(&self.clearcoat_gloss),
            brdf,
            bsdf: (1.0 - metallic) * spec_trans,
            p_diffuse: diffuse * inverse,
            p_coat: coat * inverse,
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
                &self.metallic,
                &self.spec_trans,
                &self.spec_tint,
                &self.sheen,
                &self.sheen_tint,
                &self.flatness,
                &self.clearcoat,
                &self.clearcoat_gloss,
            ],
        }
    }

    fn is_anisotropic(&self) -> bool {
        self.anisotropic.constant() != Some(Rgb::ZERO)
    }

    fn refracts(&self) -> bool {
        self.spec_trans.constant() != Some(Rgb::ZERO)
    }

    fn casts_caustics(&self) -> bool {
        self.refracts() || self.metallic.constant() != Some(Rgb::ZERO)
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::tests::models::{grey, principled};
        vec![
            (
                "principled_metal",
                Self {
                    anisotropic: grey(0.6),
                    metallic: grey(0.7),
                    spec_tint: grey(0.4),
                    clearcoat: grey(0.6),
                    clearcoat_gloss: grey(0.3),
                    ..principled(0.4, 1.5)
                },
            ),
            (
                "principled_cloth",
                Self {
                    sheen: grey(0.8),
                    sheen_tint: grey(0.5),
                    flatness: grey(0.6),
                    ..principled(0.7, 1.4)
                },
            ),
            (
                "principled_glass",
                Self {
                    spec_trans: grey(0.8),
                    metallic: grey(0.1),
                    spec_tint: grey(0.3),
                    ..principled(0.5, 1.5)
                },
            ),
        ]
    }
}

/// The principled model.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PrincipledLobe {
    base: Base,
    facets: Microfacet,
    eta: f32,
    metallic: f32,
    spec_tint: f32,
    clearcoat: f32,
    /// Roughness of the clear coat.
    coat_alpha: f32,
    /// Weight of the diffuse lobe.
    brdf: f32,
    /// Weight of the transmitting lobe.
    bsdf: f32,
    /// Probabilities of the diffuse lobe and the clear coat, seen from the front.
    p_diffuse: f32,
    p_coat: f32,
}

/// Probabilities of the four lobes.
struct Odds {
    diffuse: f32,
    coat: f32,
    transmit: f32,
    reflect: f32,
}

impl PrincipledLobe {
    /// Probabilities of the lobes for Fresnel reflectance `r` at the facet; from the back only the
    /// interface is sampled.
    fn odds(&self, front: bool, r: f32) -> Odds {
        if !front {
            return Odds {
                diffuse: 0.0,
                coat: 0.0,
                transmit: 1.0 - r,
                reflect: r,
            };
        }
        let main = (1.0 - self.p_diffuse - self.p_coat).max(0.0);
        let transmit = main * self.bsdf * (1.0 - r);
        Odds {
            diffuse: self.p_diffuse,
            coat: self.p_coat,
            transmit,
            reflect: main - transmit,
        }
    }

    /// Fresnel term of the main lobe: metallic and tinted parts by Schlick, the rest exact.
    fn fresnel(&self, i: &Interface, cos: f32, front: bool) -> Rgb {
        if !front {
            return Rgb::splat(self.bsdf * i.r);
        }
        let dielectric = 1.0 - self.metallic;
        let mut f = Rgb::splat(dielectric * (1.0 - self.spec_tint) * i.r);
        if self.metallic > 0.0 {
            f += schlick(self.base.color, cos, self.eta) * self.metallic;
        }
        if self.spec_tint > 0.0 {
            let r0 = tint(self.base.color) * schlick_r0(i.eta_it);
            f += schlick(r0, cos, self.eta) * (dielectric * self.spec_tint);
        }
        f
    }

    /// Clear coat: GTR1 facets with GGX masking of roughness 0.25; value over |cos wi| times 4, and
    /// the density of the half vector.
    fn coat(&self, wo: Vec3, wi: Vec3, m: Vec3) -> (f32, f32) {
        let a2 = self.coat_alpha * self.coat_alpha;
        let d = (a2 - 1.0) / (PI * a2.ln() * (1.0 + (a2 - 1.0) * m.z * m.z));
        let d = if d * m.z > 1e-20 { d } else { 0.0 };
        let masking = Microfacet::new(Distribution::Ggx, 0.25, 0.25);
        let f = schlick(Rgb::splat(0.04), wo.dot(m), self.eta).x;
        let g = masking.g1(wo, m) * masking.g1(wi, m);
        (self.clearcoat * 0.25 * f * d * g, d * m.z)
    }

    fn sample_coat_normal(&self, u: Vec2) -> Vec3 {
        let a2 = self.coat_alpha * self.coat_alpha;
        let cos2 = ((1.0 - a2.powf(1.0 - u.y)) / (1.0 - a2)).clamp(0.0, 1.0);
        let sin = (1.0 - cos2).sqrt();
        let (sin_phi, cos_phi) = (TAU * u.x).sin_cos();
        Vec3::new(cos_phi * sin, sin_phi * sin, cos2.sqrt())
    }

    fn eval_reflection(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        let front = wo.z > 0.0;
        let half = (wo + wi).normalize_or_zero();
        let m = half * 1f32.copysign(half.z);
        let i = dielectric(wo.dot(m), self.eta);
        let odds = self.odds(front, i.r);
        let (mut value, mut pdf) = (Rgb::ZERO, 0.0);
        if wo.dot(m) * wo.z > 0.0 && wi.dot(m) * wi.z > 0.0 {
            let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z.abs());
            if i.r > 0.0 {
                let fresnel = self.fresnel(&i, wo.dot(m), front);
                value += fresnel * (seen * self.facets.g1(wi, m));
            }
            pdf += odds.reflect * seen;
            if front && self.clearcoat > 0.0 {
                let (coat, coat_pdf) = self.coat(wo, wi, m);
                value += Rgb::splat(coat * wi.z);
                pdf += odds.coat * coat_pdf / (4.0 * wi.dot(m));
            }
        }
        if front {
            let (diffuse, sheen) = self.base.eval(wo.z, wi.z, m.dot(wi));
            value += diffuse * self.brdf + sheen;
            pdf += odds.diffuse * cosine_pdf(wi.z);
        }
        (value, pdf)
    }

    fn eval_transmission(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let front = wo.z > 0.0;
        let eta = if front { self.eta } else { 1.0 / self.eta };
        let half = (wo + wi * eta).normalize_or_zero();
        let m = half * 1f32.copysign(half.z);
        let (o, i) = (wo.dot(m), wi.dot(m));
        if o * wo.z <= 0.0 || i * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let r = dielectric(o, self.eta).r;
        let q = o + eta * i;
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / wo.z.abs();
        let density = seen * (eta * eta * o * i / (q * q)).abs();
        if !density.is_finite() {
            return (Rgb::ZERO, 0.0);
        }
        let scale = match transport {
            Transport::Radiance => 1.0 / (eta * eta),
            Transport::Importance => 1.0,
        };
        let color = self.base.color.max(Rgb::ZERO).powf(0.5) * self.bsdf;
        let value = color * (scale * (1.0 - r) * density * self.facets.g1(wi, m));
        (value, self.odds(front, r).transmit * density)
    }
}

impl Lobe for PrincipledLobe {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let side = wo.z * wi.z;
        if side > 0.0 && (wo.z > 0.0 || self.bsdf > 0.0) {
            return self.eval_reflection(wo, wi);
        }
        if side < 0.0 && self.bsdf > 0.0 {
            return self.eval_transmission(wo, wi, transport);
        }
        (Rgb::ZERO, 0.0)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        let front = wo.z > 0.0;
        if wo.z == 0.0 || (!front && self.bsdf == 0.0) {
            return None;
        }
        let m = self.facets.sample(wo * wo.z.signum(), u);
        let i = dielectric(wo.dot(m), self.eta);
        let odds = self.odds(front, i.r);
        let coat_end = odds.diffuse + odds.coat;
        let mut lobe = GLOSSY_REFLECTION;
        let mut eta = 1.0;
        let wi = if u_lobe < odds.diffuse {
            sample_cosine(u)
        } else if u_lobe < coat_end {
            reflect(wo, self.sample_coat_normal(u)).normalize()
        } else if u_lobe < coat_end + odds.transmit {
            lobe = GLOSSY_TRANSMISSION;
            eta = i.eta_it;
            refract(wo, m, &i).normalize()
        } else {
            reflect(wo, m).normalize()
        };
        if (wi.z * wo.z > 0.0) != (lobe == GLOSSY_REFLECTION) {
            return None;
        }
        let (value, pdf) = self.eval_pdf(wo, wi, transport);
        smooth_sample(wi, value, pdf, eta, lobe)
    }

    fn flags(&self) -> LobeFlags {
        if self.bsdf > 0.0 {
            GLOSSY_REFLECTION | GLOSSY_TRANSMISSION
        } else {
            GLOSSY_REFLECTION
        }
    }

    fn albedo(&self) -> Rgb {
        self.base.color
    }

    fn roughness(&self) -> Option<f32> {
        let main = self.facets.alpha();
        Some(if self.clearcoat > 0.0 {
            main.min(self.coat_alpha)
        } else {
            main
        })
    }
}
