//! Ray queries: what the renderer asks of a ray tracer, and the two that answer.
//!
//! [`RayQuery`] is the trait; [`embree`] answers with Debian's Embree (the default), [`obvhs`] with
//! a BVH in pure Rust. Both are built from the same [`World`]: triangle meshes, exact shapes (never
//! tessellated) and instances of groups of them.
//!
//! Masked geometry (foliage cut out of a quad by a texture) is resolved *inside* the query: a hit
//! on a geometry with `masked` set is kept with probability [`Opacity::opacity`], by a hash of the
//! ray, so closest hits and shadow rays see the same cut-out and the integrator never meets an
//! invisible surface.

use crate::math::{Affine3A, Vec3};
use std::sync::Arc;

mod backend;
#[cfg(feature = "embree")]
pub mod embree;
mod error;
mod mask;
mod mesh;
pub mod obvhs;
pub mod shape;
mod world;

pub use backend::{Backend, build, prepare_thread};
pub use error::AccelError;
pub use mesh::{BadIndex, TriangleMesh};
pub use shape::{AnalyticKind, AnalyticShape};
pub use world::world_bounds;

#[cfg(test)]
mod tests;

/// A ray: points `org + t * dir` for `t` in `[tmin, tmax]`. `dir` is of unit length.
///
/// 32 bytes in the order of Embree's `RTCRay` head.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Ray {
    /// Origin, world space.
    pub org: Vec3,
    /// Smallest distance that counts.
    pub tmin: f32,
    /// Unit direction.
    pub dir: Vec3,
    /// Largest distance that counts; infinite for a ray that leaves the scene.
    pub tmax: f32,
}

impl Ray {
    /// A ray from `org` to infinity.
    #[inline]
    pub fn new(org: Vec3, dir: Vec3) -> Self {
        Self {
            org,
            tmin: 0.0,
            dir,
            tmax: f32::INFINITY,
        }
    }

    /// Whether the ray can be traced at all: coordinates below [`LARGEST`] and a range that is not
    /// empty. Every other ray meets nothing.
    #[inline]
    pub fn is_traceable(&self) -> bool {
        self.is_traceable_within(OVERFLOW)
    }

    /// The same with a bound of `LARGEST * OVERFLOW / overflow` for the coordinates.
    #[inline]
    pub(crate) fn is_traceable_within(&self, overflow: f32) -> bool {
        // The first factor takes what is too large to infinity; infinity * 0 is NaN, as NaN * 0 is,
        // and all else * 0 is 0. A NaN bound fails the comparison.
        let sum = self.org * overflow * 0.0 + self.dir * overflow * 0.0;
        (sum.x + sum.y + sum.z == 0.0) & (self.tmin <= self.tmax) & (self.tmax >= 0.0)
    }

    /// The point at distance `t`.
    #[inline]
    pub fn at(&self, t: f32) -> Vec3 {
        self.org + self.dir * t
    }
}

/// Coordinates (of rays and of geometry) must stay below this, 2^60: their squares would overflow.
/// Geometry beyond is not found, rays from beyond meet nothing.
pub const LARGEST: f32 = (1u64 << 60) as f32;

/// 2^68: what reaches [`LARGEST`] times this is infinite.
pub(crate) const OVERFLOW: f32 = (1u128 << 68) as f32;

/// [`Hit::shape`] of a ray that met nothing.
pub const MISS: u32 = u32::MAX;
/// [`Hit::instance`] of a hit on geometry that stands in the world by itself.
pub const NO_INSTANCE: u32 = u32::MAX;

/// The closest intersection along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Hit {
    /// Distance along the ray.
    pub t: f32,
    /// First barycentric coordinate (weight of a triangle's second vertex), or a shape's own `u`.
    pub u: f32,
    /// Second barycentric coordinate (weight of a triangle's third vertex), or a shape's own `v`.
    pub v: f32,
    /// Triangle index in its mesh; 0 for exact shapes.
    pub prim: u32,
    /// [`Geometry::id`] of the geometry, or [`MISS`].
    pub shape: u32,
    /// Index into [`World::instances`], or [`NO_INSTANCE`].
    pub instance: u32,
}

impl Hit {
    /// Nothing was met.
    pub const NONE: Hit = Hit {
        t: f32::INFINITY,
        u: 0.0,
        v: 0.0,
        prim: 0,
        shape: MISS,
        instance: NO_INSTANCE,
    };

    /// Whether the ray met something.
    #[inline]
    pub fn is_some(&self) -> bool {
        self.shape != MISS
    }
}

/// What a geometry is made of.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Triangles.
    Triangles(Arc<TriangleMesh>),
    /// A sphere, disk, cylinder or rectangle, met exactly.
    Analytic(AnalyticShape),
}

/// One geometry of the world or of a group.
#[derive(Clone, Debug)]
pub struct Geometry {
    /// The caller's number for it, returned in [`Hit::shape`].
    pub id: u32,
    /// What it is made of.
    pub shape: Shape,
    /// Ask [`Opacity`] whether a hit counts.
    pub masked: bool,
}

/// A group placed in the world.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Index into [`World::groups`].
    pub group: u32,
    /// Group space to world space.
    pub to_world: Affine3A,
}

/// Everything rays can meet.
#[derive(Clone, Debug, Default)]
pub struct World {
    /// Geometry standing in the world by itself, in world coordinates.
    pub geometries: Vec<Geometry>,
    /// Groups of geometry, each in coordinates of its own.
    pub groups: Vec<Vec<Geometry>>,
    /// Where the groups stand.
    pub instances: Vec<Instance>,
}

impl World {
    /// The same without these of the geometries that stand by themselves.
    pub fn without(&self, left_out: impl Fn(&Geometry) -> bool) -> Self {
        let mut rest = self.clone();
        rest.geometries.retain(|geometry| !left_out(geometry));
        rest
    }
}

/// How opaque a masked geometry is at a hit: 0 lets every ray through, 1 none.
pub trait Opacity: Send + Sync {
    /// Opacity at the hit, in `[0, 1]`.
    fn opacity(&self, hit: &Hit) -> f32;
}

/// How long to build, for how fast a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BuildQuality {
    /// Quick to build.
    Fast,
    /// The balance for a render of a minute.
    #[default]
    Balanced,
    /// Slow to build, fastest to trace.
    High,
}

/// How to build.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct BuildSettings {
    /// Speed of the build against speed of the rays.
    pub quality: BuildQuality,
    /// Prefer small trees to fast ones.
    pub compact: bool,
    /// Watertight at edges: costs a few per cent of speed.
    pub robust: bool,
    /// Threads that build; 0 means all.
    pub threads: usize,
    /// Bytes that the trees may hold, at any moment of the build; 0 means that only the system says
    /// no. Embree is held to it; the tree in Rust is not.
    pub memory: usize,
}

/// Axis-aligned bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: Vec3,
    /// Largest corner.
    pub max: Vec3,
}

impl Bounds {
    /// Contains nothing.
    pub const EMPTY: Bounds = Bounds {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// The bounds grown to hold `p`.
    #[inline]
    pub fn with(self, p: Vec3) -> Self {
        Self {
            min: self.min.min(p),
            max: self.max.max(p),
        }
    }

    /// The bounds of both.
    #[inline]
    pub fn union(self, o: Bounds) -> Self {
        Self {
            min: self.min.min(o.min),
            max: self.max.max(o.max),
        }
    }

    /// Whether no point is inside.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The middle; the origin for empty bounds.
    pub fn center(&self) -> Vec3 {
        if self.is_empty() {
            Vec3::ZERO
        } else {
            self.min * 0.5 + self.max * 0.5
        }
    }

    /// Half the diagonal: a sphere of this radius around the centre holds everything.
    pub fn radius(&self) -> f32 {
        if self.is_empty() {
            0.0
        } else {
            (self.max * 0.5 - self.min * 0.5).length()
        }
    }
}

/// What the renderer asks of a ray tracer.
///
/// The batch queries take rays in any order and of any number; a backend may trace them in packets.
/// Results do not depend on how a batch was cut.
pub trait RayQuery: Send + Sync {
    /// The closest hit, or [`Hit::NONE`].
    fn intersect(&self, ray: &Ray) -> Hit;

    /// Whether anything lies between `tmin` and `tmax`.
    fn occluded(&self, ray: &Ray) -> bool;

    /// The closest hit of each ray. `hits` is as long as `rays`.
    fn intersect_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        for (ray, hit) in rays.iter().zip(hits) {
            *hit = self.intersect(ray);
        }
    }

    /// Whether each ray is blocked. `blocked` is as long as `rays`.
    fn occluded_batch(&self, rays: &[Ray], blocked: &mut [bool]) {
        for (ray, blocked) in rays.iter().zip(blocked) {
            *blocked = self.occluded(ray);
        }
    }

    /// Bounds of everything that can be hit.
    fn bounds(&self) -> Bounds;

    /// Bytes the tree holds, without the vertex buffers it shares.
    fn memory_bytes(&self) -> usize;

    /// The settings it was built with.
    fn settings(&self) -> BuildSettings;

    /// Name and version of the backend, for reports.
    fn name(&self) -> String;
}
