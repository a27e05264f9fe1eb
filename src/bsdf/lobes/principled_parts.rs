//! What both principled models consist of (Burley, "Physically Based Shading at Disney", 2012).

use crate::bsdf::fresnel::contrast;
use crate::bsdf::microfacet::{Distribution, Microfacet};
use crate::math::{Rgb, luminance};
use std::f32::consts::FRAC_1_PI;

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
pub(in crate::bsdf) fn schlick_weight(cos: f32) -> f32 {
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
