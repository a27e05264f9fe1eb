//! Mitsuba 3's `principled` (after Burley, "Physically Based Shading at Disney", 2012, and
//! "Extending the Disney BRDF to a BSDF with Integrated Subsurface Scattering", 2015): a rough
//! dielectric or metallic lobe, a diffuse lobe with retro-reflection and sheen, and a clear coat.

use super::{
    GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, cosine_pdf, sample_cosine, smooth_sample,
};
use crate::bsdf::fresnel::{Interface, contrast, dielectric, reflect, refract};
use crate::bsdf::material::Distribution;
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3, luminance};
use std::f32::consts::{FRAC_1_PI, PI, TAU};

/// The main lobe's facets, from Burley's roughness and anisotropy.
pub(super) fn facets(roughness: f32, anisotropic: f32) -> Microfacet {
    let r2 = roughness * roughness;
    let aspect = (1.0 - 0.9 * anisotropic.clamp(0.0, 1.0)).sqrt();
    Microfacet::new(
        Distribution::Ggx,
        (r2 / aspect).max(1e-3),
        (r2 * aspect).max(1e-3),
    )
}

/// Schlick's fifth power.
#[inline]
pub(super) fn schlick_weight(cos: f32) -> f32 {
    let m = (1.0 - cos).clamp(0.0, 1.0);
    let m2 = m * m;
    m2 * m2 * m
}

/// Schlick's approximation from the reflectance `r0` at normal incidence; on the dense side of the
/// interface it uses the angle of the transmitted ray.
pub(super) fn schlick(r0: Rgb, cos: f32, eta: f32) -> Rgb {
    let (eta_it, eta_ti) = if cos >= 0.0 {
        (eta, 1.0 / eta)
    } else {
        (1.0 / eta, eta)
    };
    let weight = if eta_it > 1.0 {
        schlick_weight(cos.abs())
    } else {
        let cos_t2 = 1.0 - (1.0 - cos * cos) * eta_ti * eta_ti;
        schlick_weight(cos_t2.max(0.0).sqrt())
    };
    r0.lerp(Rgb::ONE, weight)
}

/// Reflectance at normal incidence.
pub(super) fn schlick_r0(eta: f32) -> f32 {
    let r = contrast(eta);
    r * r
}

/// The colour without its luminance.
pub(super) fn tint(color: Rgb) -> Rgb {
    let l = luminance(color);
    if l > 0.0 { color / l } else { Rgb::ONE }
}

/// The diffuse part that both principled models share: diffuse with retro-reflection blended into a
/// fake subsurface lobe, and sheen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Base {
    pub color: Rgb,
    pub roughness: f32,
    pub flatness: f32,
    /// Sheen's colour and strength.
    pub sheen: Rgb,
}

impl Base {
    /// (diffuse f cos, sheen f cos) for cosines of both directions and of `wi` to the half vector.
    pub fn eval(&self, cos_o: f32, cos_i: f32, cos_d: f32) -> (Rgb, Rgb) {
        let (fo, fi) = (schlick_weight(cos_o), schlick_weight(cos_i));
        let diffuse = (1.0 - 0.5 * fo) * (1.0 - 0.5 * fi);
        let rr = 2.0 * self.roughness * cos_d * cos_d;
        let retro = rr * (fo + fi + fo * fi * (rr - 1.0));
        let half = 0.5 * rr;
        let ss = (1.0 + (half - 1.0) * fo) * (1.0 + (half - 1.0) * fi);
        let flat = 1.25 * (ss * (1.0 / (cos_o + cos_i) - 0.5) + 0.5);
        let shape = diffuse + retro + (flat - diffuse - retro) * self.flatness;
        let sheen = self.sheen * (schlick_weight(cos_d.abs()) * cos_i);
        (self.color * (shape * FRAC_1_PI * cos_i), sheen)
    }
}

/// What the scene says at a point.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct PrincipledInput {
    pub base_color: Rgb,
    pub roughness: f32,
    pub anisotropic: f32,
    pub metallic: f32,
    pub spec_trans: f32,
    pub eta: f32,
    pub spec_tint: f32,
    pub sheen: f32,
    pub sheen_tint: f32,
    pub flatness: f32,
    pub clearcoat: f32,
    pub clearcoat_gloss: f32,
    /// Sampling rates: main specular, clear coat, diffuse.
    pub rates: [f32; 3],
}

/// The principled model.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Principled {
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

impl Principled {
    pub fn new(p: &PrincipledInput) -> Self {
        let brdf = (1.0 - p.metallic) * (1.0 - p.spec_trans);
        let [main, coat, diffuse] = p.rates;
        let (coat, diffuse) = (0.25 * p.clearcoat * coat, brdf * diffuse);
        let sum = main + coat + diffuse;
        let inverse = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let sheen_color = Rgb::ONE.lerp(tint(p.base_color), p.sheen_tint);
        let sheen = if brdf > 0.0 { p.sheen } else { 0.0 };
        Self {
            base: Base {
                color: p.base_color,
                roughness: p.roughness,
                flatness: p.flatness,
                sheen: sheen_color * (sheen * (1.0 - p.metallic)),
            },
            facets: facets(p.roughness, p.anisotropic),
            eta: if p.eta == 1.0 { 1.001 } else { p.eta },
            metallic: p.metallic,
            spec_tint: p.spec_tint,
            clearcoat: p.clearcoat,
            coat_alpha: 0.1 + (0.001 - 0.1) * p.clearcoat_gloss,
            brdf,
            bsdf: (1.0 - p.metallic) * p.spec_trans,
            p_diffuse: diffuse * inverse,
            p_coat: coat * inverse,
        }
    }

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

impl Lobe for Principled {
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
