//! Materials and scattering.
//!
//! A [`Material`] is data: a tree of named models with textured parameters, as a scene file describes
//! it. At a surface point it is *resolved* ([`Materials::resolve`]): textures are looked up once, bump
//! and normal maps turn the frame, and out comes a [`Bsdf`] of plain numbers that is sampled,
//! evaluated and asked for densities without touching a texture again.
//!
//! Directions are in world space, unit length, pointing away from the surface: `wo` towards where the
//! path came from, `wi` towards where it goes on. `eval` includes the factor |cos theta_i|.

use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;

/// Index of a [`Material`] in [`Materials`].
pub type MaterialId = u32;

/// What travels along a path: decides the factors that are not symmetric (refraction, shading normals).
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

pub mod material;
pub use material::Material;

/// All materials of a scene.
#[derive(Debug, Default)]
pub struct Materials {
    list: Vec<Material>,
}

impl Materials {
    /// Adds a material and returns its number. Inner materials must have been added before.
    pub fn push(&mut self, material: Material) -> MaterialId {
        self.list.push(material);
        (self.list.len() - 1) as MaterialId
    }

    /// The material `id`.
    pub fn get(&self, id: MaterialId) -> &Material {
        &self.list[id as usize]
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// Resolves material `id` at a point seen from direction `wo` (unit, away from the surface).
    pub fn resolve(&self, id: MaterialId, point: &SurfacePoint, wo: Vec3) -> Bsdf {
        let _ = (id, point, wo);
        unimplemented!()
    }

    /// Opacity of material `id` at a point: below 1 only where a [`Material::Mask`] says so.
    pub fn opacity(&self, id: MaterialId, point: &SurfacePoint) -> f32 {
        let _ = (id, point);
        unimplemented!()
    }

    /// Whether material `id` needs [`Materials::opacity`] asked at every hit.
    pub fn is_masked(&self, id: MaterialId) -> bool {
        let _ = id;
        unimplemented!()
    }
}

/// A material at one point: plain numbers, ready to sample.
#[derive(Clone, Debug)]
pub struct Bsdf {}

impl Bsdf {
    /// What its lobes do, together.
    pub fn flags(&self) -> LobeFlags {
        unimplemented!()
    }

    /// f(wo, wi) |cos theta_i|, without delta lobes.
    pub fn eval(&self, wo: Vec3, wi: Vec3, transport: Transport) -> Rgb {
        let _ = (wo, wi, transport);
        unimplemented!()
    }

    /// Density with which [`Bsdf::sample`] draws `wi`, without delta lobes.
    pub fn pdf(&self, wo: Vec3, wi: Vec3) -> f32 {
        let _ = (wo, wi);
        unimplemented!()
    }

    /// `eval` and `pdf` together: cheaper than one after the other.
    pub fn eval_pdf(&self, wo: Vec3, wi: Vec3, transport: Transport) -> (Rgb, f32) {
        (self.eval(wo, wi, transport), self.pdf(wo, wi))
    }

    /// Draws a direction. `u_lobe` chooses among lobes, `u` inside one. `None` where nothing scatters
    /// (absorbed, below the horizon): a sample of value zero, never to be drawn again.
    pub fn sample(
        &self,
        wo: Vec3,
        u_lobe: f32,
        u: Vec2,
        transport: Transport,
    ) -> Option<BsdfSample> {
        let _ = (wo, u_lobe, u, transport);
        unimplemented!()
    }

    /// Reflectance for the albedo AOV (OIDN's meaning: about the colour a denoiser should keep; 1 for clear glass and mirrors).
    pub fn albedo(&self) -> Rgb {
        unimplemented!()
    }

    /// Smallest roughness alpha among the smooth lobes: 1 for diffuse, 0 if there is none. Decides what guiding may touch.
    pub fn roughness(&self) -> f32 {
        unimplemented!()
    }
}
