//! Small, very bright parts of the sky: suns.
//!
//! Most lights can be looked for in many directions. A sun cannot: where it is seen through glass or in a mirror, it
//! takes a direction that is right to a fraction of a degree. Who wants to aim at it has to know where it stands.

use super::Lights;
use super::distant::Distant;
use crate::math::Vec3;

/// A small part of the sky from which much of its light comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beacon {
    /// Unit direction towards its middle.
    pub center: Vec3,
    /// Distance of its rim from there on the unit sphere: the chord of its angular radius.
    pub radius: f32,
}

/// Largest radius: what is wider is met without being aimed at.
const LARGEST: f32 = 0.1;
/// A texel belongs to a sun if it is so many times as bright as its map is on average.
pub(super) const BRIGHT: f32 = 100.0;
/// A sun brings at least this share of its map's light.
pub(super) const LEAST_SHARE: f32 = 0.05;

impl Beacon {
    /// That around `center`, unless it is too large for one.
    pub(super) fn new(center: Vec3, radius: f32) -> Option<Self> {
        (center.is_finite() && radius > 0.0 && radius <= LARGEST).then_some(Self { center, radius })
    }

    /// Whether a unit direction points at it.
    #[inline]
    pub fn contains(&self, dir: Vec3) -> bool {
        (dir - self.center).length_squared() <= self.radius * self.radius
    }
}

impl Lights {
    /// All of the sky's.
    pub fn beacons(&self) -> Vec<Beacon> {
        let beacon = |light: &Distant| match light {
            Distant::Sun(sun) => Beacon::new(sun.center, (2.0 * sun.one_minus_cos).sqrt()),
            Distant::Map(map) => map.beacon(),
            Distant::Constant(_) | Distant::Parallel { .. } => None,
        };
        self.distant.iter().filter_map(|(_, d)| beacon(d)).collect()
    }
}
