//! A rough interface between two dielectrics (Walter et al., "Microfacet Models for Refraction
//! through Rough Surfaces", 2007), sampled by visible normals.

use super::dielectric::DielectricLobe;
use super::{GLOSSY_REFLECTION, GLOSSY_TRANSMISSION, Lobe, either_lobe, weighted};
use crate::bsdf::fresnel::{dielectric, reflect, refract, sane_eta};
use crate::bsdf::microfacet::Microfacet;
use crate::bsdf::model::{Lookup, Model, Textures};
use crate::bsdf::parameters::{Parameters, Roughness};
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::Texture;

/// Rough dielectric interface (Walter et al. 2007).
#[derive(Clone, Debug)]
pub struct RoughDielectric {
    /// Interior over exterior index of refraction.
    pub eta: f32,
    /// Microfacets.
    pub roughness: Roughness,
    /// Factor on reflection.
    pub specular_reflectance: Texture,
    /// Factor on transmission.
    pub specular_transmittance: Texture,
}

/// Below this distance of eta from 1 the half vector of refraction, `wo + eta wi`, is lost in
/// rounding while the refracted light deviates by less than a thousandth of the roughness: such an
/// interface is resolved to a smooth one. Guarded by the test of extreme indices.
const MIN_CONTRAST: f32 = 1e-3;

impl Model for RoughDielectric {
    type Lobe = RoughDielectricLobe;

    fn read(p: &mut dyn Parameters) -> Result<Self, String> {
        Ok(Self {
            eta: p.relative_ior("bk7"),
            specular_reflectance: p.reflectance("specular_reflectance", 1.0),
            specular_transmittance: p.reflectance("specular_transmittance", 1.0),
            roughness: p.roughness(),
        })
    }

    fn lobe(&self, at: &Lookup) -> RoughDielectricLobe {
        let eta = sane_eta(self.eta);
        let reflectance = at.color(&self.specular_reflectance);
        let transmittance = at.color(&self.specular_transmittance);
        if (eta - 1.0).abs() < MIN_CONTRAST {
            return RoughDielectricLobe::Smooth(DielectricLobe {
                eta,
                reflectance,
                transmittance,
            });
        }
        RoughDielectricLobe::Rough(Interface {
            eta,
            facets: at.facets(&self.roughness),
            reflectance,
            transmittance,
        })
    }

    fn textures(&self) -> Textures<'_> {
        Textures {
            linear: vec![&self.specular_reflectance, &self.specular_transmittance],
            nonlinear: vec![&self.roughness.alpha_u, &self.roughness.alpha_v],
        }
    }

    fn is_anisotropic(&self) -> bool {
        self.roughness.is_anisotropic()
    }

    fn refracts(&self) -> bool {
        true
    }

    #[cfg(test)]
    fn examples() -> Vec<(&'static str, Self)> {
        use crate::bsdf::microfacet::Distribution::Ggx;
        use crate::bsdf::tests::models::{beckmann, facets, glass};
        vec![
            ("rough_dielectric_beckmann", glass(1.5, beckmann(0.25))),
            ("rough_dielectric_ggx", glass(1.33, facets(Ggx, 0.3, 0.6))),
        ]
    }
}

either_lobe! {
    /// A rough interface, or the smooth one that it is where the indices hardly differ.
    pub(in crate::bsdf) enum RoughDielectricLobe {
        Rough(Interface),
        Smooth(DielectricLobe),
    }
}

/// A rough dielectric interface.
#[derive(Clone, Copy, Debug)]
pub(in crate::bsdf) struct Interface {
    /// Interior over exterior index of refraction, at least [`MIN_CONTRAST`] away from 1.
    eta: f32,
    facets: Microfacet,
    reflectance: Rgb,
    transmittance: Rgb,
}

impl Interface {
    /// Indices of the far side over the near side of `wo`, and the inverse.
    #[inline]
    fn relative(&self, wo: Vec3) -> (f32, f32) {
        if wo.z > 0.0 {
            (self.eta, 1.0 / self.eta)
        } else {
            (1.0 / self.eta, self.eta)
        }
    }
}

/// Factor on transmission: radiance is compressed with the solid angle, power is not.
#[inline]
fn compression(inv_eta: f32, transport: Transport) -> f32 {
    match transport {
        Transport::Radiance => inv_eta * inv_eta,
        Transport::Importance => 1.0,
    }
}

impl Lobe for Interface {
    fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        const NOTHING: (Rgb, f32) = (Rgb::ZERO, 0.0);
        if wo.z == 0.0 || wi.z == 0.0 {
            return NOTHING;
        }
        let reflected = wo.z * wi.z > 0.0;
        let (eta, inv_eta) = self.relative(wo);
        let half = (wo + wi * if reflected { 1.0 } else { eta }).normalize_or_zero();
        let m = half * 1f32.copysign(half.z);
        let (o, i) = (wo.dot(m), wi.dot(m));
        if o * wo.z <= 0.0 || i * wi.z <= 0.0 {
            return NOTHING;
        }
        let d = self.facets.d(m);
        let seen = d * self.facets.g1(wo, m) / wo.z.abs();
        if seen <= 0.0 {
            return NOTHING;
        }
        let r = dielectric(o, self.eta).r;
        let masking = self.facets.g1(wi, m);
        if reflected {
            let pdf = r * seen * 0.25;
            return (self.reflectance * (pdf * masking), pdf);
        }
        // Jacobian of the half vector of refraction (Walter et al., equation 17).
        let q = o + eta * i;
        let pdf = (1.0 - r) * seen * (eta * eta * i * o / (q * q)).abs();
        if !pdf.is_finite() {
            return NOTHING;
        }
        let value = self.transmittance * (pdf * masking * compression(inv_eta, transport));
        (value, pdf)
    }

    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample> {
        if wo.z == 0.0 {
            return None;
        }
        let up = wo * wo.z.signum();
        let m = self.facets.sample(up, u);
        let o = wo.dot(m);
        let i = dielectric(o, self.eta);
        let seen = self.facets.d(m) * self.facets.g1(wo, m) / up.z;
        if u_lobe < i.r {
            let wi = reflect(wo, m).normalize();
            if wi.z * wo.z <= 0.0 {
                return None;
            }
            let weight = self.reflectance * self.facets.g1(wi, m);
            return weighted(wi, weight, i.r * seen * 0.25, 1.0, GLOSSY_REFLECTION);
        }
        let wi = refract(wo, m, &i).normalize();
        if wi.z * wo.z >= 0.0 {
            return None;
        }
        let q = o + i.eta_it * wi.dot(m);
        let jacobian = (i.eta_it * i.eta_it * wi.dot(m) * o / (q * q)).abs();
        let weight =
            self.transmittance * (self.facets.g1(wi, m) * compression(i.eta_ti, transport));
        let pdf = (1.0 - i.r) * seen * jacobian;
        weighted(wi, weight, pdf, i.eta_it, GLOSSY_TRANSMISSION)
    }

    fn flags(&self) -> LobeFlags {
        GLOSSY_REFLECTION | GLOSSY_TRANSMISSION
    }

    fn albedo(&self) -> Rgb {
        self.reflectance.max(self.transmittance)
    }

    fn roughness(&self) -> Option<f32> {
        Some(self.facets.alpha())
    }
}
