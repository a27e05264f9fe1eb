//! A glowing triangle, sampled uniformly over its area.

use super::cluster::Cluster;
use super::incident::{EmitterPlace, Incident, at_distance, solid_angle_density};
use crate::math::warp::uniform_triangle;
use crate::math::{Vec2, Vec3};

/// A triangle that glows on the side of `normal`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
    area: f32,
    /// Its number in its mesh.
    pub prim: u32,
}

impl Triangle {
    /// `None` if the triangle has no area, or none that `f32` can hold.
    pub fn new(corners: [Vec3; 3], prim: u32, flip: bool) -> Option<Self> {
        let edges = [corners[1] - corners[0], corners[2] - corners[0]];
        let (normal, double_area) = unit_normal(edges[0], edges[1])?;
        Some(Self {
            corner: corners[0],
            edges,
            normal: if flip { -normal } else { normal },
            area: 0.5 * double_area,
            prim,
        })
    }

    pub fn area(&self) -> f32 {
        self.area
    }

    pub fn cluster(&self, radiance: f32) -> Cluster {
        let [a, b] = self.edges;
        let corners = [self.corner, self.corner + a, self.corner + b];
        Cluster::around(&corners, self.normal, 1.0, radiance * self.area)
    }

    /// A point on it and its normal.
    pub fn point(&self, u: Vec2) -> (Vec3, Vec3, EmitterPlace) {
        let b = uniform_triangle(u);
        let p = self.corner + self.edges[0] * b.x + self.edges[1] * b.y;
        (p, self.normal, EmitterPlace::Barycentric(self.prim, b))
    }

    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        if self.normal.dot(p - self.corner) <= 0.0 {
            return None;
        }
        let (q, n, place) = self.point(u);
        at_distance(p, q, n, 1.0 / self.area, place)
    }

    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        if self.normal.dot(p - self.corner) <= 0.0 {
            return 0.0;
        }
        solid_angle_density(p, q, self.normal, 1.0 / self.area)
    }
}

/// Unit normal and length of `a x b`; computed in `f64`, so that slivers and shapes far below or
/// above the scale of one keep theirs. `None` if the edges span nothing.
pub(super) fn unit_normal(a: Vec3, b: Vec3) -> Option<(Vec3, f32)> {
    let cross = a.as_dvec3().cross(b.as_dvec3());
    let length = cross.length();
    let as_f32 = length as f32;
    if !as_f32.is_normal() {
        return None;
    }
    Some(((cross / length).as_vec3(), as_f32))
}
