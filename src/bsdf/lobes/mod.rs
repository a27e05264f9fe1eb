//! The models that scatter by themselves, one file each, in the local frame where the normal is +z.
//!
//! Each has two structs: its parameters, a [`Model`](super::model::Model), and the plain numbers
//! that they are at a point, a [`Lobe`]. Models around other models (blends, coatings, perturbed
//! frames) are nodes of [`super::tree`].

use super::{BsdfSample, LobeFlags, Transport};
use crate::math::warp::{cosine_hemisphere, cosine_hemisphere_pdf};
use crate::math::{Rgb, Vec2, Vec3};

pub(super) mod conductor;
pub(super) mod dielectric;
pub(super) mod diffuse;
pub(super) mod diffuse_transmitter;
pub(super) mod measured;
pub(super) mod metallic_roughness;
mod metallic_roughness_parts;
pub(super) mod null;
pub(super) mod phong;
pub(super) mod plastic;
pub(super) mod principled;
pub(super) mod principled_parts;
pub(super) mod principled_thin;
pub(super) mod rough_conductor;
pub(super) mod rough_dielectric;
pub(super) mod rough_diffuse;
pub(super) mod rough_plastic;
pub(super) mod thin_dielectric;
pub(super) mod ward;

/// Smooth reflection.
pub(super) const GLOSSY_REFLECTION: LobeFlags =
    LobeFlags(LobeFlags::SMOOTH.0 | LobeFlags::REFLECTION.0);
/// Smooth transmission.
pub(super) const GLOSSY_TRANSMISSION: LobeFlags =
    LobeFlags(LobeFlags::SMOOTH.0 | LobeFlags::TRANSMISSION.0);
/// Mirror reflection.
pub(super) const DELTA_REFLECTION: LobeFlags =
    LobeFlags(LobeFlags::DELTA.0 | LobeFlags::REFLECTION.0);
/// Clear transmission.
pub(super) const DELTA_TRANSMISSION: LobeFlags =
    LobeFlags(LobeFlags::DELTA.0 | LobeFlags::TRANSMISSION.0);
/// Passing straight through.
pub(super) const NULL_TRANSMISSION: LobeFlags = LobeFlags(DELTA_TRANSMISSION.0 | LobeFlags::NULL.0);

/// A scattering model at one point. Directions are local, `wo` towards where the path came from.
/// The methods that are given are those of a lobe of delta parts alone.
pub(super) trait Lobe {
    /// `f |cos theta_i|` and the density of [`Lobe::sample`], both without delta parts.
    #[inline]
    fn eval_pdf(&self, _wo: Vec3, _wi: Vec3, _transport: Transport) -> (Rgb, f32) {
        (Rgb::ZERO, 0.0)
    }

    /// Draws a local direction; the sample's `wi` is local too.
    fn sample(&self, wo: Vec3, u_lobe: f32, u: Vec2, transport: Transport) -> Option<BsdfSample>;

    /// What it does.
    fn flags(&self) -> LobeFlags;

    /// Colour for the albedo image.
    fn albedo(&self) -> Rgb;

    /// Smallest roughness of its smooth parts; `None` if it has only delta parts.
    fn roughness(&self) -> Option<f32> {
        None
    }
}

/// Makes an enum of lobes that is itself a lobe.
macro_rules! either_lobe {
    (
        $(#[$doc:meta])*
        $visibility:vis enum $name:ident { $($variant:ident($lobe:ty),)* }
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug)]
        $visibility enum $name {
            $($variant($lobe),)*
        }

        impl $crate::bsdf::lobes::Lobe for $name {
            #[inline]
            fn eval_pdf(
                &self,
                wo: $crate::math::Vec3,
                wi: $crate::math::Vec3,
                transport: $crate::bsdf::Transport,
            ) -> ($crate::math::Rgb, f32) {
                match self {
                    $(Self::$variant(lobe) => lobe.eval_pdf(wo, wi, transport),)*
                }
            }

            #[inline]
            fn sample(
                &self,
                wo: $crate::math::Vec3,
                u_lobe: f32,
                u: $crate::math::Vec2,
                transport: $crate::bsdf::Transport,
            ) -> Option<$crate::bsdf::BsdfSample> {
                match self {
                    $(Self::$variant(lobe) => lobe.sample(wo, u_lobe, u, transport),)*
                }
            }

            #[inline]
            fn flags(&self) -> $crate::bsdf::LobeFlags {
                match self {
                    $(Self::$variant(lobe) => lobe.flags(),)*
                }
            }

            #[inline]
            fn albedo(&self) -> $crate::math::Rgb {
                match self {
                    $(Self::$variant(lobe) => lobe.albedo(),)*
                }
            }

            #[inline]
            fn roughness(&self) -> Option<f32> {
                match self {
                    $(Self::$variant(lobe) => lobe.roughness(),)*
                }
            }
        }
    };
}
pub(super) use either_lobe;

/// A sample of a smooth lobe whose weight is its value over its density, or nothing where either is
/// 0.
#[inline]
pub(super) fn smooth_sample(
    wi: Vec3,
    value: Rgb,
    pdf: f32,
    eta: f32,
    lobe: LobeFlags,
) -> Option<BsdfSample> {
    weighted(wi, value / pdf, pdf, eta, lobe)
}

/// A sample, or nothing where it would carry no light or no finite light.
#[inline]
pub(super) fn weighted(
    wi: Vec3,
    weight: Rgb,
    pdf: f32,
    eta: f32,
    lobe: LobeFlags,
) -> Option<BsdfSample> {
    let usable = pdf > 0.0 && pdf.is_finite() && weight.is_finite() && weight.max_element() > 0.0;
    usable.then_some(BsdfSample {
        wi,
        weight,
        pdf,
        eta,
        lobe,
    })
}

/// Draws from a model of two parts, seen from the side of +z: a lobe with probability `p_lobe`, by
/// `lobe`, or the diffuse base under it.
#[inline]
pub(super) fn sample_over_diffuse(
    model: &impl Lobe,
    wo: Vec3,
    (u_lobe, u): (f32, Vec2),
    transport: Transport,
    p_lobe: f32,
    lobe: impl FnOnce() -> Vec3,
) -> Option<BsdfSample> {
    let wi = if u_lobe < p_lobe {
        lobe()
    } else {
        sample_cosine(u)
    };
    let (value, pdf) = model.eval_pdf(wo, wi, transport);
    smooth_sample(wi, value, pdf, 1.0, GLOSSY_REFLECTION)
}

/// Cosine-weighted direction on the side of +z.
#[inline]
pub(super) fn sample_cosine(u: Vec2) -> Vec3 {
    cosine_hemisphere(u)
}

/// Its density.
#[inline]
pub(super) fn cosine_pdf(cos: f32) -> f32 {
    cosine_hemisphere_pdf(cos)
}

/// Probability of the first of two lobes with the given non-negative weights: a half each where
/// neither has any.
#[inline]
pub(super) fn share(first: f32, second: f32) -> f32 {
    let sum = first + second;
    if sum > 0.0 { first / sum } else { 0.5 }
}

/// Mean of the channels, the weight by which Mitsuba chooses among lobes.
#[inline]
pub(super) fn mean(c: Rgb) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}

/// A diffuse and a specular reflectance, scaled down where they sum to more than 1 in a channel, as
/// Mitsuba 0.6 does for its empirical models (there by the textures' maxima, here at the point).
#[inline]
pub(super) fn conserving(diffuse: Rgb, specular: Rgb) -> (Rgb, Rgb) {
    let most = (diffuse + specular).max_element();
    if most <= 1.0 {
        return (diffuse, specular);
    }
    (diffuse * (0.99 / most), specular * (0.99 / most))
}
