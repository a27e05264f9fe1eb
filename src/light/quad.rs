//! A glowing parallelogram. Where it is a rectangle and large in the sky it is sampled uniformly in
//! solid angle (Urena, Fajardo, King, "An Area-Preserving Parametrization for Spherical
//! Rectangles", 2013), otherwise uniformly over its area, which is cheaper and, far away, as good.

use super::cluster::Cluster;
use super::incident::{EmitterPlace, Incident, at_distance, solid_angle_density};
use super::triangle::unit_normal;
use crate::math::special::arc_cosines;
use crate::math::{Vec2, Vec3};
use std::array::from_fn;
use std::f32::consts::TAU;

/// A parallelogram that glows on the side of `normal`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quad {
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
    area: f32,
    /// Unit edges and their lengths, if they are perpendicular.
    rectangle: Option<([Vec3; 2], [f32; 2])>,
}

/// Approximate solid angle above which solid angle sampling pays. At 0.05 the relative variance of
/// an area sample's irradiance beside a square light is still 0.3 (solid angle 0.03), below it
/// falls off; the sample costs about 150 ns instead of 20.
const LARGE: f32 = 0.05;
/// Smallest solid angle that the sum of four angles in `f32` gives to better than 1e-4.
const EXACT_ENOUGH: f32 = 0.01;

/// The rectangle as it is seen from a point: coordinates along its edges and its plane's distance.
struct Seen {
    x: [f32; 2],
    y: [f32; 2],
    /// Negative: the rectangle is on the side of -z.
    z: f32,
    b: [f32; 2],
    k: f32,
    solid_angle: f32,
}

impl Quad {
    /// A parallelogram with the given corner and edges that glows on the side of `facing`. `None`
    /// if it has no area.
    pub fn new(corner: Vec3, edges: [Vec3; 2], facing: Vec3) -> Option<Self> {
        let (normal, area) = unit_normal(edges[0], edges[1])?;
        let normal = if normal.dot(facing) < 0.0 {
            -normal
        } else {
            normal
        };
        let lengths = edges.map(Vec3::length);
        let units = [edges[0] / lengths[0], edges[1] / lengths[1]];
        let square = units[0].dot(units[1]).abs() < 1e-5;
        Some(Self {
            corner,
            edges,
            normal,
            area,
            rectangle: square.then_some((units, lengths)),
        })
    }

    /// The parallelogram that two triangles make, if they do.
    pub fn from_triangles(a: [Vec3; 3], b: [Vec3; 3], flip: bool) -> Option<Self> {
        // The corner of each that the other does not have.
        let lone = |of: &[Vec3; 3], other: &[Vec3; 3]| {
            let mut alone = (0..3).filter(|&i| !other.contains(&of[i]));
            let first = alone.next()?;
            alone.next().is_none().then_some(first)
        };
        let (i, j) = (lone(&a, &b)?, lone(&b, &a)?);
        let (r, p, q) = (a[i], a[(i + 1) % 3], a[(i + 2) % 3]);
        // Wound the same way, the shared edge runs p to q in one and q to p in the other.
        if b[(j + 1) % 3] != q || b[(j + 2) % 3] != p {
            return None;
        }
        let edges = [p - r, q - r];
        let off = (p + edges[1] - b[j]).length();
        let size = edges[0].length() + edges[1].length();
        if off > 1e-5 * size {
            return None;
        }
        let facing = edges[0].cross(edges[1]);
        Self::new(r, edges, if flip { -facing } else { facing })
    }

    pub fn area(&self) -> f32 {
        self.area
    }

    pub fn cluster(&self, radiance: f32) -> Cluster {
        let [a, b] = self.edges;
        let c = self.corner;
        Cluster::around(
            &[c, c + a, c + b, c + a + b],
            self.normal,
            1.0,
            radiance * self.area,
        )
    }

    pub fn point(&self, u: Vec2) -> (Vec3, Vec3) {
        let p = self.corner + self.edges[0] * u.x + self.edges[1] * u.y;
        (p, self.normal)
    }

    /// The spherical rectangle, where it is one and large enough.
    #[inline(always)]
    fn seen(&self, p: Vec3) -> Option<Seen> {
        let (units, lengths) = self.rectangle?;
        let to = self.corner + (self.edges[0] + self.edges[1]) * 0.5 - p;
        let d2 = to.length_squared();
        if self.area * -to.dot(self.normal) < LARGE * d2 * d2.sqrt() {
            return None;
        }
        let d = self.corner - p;
        let z = -d.dot(self.normal).abs();
        let x = [d.dot(units[0]), d.dot(units[0]) + lengths[0]];
        let y = [d.dot(units[1]), d.dot(units[1]) + lengths[1]];
        // Four numbers at a time: these loops become vector code.
        let sides = [-y[0], x[1], y[1], -x[0]];
        let n: [f32; 4] = from_fn(|i| sides[i] / (sides[i] * sides[i] + z * z).sqrt());
        let next = [n[1], n[2], n[3], n[0]];
        let angle = arc_cosines(from_fn(|i| -n[i] * next[i]));
        let k = TAU - angle[2] - angle[3];
        let solid_angle = angle[0] + angle[1] - k;
        (solid_angle > EXACT_ENOUGH).then_some(Seen {
            x,
            y,
            z,
            b: [n[0], n[2]],
            k,
            solid_angle,
        })
    }

    #[inline]
    pub fn sample(&self, p: Vec3, u: Vec2) -> Option<Incident> {
        if self.normal.dot(p - self.corner) <= 0.0 {
            return None;
        }
        let Some(seen) = self.seen(p) else {
            let (q, n) = self.point(u);
            return at_distance(p, q, n, 1.0 / self.area, EmitterPlace::Surface);
        };
        let (units, _) = self.rectangle?;
        let [x, y] = seen.place(u);
        let to = units[0] * x + units[1] * y + self.normal * seen.z;
        let distance = to.length();
        Some(Incident {
            dir: to / distance,
            distance,
            pdf: 1.0 / seen.solid_angle,
            place: EmitterPlace::Surface,
        })
    }

    #[inline]
    pub fn pdf(&self, p: Vec3, q: Vec3) -> f32 {
        if self.normal.dot(p - self.corner) <= 0.0 {
            return 0.0;
        }
        match self.seen(p) {
            Some(seen) => 1.0 / seen.solid_angle,
            None => solid_angle_density(p, q, self.normal, 1.0 / self.area),
        }
    }
}

impl Seen {
    /// Coordinates along the edges of a point uniform in solid angle.
    #[inline]
    fn place(&self, u: Vec2) -> [f32; 2] {
        let (sin, cos) = (u.x * self.solid_angle + self.k).sin_cos();
        let f = (cos * self.b[0] - self.b[1]) / sin;
        let c = (1.0 / (f * f + self.b[0] * self.b[0]).sqrt()).copysign(f);
        let c = c.clamp(-1.0, 1.0);
        let x = -(c * self.z) / (1.0 - c * c).max(1e-12).sqrt();
        let x = x.clamp(self.x[0], self.x[1]);
        // Nothing here is larger or smaller than what `seen` has squared.
        let d2 = x * x + self.z * self.z;
        let d = d2.sqrt();
        let h = self.y.map(|y| y / (d2 + y * y).sqrt());
        let h = h[0] + u.y * (h[1] - h[0]);
        let y = h * d / (1.0 - h * h).max(1e-12).sqrt();
        [x, y.clamp(self.y[0], self.y[1])]
    }
}
