//! Dielectric layers over other models: Mitsuba 0.6's `coating` and `roughcoating`.
//!
//! Light is refracted into the layer, scattered by the inner model, dimmed by absorption on both
//! ways, and refracted out. Bounces between the model and the layer's underside are left out, as
//! there.

use super::fresnel::{dielectric, reflect};
use super::lobes::{
    DELTA_REFLECTION, GLOSSY_REFLECTION, Lobe, mean, share, smooth_sample, weighted,
};
use super::microfacet::Microfacet;
use super::transmittance::RoughTransmittance;
use super::{BsdfSample, LobeFlags, Transport};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};

/// What both layers have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    eta: f32,
    /// Absorption times thickness.
    absorption: Rgb,
    specular: Rgb,
    /// Share of the layer's reflection, which steers sampling.
    specular_weight: f32,
}

impl Layer {
    pub fn new(eta: f32, absorption: Rgb, specular: Rgb) -> Self {
        let passing = mean((absorption * -2.0).exp());
        Self {
            eta,
            absorption,
            specular,
            specular_weight: share(mean(specular), passing),
        }
    }

    /// `w` continued inside the layer, on the same side.
    pub fn inside(&self, w: Vec3) -> Vec3 {
        refracted(w, 1.0 / self.eta)
    }

    fn outside(&self, w: Vec3) -> Vec3 {
        refracted(w, self.eta)
    }

    /// Fraction that absorption lets pass on the way along both inner directions.
    fn passing(&self, o: Vec3, i: Vec3) -> Rgb {
        if self.absorption == Rgb::ZERO {
            return Rgb::ONE;
        }
        (self.absorption * -(1.0 / o.z.abs() + 1.0 / i.z.abs())).exp()
    }

    /// Probability of sampling the layer when it reflects the fraction `r`.
    fn p_specular(&self, r: f32) -> f32 {
        share(
            r * self.specular_weight,
            (1.0 - r) * (1.0 - self.specular_weight),
        )
    }
}

/// Snell's law with the ratio of sines `ratio`; zero on total internal reflection.
fn refracted(w: Vec3, ratio: f32) -> Vec3 {
    let sin2 = ratio * ratio * (w.x * w.x + w.y * w.y);
    if sin2 >= 1.0 || w.z == 0.0 {
        return Vec3::ZERO;
    }
    Vec3::new(ratio * w.x, ratio * w.y, (1.0 - sin2).sqrt() * w.z.signum())
}

/// A random number below `p` or not, stretched to the unit interval again.
pub(super) fn split(u: f32, p: f32) -> (bool, f32) {
    if u < p {
        (true, u / p)
    } else {
        (false, ((u - p) / (1.0 - p)).min(BELOW_ONE))
    }
}

/// A smooth coating.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coating {
    pub layer: Layer,
}

impl Coating {
    /// What the layer adds to the inner model.
    pub const FLAGS: LobeFlags = DELTA_REFLECTION;

    pub fn eval_pdf(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Rgb, f32) {
        let layer = &self.layer;
        let (o, i) = (layer.inside(wo), layer.inside(wi));
        if o.z == 0.0 || i.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let r_o = dielectric(wo.z.abs(), layer.eta).r;
        let r_i = dielectric(wi.z.abs(), layer.eta).r;
        let (value, pdf) = inner.eval_pdf(o, i, transport);
        // Compression of the solid angle on the way in.
        let jacobian = (wi.z / i.z).abs() / (layer.eta * layer.eta);
        let through = (1.0 - r_o) * (1.0 - r_i) * jacobian;
        let value = value * layer.passing(o, i) * through;
        (value, pdf * (1.0 - layer.p_specular(r_o)) * jacobian)
    }

    pub fn sample(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        (u_lobe, u): (f32, Vec2),
        transport: Transport,
    ) -> Option<BsdfSample> {
        let layer = &self.layer;
        let r_o = dielectric(wo.z.abs(), layer.eta).r;
        let p = layer.p_specular(r_o);
        let (coat, u_lobe) = split(u_lobe, p);
        if coat {
            let wi = Vec3::new(-wo.x, -wo.y, wo.z);
            return weighted(wi, layer.specular * (r_o / p), p, 1.0, DELTA_REFLECTION);
        }
        let o = layer.inside(wo);
        if o.z == 0.0 {
            return None;
        }
        let s = inner.sample(o, u_lobe, u, transport)?;
        let wi = layer.outside(s.wi);
        if wi.z == 0.0 {
            return None;
        }
        let through = (1.0 - r_o) * (1.0 - dielectric(wi.z.abs(), layer.eta).r) / (1.0 - p);
        let weight = s.weight * layer.passing(o, s.wi) * through;
        let mut pdf = s.pdf * (1.0 - p);
        if !s.lobe.has(LobeFlags::DELTA) {
            pdf *= (wi.z / s.wi.z).abs() / (layer.eta * layer.eta);
        }
        weighted(wi, weight, pdf, s.eta, s.lobe)
    }
}

/// A rough coating.
#[derive(Clone, Copy, Debug)]
pub(super) struct RoughCoating {
    pub layer: Layer,
    pub facets: Microfacet,
    pub table: &'static RoughTransmittance,
}

impl RoughCoating {
    /// What the layer adds to the inner model.
    pub const FLAGS: LobeFlags = GLOSSY_REFLECTION;

    /// The layer's roughness.
    pub fn alpha(&self) -> f32 {
        self.facets.alpha()
    }

    /// Transmittance of the layer for both directions together, and absorption in it.
    fn through(&self, wo: Vec3, wi: Vec3, o: Vec3, i: Vec3) -> Rgb {
        let t = self.table.entering(wo.z.abs()) * self.table.entering(wi.z.abs());
        self.layer.passing(o, i) * t
    }

    fn p_specular(&self, wo: Vec3) -> f32 {
        let t = self.table.entering(wo.z.abs());
        self.layer.p_specular((1.0 - t).clamp(0.0, 1.0))
    }

    /// The layer's own reflection: value and density, on either side.
    fn eval_layer(&self, wo: Vec3, wi: Vec3) -> (Rgb, f32) {
        if wo.z * wi.z <= 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let m = (wo + wi).normalize() * wo.z.signum();
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / (4.0 * wo.z.abs());
        let r = dielectric(wo.dot(m).abs(), self.layer.eta).r;
        let value = self.layer.specular * (r * seen * self.facets.g1(wi, m));
        (value, seen)
    }

    pub fn eval_pdf(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        wi: Vec3,
        transport: Transport,
    ) -> (Rgb, f32) {
        if wo.z == 0.0 || wi.z == 0.0 {
            return (Rgb::ZERO, 0.0);
        }
        let p = self.p_specular(wo);
        let (coat, coat_pdf) = self.eval_layer(wo, wi);
        let (mut value, mut pdf) = (coat, coat_pdf * p);
        let (o, i) = (self.layer.inside(wo), self.layer.inside(wi));
        if o.z != 0.0 && i.z != 0.0 {
            let (below, below_pdf) = inner.eval_pdf(o, i, transport);
            let jacobian = (wi.z / i.z).abs() / (self.layer.eta * self.layer.eta);
            value += below * self.through(wo, wi, o, i) * jacobian;
            pdf += below_pdf * jacobian * (1.0 - p);
        }
        (value, pdf)
    }

    pub fn sample(
        &self,
        inner: &impl Lobe,
        wo: Vec3,
        (u_lobe, u): (f32, Vec2),
        transport: Transport,
    ) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let p = self.p_specular(wo);
        let (coat, u_lobe) = split(u_lobe, p);
        let (wi, lobe, eta) = if coat {
            let m = self.facets.sample(wo * wo.z.signum(), u);
            let wi = reflect(wo, m).normalize();
            if wi.z * wo.z <= 0.0 {
                return None;
            }
            (wi, GLOSSY_REFLECTION, 1.0)
        } else {
            let o = self.layer.inside(wo);
            let s = inner.sample(o, u_lobe, u, transport)?;
            let wi = self.layer.outside(s.wi);
            if wi.z == 0.0 || o.z == 0.0 {
                return None;
            }
            if s.lobe.has(LobeFlags::DELTA) {
                let weight = s.weight * self.through(wo, wi, o, s.wi) / (1.0 - p);
                return weighted(wi, weight, s.pdf * (1.0 - p), s.eta, s.lobe);
            }
            (wi, s.lobe, s.eta)
        };
        let (value, pdf) = self.eval_pdf(inner, wo, wi, transport);
        smooth_sample(wi, value, pdf, eta, lobe)
    }
}
