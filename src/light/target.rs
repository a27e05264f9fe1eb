//! What photons are to land on, as their lights see it.

use crate::accel::Bounds;
use crate::math::warp::uniform_cone;
use crate::math::{Frame, Vec2, Vec3};
use std::f32::consts::TAU;

/// A ball around all that photons are to land on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    pub center: Vec3,
    pub radius: f32,
}

/// The directions in which a target is seen.
pub(super) struct Cone {
    pub axis: Vec3,
    one_minus_cos: f32,
}

/// The ball is a little larger than the one around a box, which touches its corners.
const MARGIN: f32 = 1.0001;
/// From where a target takes more than this sine squared (30 degrees), photons leave in all
/// directions: few would miss.
const WIDE: f32 = 0.25;

impl Target {
    /// Around a box.
    pub fn new(bounds: Bounds) -> Self {
        Self {
            center: bounds.center(),
            radius: bounds.radius() * MARGIN,
        }
    }

    /// The cone in which it is seen from a place; `None` where that is wide.
    pub fn cone(&self, from: Vec3) -> Option<Cone> {
        let to = self.center - from;
        let sin2 = self.radius * self.radius / to.length_squared();
        // (Nor where it is a point.)
        let narrow = sin2 > 0.0 && sin2 < WIDE;
        narrow.then(|| Cone {
            axis: to.normalize(),
            // 1 - sqrt(1 - s), without cancellation.
            one_minus_cos: sin2 / (1.0 + (1.0 - sin2).sqrt()),
        })
    }
}

impl Cone {
    /// How large it is.
    pub fn solid_angle(&self) -> f32 {
        TAU * self.one_minus_cos
    }

    /// A direction in it, all alike.
    pub fn sample(&self, u: Vec2) -> Vec3 {
        Frame::new(self.axis).to_world(uniform_cone(u, self.one_minus_cos))
    }
}
