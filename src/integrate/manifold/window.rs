//! The part of a light that shines on glass and mirrors.

use crate::accel::Ray;
use crate::light::CausticEmitter;
use crate::math::equal_area::square_to_sphere;
use crate::math::offset::offset_sampled;
use crate::math::warp::concentric_disk;
use crate::math::{Frame, Vec2};
use crate::scene::Scene;

/// A part of the unit square, each place of which stands for some of a light's photons: of a sun's
/// for those that go through a point of a disk in front of the scene, of a lamp's for those with
/// one direction.
#[derive(Clone, Copy, Debug)]
pub struct Window {
    min: Vec2,
    max: Vec2,
}

/// How much wider a window is than what was seen in it, on each side.
const MARGIN: f32 = 0.05;

impl Window {
    /// All photons.
    pub const ALL: Self = Self {
        min: Vec2::ZERO,
        max: Vec2::ONE,
    };

    /// Around some places. The fewer they are, the farther they may be from its edges.
    pub fn around(places: impl Iterator<Item = Vec2>) -> Option<Self> {
        let (mut count, mut min, mut max) = (0, Vec2::INFINITY, Vec2::NEG_INFINITY);
        for at in places {
            (count, min, max) = (count + 1, min.min(at), max.max(at));
        }
        let margin = (max - min) * (MARGIN + 2.0 / count as f32);
        (count > 0).then(|| Self {
            min: (min - margin).max(Vec2::ZERO),
            max: (max + margin).min(Vec2::ONE),
        })
    }

    /// A place in it.
    pub fn sample(&self, u: Vec2) -> Vec2 {
        self.min + (self.max - self.min) * u
    }
}

/// A photon that leaves a light by a place of its square; `u` are further uniform numbers. `None`
/// if nothing shines that way.
pub fn spawn_ray(scene: &Scene, light: &CausticEmitter, at: Vec2, u: [f32; 3]) -> Option<Ray> {
    match *light {
        CausticEmitter::Sun { center, radius } => {
            let frame = Frame::new(center);
            let bounds = scene.rays.bounds();
            let off = concentric_disk(Vec2::new(u[1], u[2])) * radius;
            let dir = -frame.to_world(off.extend(1.0)).normalize();
            let through = frame.to_world((at * 2.0 - 1.0).extend(0.0));
            let from = bounds.center() + (through - dir * 2.0) * bounds.radius();
            Some(Ray::new(from, dir))
        }
        CausticEmitter::Lamp { emitter, .. } => {
            let (from, n) = scene.lights.point_of(emitter, u)?;
            let dir = square_to_sphere(at);
            (dir.dot(n) > 0.0).then(|| Ray::new(offset_sampled(from, n, dir), dir))
        }
    }
}
