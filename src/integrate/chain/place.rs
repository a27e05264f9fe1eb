//! Where chains end: rough vertices, as far as aiming goes by them.

use super::seed::Seed;
use crate::accel::Ray;
use crate::bsdf::Bsdf;
use crate::math::Vec3;
use crate::math::offset::offset_origin;
use crate::texture::SurfacePoint;

/// A rough vertex.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Where, world space.
    pub position: Vec3,
    error: Vec3,
    ng: Vec3,
    /// The side that light counts from; zero: both.
    side: Vec3,
}

/// A rough vertex that a path has left, and how.
#[derive(Clone, Copy, Debug)]
pub struct Station {
    /// Where.
    pub place: Place,
    /// The direction in which it left.
    pub dir: Vec3,
    /// The density of that, solid angle.
    pub pdf: f32,
    /// The chance with which the path aimed there.
    pub chance: f32,
}

/// How far a place that is moved may be off its surface, relative to the move.
const OFF: f32 = 1e-3;

impl Place {
    /// That of a vertex.
    pub fn new(point: &SurfacePoint, bsdf: &Bsdf, wo: Vec3) -> Self {
        Self {
            position: point.p,
            error: point.error,
            ng: point.ng,
            side: bsdf.light_normal(wo),
        }
    }

    /// The same place moved along the surface, so that rays in direction `dir` are moved by `by`, which is at right angles to
    /// it; `None` where they graze the surface.
    pub(super) fn moved(&self, dir: Vec3, by: Vec3) -> Option<Self> {
        let along = by.dot(self.ng) / dir.dot(self.ng);
        let position = self.position + by - dir * along;
        // The surface may curve away, and rounding leads below it: guarded by `a_seed_follows_the_suns_image_in_a_cylinder`.
        let error = self.error + by.length() * OFF;
        position.is_finite().then_some(Self {
            position,
            error,
            ..*self
        })
    }

    /// A ray that leaves it.
    pub(super) fn ray(&self, dir: Vec3) -> Ray {
        Ray::new(offset_origin(self.position, self.error, self.ng, dir), dir)
    }

    /// How likely a seed is to be drawn here, relative to others.
    #[inline]
    pub(super) fn weight(&self, seed: &Seed) -> f32 {
        let behind = self.side != Vec3::ZERO && self.side.dot(seed.seen_from(self.position)) <= 0.0;
        if behind { 0.0 } else { seed.weight() }
    }
}
