//! A glowing sphere, sampled uniformly over the cone in which it is seen.

use super::cluster::Cluster;
use super::incident::{EmitterPlace, Incident};
use crate::math::warp::{uniform_cone, uniform_cone_pdf, uniform_sphere};
use crate::math::{Frame, Vec2, Vec3};
use std::f32::consts::PI;

/// A sphere that glows outwards, or inwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sphere {
    center: Vec3,
    radius: f32,
    inwards: bool,
}

impl Sphere {
    /// `None` for a radius that is 0 or whose square `f32` cannot hold.
    pub fn new(center: Vec3, radius: f32, inwards: bool) -> Option<Self> {
        (radius * radius).is_normal().then_some(Self {
            center,
            radius,
            inwards,
        })
    }

    pub fn area(&self) -> f32 {
        4.0 * PI * self.radius * self.radius
    }

    pub fn cluster(&self, radiance: f32) -> Cluster {
        Cluster::ball(
            self.center,
            self.radius,
            radiance * PI * self.radius * self.radius,
        )
    }

    pub fn point(&self, u: Vec2) -> (Vec3, Vec3) {
        let n = uniform_sphere(u);
        let p = self.center + n * self.radius;
        (p, if self.inwards { -n } else { n })
    }

    /// What the sphere is from `p`: direction and distance to its centre and `1 - cos` of the
    /// half-angle of its cone. `None` if its glowing side cannot be seen.
    #[inline]
    fn view(&self, p: Vec3) -> Option<(Vec3, f32, f32)> {
        let to = self.center - p;
        let distance = to.length();
        let outside = distance > self.radius;
        if outside == self.inwards {
            return None;
        }
        if !outside {
            // From within the light is all around.
            return Some((Vec3::Z, distance, 2.0));
        }
        let sin = self.radius / distance;
        // 1 - sqrt(1 - sin^2) without cancellation; 1 - sin^2 from the factors, for points close to
        // the surface.
        let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
        Some((to / distance, distance, sin * sin / (1.0 + cos)))
    }

    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        let (axis, center_distance, one_minus_cos) = self.view(p)?;
        let dir = Frame::new(axis).to_world(uniform_cone(u, one_minus_cos));
        let distance = if self.inwards {
            self.exit_from_within(p, dir)
        } else {
            let local_cos = dir.dot(axis);
            let along = center_distance * local_cos;
            // Distance from the axis of the ray to the centre: the cross product keeps its digits
            // where the cone is narrow, 1 - cos^2 would not.
            let across = center_distance * dir.cross(axis).length();
            let inside = (self.radius - across) * (self.radius + across);
            along - inside.max(0.0).sqrt()
        };
        Some(Incident {
            dir,
            distance: distance.max(0.0),
            pdf: uniform_cone_pdf(one_minus_cos),
            place: EmitterPlace::Surface,
        })
    }

    fn exit_from_within(&self, p: Vec3, dir: Vec3) -> f32 {
        let to = self.center - p;
        let along = to.dot(dir);
        let across = (to - dir * along).length();
        along
            + ((self.radius - across) * (self.radius + across))
                .max(0.0)
                .sqrt()
    }

    /// The direction to `q` is inside the cone, because a ray met the sphere at `q`: the far side
    /// does not glow.
    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        let Some((_, _, one_minus_cos)) = self.view(p) else {
            return 0.0;
        };
        let far_side = (q - self.center).dot(q - p) > 0.0;
        if far_side && !self.inwards {
            return 0.0;
        }
        uniform_cone_pdf(one_minus_cos)
    }
}
