//! Materials and scattering.
//!
//! A [`Material`] is data: a tree of named models with textured parameters, as a scene file
//! describes it; each model has a file in `lobes`. At a surface point it is *resolved* ([`Materials::resolve`]): textures are looked
//! up once, bump and normal maps turn the frame, and out comes a [`Bsdf`] of plain numbers that is
//! sampled, evaluated and asked for densities without touching a texture again.
//!
//! Directions are in world space, unit length, pointing away from the surface: `wo` towards where
//! the path came from, `wi` towards where it goes on. `eval` includes the factor |cos theta_i|.

use crate::math::{Frame, Rgb, Vec2, Vec3};
use diffuse_only::Form;
use lobes::{Lobe, weighted};

/// Index of a [`Material`] in [`Materials`].
pub type MaterialId = u32;

/// What travels along a path: decides the factors that are not symmetric (refraction, shading
/// normals).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Camera paths carry radiance.
    Radiance,
    /// Photons carry power.
    Importance,
}

/// What kind of scattering a lobe does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct LobeFlags(pub u8);

impl LobeFlags {
    /// Scatters to more than a few discrete directions.
    pub const SMOOTH: LobeFlags = LobeFlags(1);
    /// Scatters to discrete directions only (mirror, clear glass, null).
    pub const DELTA: LobeFlags = LobeFlags(2);
    /// Scatters to the side the path came from.
    pub const REFLECTION: LobeFlags = LobeFlags(4);
    /// Scatters to the other side.
    pub const TRANSMISSION: LobeFlags = LobeFlags(8);
    /// Passes straight through, as if nothing were there.
    pub const NULL: LobeFlags = LobeFlags(16);
    /// Scatters inside of a medium, where there is no surface.
    pub const VOLUME: LobeFlags = LobeFlags(32);

    /// Whether all of `other`'s bits are set.
    #[inline]
    pub fn has(self, other: LobeFlags) -> bool {
        self.0 & other.0 == other.0
    }
}

impl std::ops::BitOr for LobeFlags {
    type Output = LobeFlags;
    fn bitor(self, o: LobeFlags) -> LobeFlags {
        LobeFlags(self.0 | o.0)
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The direction, world space.
    pub wi: Vec3,
    /// `eval / pdf`: what the throughput is multiplied by.
    pub weight: Rgb,
    /// Density in solid angle; for delta lobes the probability of having chosen the lobe.
    pub pdf: f32,
    /// Relative index of refraction along the path (1 for reflection), for roulette.
    pub eta: f32,
    /// The lobe that was sampled.
    pub lobe: LobeFlags,
}

mod albedo_scaling;
mod clear_coat;
mod coat_and_base;
mod delta_split;
mod diffuse_only;
mod facet_albedo;
mod filtering;
mod fresnel;
mod layer;
mod lobes;
pub mod material;
mod materials;
mod measured;
mod microfacet;
mod model;
mod needs;
mod parameters;
mod perturb;
mod resolve;
mod sheen;
mod thin_film;
mod transmittance;
mod tree;
mod volume;

pub use coat_and_base::View;
pub use delta_split::{DeltaSplit, Rest};
pub use material::Material;
pub use materials::Materials;
pub use measured::{MeasuredBrdf, MeasuredTables};

/// A material at one point: plain numbers, ready to sample.
///
/// Made by [`Materials::resolve`] for one `wo`, which is the one to ask it about: the side of a
/// two-sided material and the frames of bump and normal maps were chosen for it.
#[derive(Clone, Debug)]
pub struct Bsdf {
    frame: Frame,
    ng: Vec3,
    flags: LobeFlags,
    form: Form,
}

/// Largest correction for shading normals: what exceeds it is a ray that grazes a bad normal, and
/// would be a firefly among the photons.
const MAX_CORRECTION: f32 = 10.0;

/// The factor that keeps scattering with shading normals adjoint when power instead of radiance is
/// carried (Veach 1997, 5.3): `|wo.ns| |wi.ng| / (|wo.ng| |wi.ns|)`, at most [`MAX_CORRECTION`].
#[inline]
fn normal_correction(wo: Vec3, wi: Vec3, ns: Vec3, ng: Vec3) -> f32 {
    let above = (wo.dot(ns) * wi.dot(ng)).abs();
    let below = (wo.dot(ng) * wi.dot(ns)).abs();
    if below > above * (1.0 / MAX_CORRECTION) {
        above / below
    } else if above > 0.0 {
        MAX_CORRECTION
    } else {
        0.0
    }
}

impl Bsdf {
    /// What its lobes do, together.
    #[inline]
    pub fn flags(&self) -> LobeFlags {
        self.flags
    }

    /// f(wo, wi) |cos theta_i|, without delta lobes.
    pub fn eval(&self, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        self.eval_pdf(wo, wi, transport).0
    }

    /// Density with which [`Bsdf::sample`] draws `wi`, without delta lobes.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        self.eval_pdf(wo, wi, Transport::Radiance).1
    }

    /// `eval` and `pdf` together: cheaper than one after the other.
    // Inlined: most surfaces are diffuse, and a call takes longer than they do.
    #[inline(always)]
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        let (o, i) = (self.frame.to_local(wo), self.frame.to_local(wi));
        let (value, pdf) = match &self.form {
            Form::Diffuse(diffuse) => diffuse.eval_pdf(o, i, transport),
            Form::Tree(tree) => tree.eval_pdf(tree.root(), o, i, transport),
        };
        match transport {
            Transport::Radiance => (value, pdf),
            Transport::Importance => (value * self.correction(wo, wi), pdf),
        }
    }

    /// Draws a direction. `u_lobe` chooses among lobes, `u` inside one. `None` where nothing
    /// scatters (absorbed, below the horizon): a sample of value zero, never to be drawn again.
    // Inlined for the same reason.
    #[inline(always)]
    pub fn sample(
        &self,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let o = self.frame.to_local(wo);
        let local = match &self.form {
            Form::Diffuse(diffuse) => diffuse.sample(o, u_lobe, u, transport)?,
            Form::Tree(tree) => tree.sample(tree.root(), o, u_lobe, u, transport)?,
        };
        let wi = self.frame.to_world(local.wi);
        if transport == Transport::Radiance {
            return Some(BsdfSample { wi, ..local });
        }
        let weight = local.weight * self.correction(wo, wi);
        weighted(wi, weight, local.pdf, local.eta, local.lobe)
    }

    #[inline]
    fn correction(&self, wo: Vec3, wi: Vec3) -> f32 {
        normal_correction(wo, wi, self.frame.n, self.ng)
    }

    /// The normal that tells which lights can matter, on the side of `wo`; zero where light from
    /// both sides does, or where a bump or normal map turns the horizon.
    #[inline]
    pub fn light_normal(&self, wo: Vec3) -> Vec3 {
        if self.flags().has(LobeFlags::TRANSMISSION)
            || matches!(&self.form, Form::Tree(tree) if tree.turns_normal())
        {
            return Vec3::ZERO;
        }
        let n = self.frame.n;
        if n.dot(wo) < 0.0 { -n } else { n }
    }

    /// Reflectance for the albedo AOV (OIDN's meaning: about the colour a denoiser should keep; 1
    /// for clear glass and mirrors).
    #[inline]
    pub fn albedo(&self) -> Rgb {
        let albedo = match &self.form {
            Form::Diffuse(diffuse) => diffuse.reflectance,
            Form::Tree(tree) => tree.albedo(tree.root()),
        };
        albedo.clamp(Rgb::ZERO, Rgb::ONE)
    }

    /// The normal that it scatters about, world space, bump and normal maps included; where models
    /// with several are mixed, in between. On the side of the shading normal of its point, or the
    /// other. Of unit length, or zero where those of a mixture cancel.
    pub fn normal(&self) -> Vec3 {
        match &self.form {
            Form::Tree(tree) if tree.turns_normal() => {
                let n = tree.normal(tree.root()).normalize_or_zero();
                self.frame.to_world(n)
            }
            Form::Diffuse(_) | Form::Tree(_) => self.frame.n,
        }
    }

    /// The share of a path from `wo` that scatters here, instead of being passed on by a mirror or
    /// by clear glass: 1 where there is no delta lobe, 0 where there is nothing else. Of several
    /// delta lobes beside others, one counts.
    #[inline]
    pub fn rough_share(&self, wo: Vec3) -> f32 {
        if !self.flags().has(LobeFlags::DELTA) {
            return 1.0;
        }
        if !self.flags().has(LobeFlags::SMOOTH) {
            return 0.0;
        }
        let split = self.split_delta(wo, Transport::Radiance);
        split.map_or(1.0, |split| split.rest.chance)
    }

    /// Smallest roughness alpha among the smooth lobes: 1 for diffuse, 0 if there is none. Decides
    /// what guiding may touch.
    #[inline]
    pub fn roughness(&self) -> f32 {
        let alpha = match &self.form {
            Form::Diffuse(_) => return 1.0,
            Form::Tree(tree) => tree.roughness(tree.root()),
        };
        alpha.unwrap_or(0.0).min(1.0)
    }
}

#[cfg(test)]
mod tests;
