//! The watertight ray-triangle test of Woop, Benthin and Wald (JCGT 2013).
//!
//! Vertices are moved to the ray's origin and sheared so that the ray runs along +z. What is left
//! is a point in triangle test in 2D: three edge functions, each computed from the same two rounded
//! vertices by both triangles that share the edge, so no ray slips between them. An edge function
//! of exactly 0 is computed again in `f64`, where the products of `f32` are exact.

use crate::math::offset::gamma;
use crate::math::{Vec3, Vec3A};
use glam::Mat3A;

/// A ray prepared for triangles: the map that moves the ray's largest axis to z and straightens it.
#[derive(Clone, Copy, Debug)]
pub struct ShearedRay {
    org: Vec3A,
    map: Mat3A,
}

impl ShearedRay {
    /// Prepares a ray whose direction is finite and not zero.
    #[inline]
    pub fn new(org: Vec3, dir: Vec3) -> Self {
        let size = dir.abs();
        let z = if size.x >= size.y && size.x >= size.z {
            0
        } else if size.y >= size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // Keeps the winding, so that the signs of the edge functions keep their meaning.
        if dir[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        // x' = x - z dx/dz, y' = y - z dy/dz, z' = z/dz: the ones and zeros multiply exactly.
        let mut columns = [Vec3A::ZERO; 3];
        columns[x] = Vec3A::X;
        columns[y] = Vec3A::Y;
        columns[z] = Vec3A::new(-dir[x] / dir[z], -dir[y] / dir[z], 1.0 / dir[z]);
        Self {
            org: org.into(),
            map: Mat3A::from_cols(columns[0], columns[1], columns[2]),
        }
    }

    /// `(x, y, z)` of a vertex in the sheared space: the same bits in every triangle that has it.
    #[inline]
    fn shear(&self, vertex: Vec3) -> (f32, f32, f32) {
        (self.map * (Vec3A::from(vertex) - self.org)).into()
    }

    /// `(t, u, v)` where the line meets the triangle, from either side.
    #[inline]
    pub fn meet(&self, [a, b, c]: [Vec3; 3]) -> Option<(f32, f32, f32)> {
        let (ax, ay, az) = self.shear(a);
        let (bx, by, bz) = self.shear(b);
        let (cx, cy, cz) = self.shear(c);
        let mut wa = cx * by - cy * bx;
        let mut wb = ax * cy - ay * cx;
        let mut wc = bx * ay - by * ax;
        if wa == 0.0 || wb == 0.0 || wc == 0.0 {
            wa = exact_cross(cx, by, cy, bx);
            wb = exact_cross(ax, cy, ay, cx);
            wc = exact_cross(bx, ay, by, ax);
        }
        let outside = wa.min(wb).min(wc) < 0.0 && wa.max(wb).max(wc) > 0.0;
        let det = wa + wb + wc;
        if outside || det == 0.0 || det.is_nan() {
            return None;
        }
        let inverse = 1.0 / det;
        let t = (wa * az + wb * bz + wc * cz) * inverse;
        let size = |a: f32, b: f32, c: f32| a.abs().max(b.abs()).max(c.abs());
        let error = distance_error(
            [size(ax, bx, cx), size(ay, by, cy), size(az, bz, cz)],
            size(wa, wb, wc),
        );
        // A distance that may be rounding alone is none. The comparison is false for NaN, too.
        (t > error * inverse.abs()).then_some((t, wb * inverse, wc * inverse))
    }
}

/// Bound of the rounding error of `t`, times the determinant: for vertices of at most that size on
/// each axis and edge functions of at most `edge`. ("Physically Based Rendering", 4th ed., 6.8.7.)
/// A ray whose origin was moved off a long, thin triangle would meet it again without this. Guarded
/// by the stability suite's `s03_triangles_are_left`.
#[inline]
fn distance_error([x, y, z]: [f32; 3], edge: f32) -> f32 {
    let (dx, dy, dz) = (gamma(5) * (x + z), gamma(5) * (y + z), gamma(3) * z);
    let d_edge = 2.0 * (gamma(2) * x * y + dy * x + dx * y);
    3.0 * (gamma(3) * edge * z + d_edge * z + dz * edge)
}

/// `a b - c d` with exact products.
#[cold]
fn exact_cross(a: f32, b: f32, c: f32, d: f32) -> f32 {
    (f64::from(a) * f64::from(b) - f64::from(c) * f64::from(d)) as f32
}
