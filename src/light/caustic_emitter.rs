//! Small, very bright lights: suns and lamps.
//!
//! Most lights can be looked for in many directions. These cannot: where one is seen through glass
//! or in a mirror, it takes a direction that is right to a fraction of a degree. Who wants to aim
//! at it has to know where it is.

use super::EmitterId;
use crate::accel::Ray;
use crate::math::{Frame, Vec2, Vec3};

/// A small light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CausticEmitter {
    /// A part of the sky from which much of its light comes.
    Sun {
        /// Unit direction towards its middle.
        center: Vec3,
        /// Distance of its rim from there on the unit sphere: the chord of its angular radius.
        radius: f32,
    },
    /// A shape that glows.
    Lamp {
        /// Which.
        emitter: EmitterId,
        /// Middle of a ball around it.
        center: Vec3,
        /// Radius of that.
        radius: f32,
    },
}

/// Light that a ray has met.
#[derive(Clone, Copy, Debug)]
pub enum Shining {
    /// The sky in a unit direction.
    Sky(Vec3),
    /// A shape that glows.
    Shape(EmitterId),
}

/// Largest radius of a sun: what is wider is met without being aimed at.
const LARGEST_SUN: f32 = 0.1;
/// A texel belongs to a sun if it is so many times as bright as its map is on average.
pub(super) const BRIGHT: f32 = 100.0;
/// A sun brings at least this share of its map's light, a lamp of that of all lamps.
pub(super) const LEAST_SHARE: f32 = 0.05;

impl CausticEmitter {
    /// The sun around `center`, unless it is too large for one.
    pub(super) fn sun(center: Vec3, radius: f32) -> Option<Self> {
        (center.is_finite() && radius > 0.0 && radius <= LARGEST_SUN)
            .then_some(Self::Sun { center, radius })
    }

    /// Whether this is where the light came from.
    #[inline]
    pub fn is(&self, light: Shining) -> bool {
        match (self, light) {
            (Self::Sun { center, radius }, Shining::Sky(dir)) => {
                (dir - *center).length_squared() <= radius * radius
            }
            (Self::Lamp { emitter, .. }, Shining::Shape(met)) => *emitter == met,
            _ => false,
        }
    }

    /// The frame of the plane through its middle that faces a point.
    pub fn facing(&self, from: Vec3) -> Frame {
        match self {
            Self::Sun { center, .. } => Frame::new(*center),
            Self::Lamp { center, .. } => {
                Frame::new((*center - from).try_normalize().unwrap_or(Vec3::Z))
            }
        }
    }

    /// Where a ray goes through that plane, in radii from the middle. `None` if it leads away.
    pub fn crossing(&self, plane: &Frame, ray: &Ray) -> Option<Vec2> {
        let dir = plane.to_local(ray.dir);
        if dir.z <= 0.0 {
            return None;
        }
        let slope = Vec2::new(dir.x, dir.y) / dir.z;
        match self {
            Self::Sun { radius, .. } => Some(slope / *radius),
            Self::Lamp { center, radius, .. } => {
                let org = plane.to_local(ray.org - *center);
                (org.z < 0.0).then(|| (Vec2::new(org.x, org.y) - slope * org.z) / *radius)
            }
        }
    }

    /// The derivative of that, where the derivatives of the ray's origin and direction are these.
    pub fn crossing_change(&self, plane: &Frame, ray: &Ray, [org, dir]: [Vec3; 2]) -> Vec2 {
        let along = plane.to_local(ray.dir);
        let change = plane.to_local(dir);
        let slope = Vec2::new(along.x, along.y) / along.z;
        let slopes = (Vec2::new(change.x, change.y) - slope * change.z) / along.z;
        match self {
            Self::Sun { radius, .. } => slopes / *radius,
            Self::Lamp { center, radius, .. } => {
                let height = plane.to_local(ray.org - *center).z;
                let moved = plane.to_local(org);
                let aside = Vec2::new(moved.x, moved.y) - slope * moved.z;
                (aside - slopes * height) / *radius
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_changes_as_neighbours_cross() {
        const STEP: f32 = 1e-3;
        let center = Vec3::new(1.0, 6.0, -2.0);
        let lamp = CausticEmitter::Lamp {
            emitter: 0,
            center,
            radius: 0.5,
        };
        let sun = CausticEmitter::sun(center.normalize(), 0.05).expect("it is small");
        let org = Vec3::new(0.2, -0.3, 0.1);
        let plane = Frame::new((center - org).normalize());
        let dir = (center - org + Vec3::new(0.3, 0.0, 0.4)).normalize();
        let change = [Vec3::new(0.4, 0.1, -0.2), Vec3::new(0.2, -0.1, 0.3)];
        for light in [sun, lamp] {
            let at = |step: f32| {
                let ray = Ray::new(org + change[0] * step, dir + change[1] * step);
                light.crossing(&plane, &ray).unwrap()
            };
            let expected = (at(STEP) - at(-STEP)) / (2.0 * STEP);
            let found = light.crossing_change(&plane, &Ray::new(org, dir), change);
            let off = (found - expected).length() / expected.length();
            assert!(off < 0.01, "{found} instead of {expected}");
        }
    }
}
