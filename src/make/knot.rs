//! A tube along a torus knot.

use super::half_quad;
use crate::math::DVec3;
use std::f64::consts::TAU;

/// Turns around the axis, and around the core.
const TURNS: (f64, f64) = (2.0, 3.0);
/// Radii of the torus that carries the curve.
const RADII: (f64, f64) = (1.0, 0.42);
/// Radius of the tube.
const TUBE: f64 = 0.22;
/// Quads along the tube for each around it: about as long as wide.
const ALONG: u64 = 12;

/// A tube of `rings` rings with `sides` sides.
#[derive(Clone, Debug)]
pub struct Knot {
    rings: u64,
    sides: u64,
}

impl Knot {
    /// Of about that many triangles.
    pub fn new(triangles: u64) -> Self {
        let sides = (triangles / (2 * ALONG)).isqrt().max(3);
        let rings = (triangles / (2 * sides)).max(3 * ALONG);
        Self { rings, sides }
    }

    pub fn vertices(&self) -> u64 {
        self.rings * self.sides
    }

    pub fn triangles(&self) -> u64 {
        2 * self.rings * self.sides
    }

    pub fn vertex(&self, i: u64) -> DVec3 {
        let t = TAU * (i / self.sides) as f64 / self.rings as f64;
        let angle = TAU * (i % self.sides) as f64 / self.sides as f64;
        let (major, minor) = RADII;
        let ((sin_p, cos_p), (sin_q, cos_q)) = ((TURNS.0 * t).sin_cos(), (TURNS.1 * t).sin_cos());
        let outward = DVec3::new(cos_p, 0.0, sin_p);
        let around = DVec3::new(-sin_p, 0.0, cos_p);
        // The torus's normal is perpendicular to every curve on it.
        let normal = outward * cos_q + DVec3::Y * sin_q;
        let center = outward * major + normal * minor;
        let tangent = around * (TURNS.0 * (major + minor * cos_q))
            + (DVec3::Y * cos_q - outward * sin_q) * (TURNS.1 * minor);
        let side = tangent.normalize().cross(normal);
        center + (normal * angle.cos() + side * angle.sin()) * TUBE
    }

    pub fn triangle(&self, i: u64) -> [u64; 3] {
        let quad = i / 2;
        let (side, ring) = (quad % self.sides, quad / self.sides);
        let next_side = (side + 1) % self.sides;
        let (here, next) = (ring * self.sides, (ring + 1) % self.rings * self.sides);
        half_quad(
            [here + side, here + next_side, next + side, next + next_side],
            i % 2 == 1,
        )
    }
}
