//! Small, very bright lights: suns and lamps.
//!
//! Most lights can be looked for in many directions. These cannot: where one is seen through glass or in a mirror, it
//! takes a direction that is right to a fraction of a degree. Who wants to aim at it has to know where it is.

use super::cluster::Cluster;
use super::distant::Distant;
use super::leaf::Leaf;
use super::{EmitterId, Lights};
use crate::accel::{Bounds, Ray};
use crate::math::{Frame, Vec2, Vec3};

/// A small light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beacon {
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
/// Largest radius of a lamp, relative to that of the scene.
const LARGEST_LAMP: f32 = 0.2;
/// Lamps that are looked at, at most: the brightest.
const MOST_LAMPS: usize = 4;
/// A texel belongs to a sun if it is so many times as bright as its map is on average.
pub(super) const BRIGHT: f32 = 100.0;
/// A sun brings at least this share of its map's light, a lamp of that of all lamps.
pub(super) const LEAST_SHARE: f32 = 0.05;

impl Beacon {
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

impl Lights {
    /// All of them.
    pub fn beacons(&self) -> Vec<Beacon> {
        let sun = |light: &Distant| match light {
            Distant::Sun(sun) => Beacon::sun(sun.center, (2.0 * sun.one_minus_cos).sqrt()),
            Distant::Map(map) => map.beacon(),
            Distant::Constant(_) | Distant::Parallel { .. } => None,
        };
        let suns = self.distant.iter().filter_map(|(_, d)| sun(d));
        suns.chain(self.lamps()).collect()
    }

    /// Shapes that are small and bright.
    fn lamps(&self) -> Vec<Beacon> {
        let (Some(local), Some(sources)) = (&self.local, &self.emission) else {
            return Vec::new();
        };
        let (mut first, mut total) = (0, 0.0);
        let mut lamps: Vec<(f32, Beacon)> = Vec::new();
        // The leaves of a shape are neighbours.
        for leaves in local.leaves.chunk_by(|a, b| a.0 == b.0) {
            let share: f32 = (first..first + leaves.len())
                .map(|i| sources.share(i))
                .sum();
            first += leaves.len();
            total += share;
            let (center, radius) = ball(leaves);
            if radius > 0.0 && radius <= LARGEST_LAMP * sources.radius() {
                let emitter = leaves[0].0;
                let lamp = Beacon::Lamp {
                    emitter,
                    center,
                    radius,
                };
                lamps.push((share, lamp));
            }
        }
        lamps.retain(|(share, _)| *share >= LEAST_SHARE * total);
        lamps.sort_by(|a, b| b.0.total_cmp(&a.0));
        lamps.truncate(MOST_LAMPS);
        lamps.into_iter().map(|(_, lamp)| lamp).collect()
    }

    /// A point of a shape that glows, chosen by `u`, and the unit normal on its bright side. `None` if it has none.
    pub fn point_of(&self, emitter: EmitterId, u: [f32; 3]) -> Option<(Vec3, Vec3)> {
        let leaves = &self.local.as_ref()?.leaves;
        let first = leaves.partition_point(|l| l.0 < emitter);
        let count = leaves[first..].partition_point(|l| l.0 == emitter);
        let chosen = ((u[0] * count as f32) as usize).min(count.checked_sub(1)?);
        let (p, n, _, _) = leaves[first + chosen].1.point(Vec2::new(u[1], u[2]));
        Some((p, n))
    }
}

/// A ball around a shape's leaves; of radius 0 if it has no extent.
fn ball(leaves: &[(EmitterId, Leaf)]) -> (Vec3, f32) {
    let glowing = leaves.iter().filter(|(_, leaf)| leaf.area() > 0.0);
    let balls: Vec<Cluster> = glowing.map(|(_, leaf)| leaf.cluster(1.0)).collect();
    let bounds = balls.iter().fold(Bounds::EMPTY, |b, ball| {
        let half = Vec3::splat(ball.radius);
        b.with(ball.center - half).with(ball.center + half)
    });
    let center = bounds.center();
    let reach = |ball: &Cluster| ball.center.distance(center) + ball.radius;
    (center, balls.iter().map(reach).fold(0.0, f32::max))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crossing_changes_as_neighbours_cross() {
        const STEP: f32 = 1e-3;
        let center = Vec3::new(1.0, 6.0, -2.0);
        let lamp = Beacon::Lamp {
            emitter: 0,
            center,
            radius: 0.5,
        };
        let sun = Beacon::sun(center.normalize(), 0.05).expect("it is small");
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
