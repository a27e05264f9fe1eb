//! Microfacet distributions: how the normals of a rough surface are spread (Walter et al. 2007),
//! how much of them is seen, and drawing the visible ones (Heitz and d'Eon 2014).
//!
//! Roughness `alpha` means what it means in Mitsuba: the root mean square slope for Beckmann, the
//! width parameter of Trowbridge-Reitz for GGX. It is held at or above [`MIN_ALPHA`], Mitsuba's
//! floor, and never turned into a delta: `D` then peaks at 3e7, which f32 holds with ease, and a
//! scene looks the same here as there. The furnace test runs from alpha = 1e-8 to 1.

use crate::math::special::{erf, erf_inv};
use crate::math::warp::concentric_disk;
use crate::math::{Vec2, Vec3};
use std::f32::consts::{FRAC_2_SQRT_PI, PI, TAU};

/// The smallest roughness that is evaluated.
pub(super) const MIN_ALPHA: f32 = 1e-4;

/// Shape of a microfacet distribution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Distribution {
    /// Beckmann and Spizzichino.
    #[default]
    Beckmann,
    /// GGX / Trowbridge-Reitz.
    Ggx,
}

/// A distribution of facet normals in the local frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Microfacet {
    distribution: Distribution,
    alpha_u: f32,
    alpha_v: f32,
}

impl Microfacet {
    /// A distribution with the given roughness along the tangent and the bitangent. Not-a-number
    /// becomes the floor.
    #[inline]
    pub fn new(distribution: Distribution, alpha_u: f32, alpha_v: f32) -> Self {
        Self {
            distribution,
            alpha_u: alpha_u.max(MIN_ALPHA),
            alpha_v: alpha_v.max(MIN_ALPHA),
        }
    }

    /// The smaller roughness.
    #[inline]
    pub fn alpha(&self) -> f32 {
        self.alpha_u.min(self.alpha_v)
    }

    /// Density of facet area over normals `m`, per unit of macroscopic area.
    #[inline]
    pub fn d(&self, m: Vec3) -> f32 {
        let (x, y) = (m.x / self.alpha_u, m.y / self.alpha_v);
        let z2 = m.z * m.z;
        let area = PI * self.alpha_u * self.alpha_v;
        let d = match self.distribution {
            Distribution::Beckmann => (-(x * x + y * y) / z2).exp() / (area * z2 * z2),
            Distribution::Ggx => {
                let q = x * x + y * y + z2;
                1.0 / (area * q * q)
            }
        };
        // Also drops the 0/0 of a Beckmann normal in the surface's plane.
        if d * m.z > 1e-20 { d } else { 0.0 }
    }

    /// Smith's masking: the fraction of facets with normal `m` that is seen from `v`; 0 where `v`
    /// sees the facet's back. Beckmann's is the rational fit of Walter et al. (error below 0.35 %),
    /// as in Mitsuba.
    #[inline]
    pub fn g1(&self, v: Vec3, m: Vec3) -> f32 {
        if v.dot(m) * v.z <= 0.0 {
            return 0.0;
        }
        let (x, y) = (self.alpha_u * v.x, self.alpha_v * v.y);
        let xy2 = x * x + y * y;
        if xy2 == 0.0 {
            return 1.0;
        }
        let tan2 = xy2 / (v.z * v.z);
        match self.distribution {
            Distribution::Ggx => 2.0 / (1.0 + (1.0 + tan2).sqrt()),
            Distribution::Beckmann => {
                let a = 1.0 / tan2.sqrt();
                if a >= 1.6 {
                    return 1.0;
                }
                let a2 = a * a;
                (3.535 * a + 2.181 * a2) / (1.0 + 2.276 * a + 2.577 * a2)
            }
        }
    }

    /// Of the facets with normal `m` that are seen from `wo`, the fraction that is also seen from
    /// `wi`: with heights that are the same for both, `G2 / G1` of Heitz ("Understanding the
    /// Masking-Shadowing Function in Microfacet-Based BRDFs", 2014, equation 99).
    #[inline]
    pub fn shadowing(&self, wo: Vec3, wi: Vec3, m: Vec3) -> f32 {
        let (o, i) = (self.g1(wo, m), self.g1(wi, m));
        if i <= 0.0 {
            return 0.0;
        }
        i / (i + o * (1.0 - i))
    }

    /// A facet normal, in proportion to the area that `wo` (with `wo.z` > 0) sees of it: with
    /// density `d(m) g1(wo, m) |wo.m| / wo.z` in solid angle.
    #[inline]
    pub fn sample(&self, wo: Vec3, u: Vec2) -> Vec3 {
        let v = Vec3::new(self.alpha_u * wo.x, self.alpha_v * wo.y, wo.z).normalize();
        match self.distribution {
            Distribution::Ggx => self.sample_ggx(v, u),
            Distribution::Beckmann => self.sample_beckmann(v, u),
        }
    }

    /// The stretched hemisphere seen from `v` is half a disk and half an ellipse; a point on them
    /// is a point on the hemisphere (Heitz, "Sampling the GGX Distribution of Visible Normals",
    /// JCGT 2018).
    #[inline]
    fn sample_ggx(&self, v: Vec3, u: Vec2) -> Vec3 {
        let len2 = v.x * v.x + v.y * v.y;
        let t1 = if len2 > 0.0 {
            Vec3::new(-v.y, v.x, 0.0) / len2.sqrt()
        } else {
            Vec3::X
        };
        let t2 = v.cross(t1);
        let d = concentric_disk(u);
        let s = 0.5 * (1.0 + v.z);
        let y = (1.0 - s) * (1.0 - d.x * d.x).max(0.0).sqrt() + s * d.y;
        let z = (1.0 - d.x * d.x - y * y).max(0.0).sqrt();
        let n = t1 * d.x + t2 * y + v * z;
        self.unstretch(n)
    }

    fn sample_beckmann(&self, v: Vec3, u: Vec2) -> Vec3 {
        let sin = (v.x * v.x + v.y * v.y).sqrt();
        let (cos_phi, sin_phi) = if sin > 0.0 {
            (v.x / sin, v.y / sin)
        } else {
            (1.0, 0.0)
        };
        let slope = beckmann_slope(v.z, sin, u);
        let x = cos_phi * slope.x - sin_phi * slope.y;
        let y = sin_phi * slope.x + cos_phi * slope.y;
        self.unstretch(Vec3::new(-x, -y, 1.0))
    }

    /// From the surface stretched to roughness 1 back to the real one. The floor keeps the normal
    /// off the plane where `d` has no value.
    #[inline]
    fn unstretch(&self, n: Vec3) -> Vec3 {
        Vec3::new(self.alpha_u * n.x, self.alpha_v * n.y, n.z.max(1e-6)).normalize()
    }
}

/// A slope of the Beckmann surface of roughness 1, in proportion to its area seen from the angle
/// with the given cosine and sine (Jakob, "An Improved Visible Normal Sampling Routine for the
/// Beckmann Distribution", 2014): the cumulative distribution is inverted in the domain of
/// erf(slope), by Newton's method inside a bracket, so that no angle can make it diverge.
fn beckmann_slope(cos: f32, sin: f32, u: Vec2) -> Vec2 {
    let (tan, cot) = (sin / cos.max(1e-10), cos / sin.max(1e-10));
    let scale = 0.5 * FRAC_2_SQRT_PI * tan;
    let (mut low, mut high) = (-1.0, erf(cot));
    let target = u.x.clamp(1e-7, 1.0 - 1e-7);
    let norm = 1.0 / (1.0 + high + scale * (-cot * cot).exp());
    // Jakob's fit of the solution: three rounds then do, at any angle.
    let theta = sin.atan2(cos);
    let fit = 1.0 + theta * (-0.876 + theta * (0.4265 - 0.0594 * theta));
    let mut x = high - (high + 1.0) * (1.0 - target).powf(fit);
    for _ in 0..10 {
        if !(low..=high).contains(&x) {
            x = 0.5 * (low + high);
        }
        let slope = erf_inv(x);
        let value = norm * (1.0 + x + scale * (-slope * slope).exp()) - target;
        if value.abs() < 1e-5 {
            break;
        }
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        x -= value / (norm * (1.0 - slope * tan));
    }
    Vec2::new(erf_inv(x), erf_inv(2.0 * u.y - 1.0))
}

/// Ward's elliptical Gaussian half vector with roughness `alpha`; its density over half vectors is
/// `exp(-tan^2) / (pi au av cos^3)`.
#[inline]
pub(super) fn sample_gaussian_half(alpha: Vec2, u: Vec2) -> Vec3 {
    let (sin, cos) = (TAU * u.y).sin_cos();
    let r = (-(1.0 - u.x).ln()).max(0.0).sqrt();
    Vec3::new(alpha.x * cos * r, alpha.y * sin * r, 1.0).normalize()
}
