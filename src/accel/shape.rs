//! Exact shapes: a unit shape and the affine map that places it.
//!
//! A ray is carried into the unit shape's space without renormalising its direction, so a distance
//! found there is a distance along the original ray. The arithmetic is `f64`, and the origin is
//! taken relative to the shape's centre *before* it is transformed: a sphere of radius 1 seen from
//! 1e5 away, or standing 1e5 from the origin, loses nothing that the `f32` input had.

use super::Bounds;
use crate::math::{Affine3A, DVec3, Vec3, Vec3A};
use std::f64::consts::{PI, TAU};

/// Which unit shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnalyticKind {
    /// The sphere of radius 1 around the origin; u = longitude / 2 pi from +x, v = polar angle from
    /// +z / pi.
    Sphere,
    /// The disk of radius 1 in z = 0, normal +z; u = radius, v = angle / 2 pi from +x.
    Disk,
    /// The open cylinder of radius 1 from z = 0 to z = 1; u = angle / 2 pi, v = z.
    Cylinder,
    /// The square `[-1, 1]^2` in z = 0, normal +z; u = (x + 1) / 2, v = (y + 1) / 2.
    Rectangle,
}

impl AnalyticKind {
    fn is_flat(self) -> bool {
        matches!(self, Self::Disk | Self::Rectangle)
    }
}

/// A unit shape placed by an affine map.
#[derive(Clone, Copy, Debug)]
pub struct AnalyticShape {
    /// Which unit shape.
    pub kind: AnalyticKind,
    /// Unit space to world (or group) space.
    pub to_world: Affine3A,
    /// Its inverse.
    pub to_object: Affine3A,
}

impl AnalyticShape {
    /// Places a unit shape.
    ///
    /// A flat shape does not use its z axis: where that is scaled to nothing (a rectangle with
    /// `scale 2 3 0`), the axis is replaced by the normal, so that the map can be inverted.
    /// A shape that is degenerate otherwise is never hit.
    pub fn new(kind: AnalyticKind, to_world: Affine3A) -> Self {
        let mut to_world = to_world;
        if kind.is_flat() && to_world.matrix3.determinant() == 0.0 {
            let m = &mut to_world.matrix3;
            m.z_axis = m.x_axis.cross(m.y_axis).normalize_or_zero();
        }
        Self {
            kind,
            to_world,
            to_object: to_world.inverse(),
        }
    }

    /// Bounds in world (or group) space: tight, up to a few units in the last place.
    pub fn bounds(&self) -> Bounds {
        let m = &self.to_world.matrix3;
        let center = self.to_world.translation;
        // The extent of a disk or sphere along an axis is the length of the map's row.
        let round = |a: Vec3A, b: Vec3A, c: Vec3A| {
            let square = a * a + b * b + c * c;
            Vec3A::new(square.x.sqrt(), square.y.sqrt(), square.z.sqrt())
        };
        let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
        match self.kind {
            AnalyticKind::Sphere => around(center, round(x, y, z)),
            AnalyticKind::Disk => around(center, round(x, y, Vec3A::ZERO)),
            AnalyticKind::Rectangle => around(center, x.abs() + y.abs()),
            AnalyticKind::Cylinder => {
                let ring = round(x, y, Vec3A::ZERO);
                around(center, ring).union(around(center + z, ring))
            }
        }
    }

    /// The nearest crossing of the line `org + t * dir` with `t` in `[tmin, tmax]`: `(t, u, v)`.
    ///
    /// `dir` need not be of unit length; `t` counts in its lengths.
    #[inline]
    pub fn intersect(&self, org: Vec3, dir: Vec3, tmin: f32, tmax: f32) -> Option<(f32, f32, f32)> {
        if self.kind.is_flat() {
            return self.intersect_flat(org, dir, (tmin, tmax));
        }
        let nearest = self.crossings(org, dir, tmin, tmax).next()?;
        Some((nearest.t, nearest.u, nearest.v))
    }

    /// The same for flat shapes, to the same bits: most rays that a ray tracer asks about meet the
    /// plane out of their range, which the third coordinate alone tells.
    #[inline]
    fn intersect_flat(
        &self,
        org: Vec3,
        dir: Vec3,
        (tmin, tmax): (f32, f32),
    ) -> Option<(f32, f32, f32)> {
        let (o, d) = (self.relative_to_center(org), dir.as_dvec3());
        let t = -self.along(2, o) / self.along(2, d);
        let distance = t as f32;
        if !(distance >= tmin && distance <= tmax) {
            return None;
        }
        let at = |axis: usize| self.along(axis, o) + self.along(axis, d) * t;
        let p = DVec3::new(at(0), at(1), 0.0);
        let (u, v) = covers(self.kind, p).then(|| coordinates(self.kind, p))?;
        Some((distance, u as f32, v as f32))
    }

    /// All crossings of that line, the nearest first: curved shapes have two walls.
    #[inline]
    pub fn crossings(
        &self,
        org: Vec3,
        dir: Vec3,
        tmin: f32,
        tmax: f32,
    ) -> impl Iterator<Item = Crossing> + use<> {
        let (kind, o, d) = (self.kind, self.unit_place(org), self.turned(dir));
        let accept = move |t: f64| {
            let t = t as f32;
            t >= tmin && t <= tmax
        };
        roots(kind, o, d)
            .into_iter()
            .enumerate()
            .map(move |(wall, t)| (wall as u32, t, o + d * t))
            .filter(move |&(_, t, p)| accept(t) && covers(kind, p))
            .map(move |(wall, t, p)| {
                let (u, v) = coordinates(kind, p);
                Crossing {
                    t: t as f32,
                    u: u as f32,
                    v: v as f32,
                    wall,
                }
            })
    }

    /// A place in unit space, relative to the shape's centre before it is transformed.
    #[inline]
    fn unit_place(&self, p: Vec3) -> DVec3 {
        self.map(self.relative_to_center(p))
    }

    #[inline]
    fn relative_to_center(&self, p: Vec3) -> DVec3 {
        p.as_dvec3() - Vec3::from(self.to_world.translation).as_dvec3()
    }

    #[inline]
    fn turned(&self, dir: Vec3) -> DVec3 {
        self.map(dir.as_dvec3())
    }

    #[inline]
    fn map(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.along(0, v), self.along(1, v), self.along(2, v))
    }

    /// One coordinate in unit space of a vector.
    #[inline]
    fn along(&self, axis: usize, v: DVec3) -> f64 {
        let m = &self.to_object.matrix3;
        let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis].map(|c| f64::from(c[axis]));
        x * v.x + y * v.y + z * v.z
    }
}

/// Where a line crosses an exact shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Distance in lengths of the direction.
    pub t: f32,
    /// First surface coordinate.
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
    /// 0 for the wall that the line comes to first, wherever on it a ray begins; 1 for the other.
    pub wall: u32,
}

/// Where a line in unit space meets the shape's infinite surface, the nearest first; not a number
/// where it does not.
#[inline]
fn roots(kind: AnalyticKind, o: DVec3, d: DVec3) -> [f64; 2] {
    match kind {
        AnalyticKind::Sphere => round_roots(o, d, o.dot(d), d.length_squared()),
        AnalyticKind::Cylinder => {
            let (o2, d2) = (o.with_z(0.0), d.with_z(0.0));
            round_roots(o2, d2, o2.dot(d2), d2.length_squared())
        }
        AnalyticKind::Disk | AnalyticKind::Rectangle => [-o.z / d.z, f64::NAN],
    }
}

/// Whether a point on the shape's infinite surface belongs to the shape.
#[inline]
fn covers(kind: AnalyticKind, p: DVec3) -> bool {
    match kind {
        AnalyticKind::Sphere => true,
        AnalyticKind::Disk => p.truncate().length_squared() <= 1.0,
        AnalyticKind::Cylinder => (0.0..=1.0).contains(&p.z),
        AnalyticKind::Rectangle => p.x.abs() <= 1.0 && p.y.abs() <= 1.0,
    }
}

/// The surface coordinates of a point in unit space.
#[inline]
fn coordinates(kind: AnalyticKind, p: DVec3) -> (f64, f64) {
    match kind {
        AnalyticKind::Sphere => (turn(p), p.truncate().length().atan2(p.z) / PI),
        AnalyticKind::Disk => (p.truncate().length(), turn(p)),
        AnalyticKind::Cylinder => (turn(p), p.z.clamp(0.0, 1.0)),
        AnalyticKind::Rectangle => (0.5 * (p.x + 1.0), 0.5 * (p.y + 1.0)),
    }
}

/// Both parameters at which `o + t d` is at distance 1 from the origin, the smaller first.
///
/// The discriminant is 1 - |l|^2, l the point of the line closest to the origin: the textbook's
/// b^2 - 4ac subtracts numbers that grow with the square of the distance (Haines et al., "Precision
/// Improvements for Ray/Sphere Intersection", Ray Tracing Gems 2019). The smaller root in magnitude
/// comes from the product of the roots, c / q, which subtracts nothing.
fn round_roots(o: DVec3, d: DVec3, od: f64, dd: f64) -> [f64; 2] {
    let closest = o - d * (od / dd);
    let discriminant = 1.0 - closest.length_squared();
    // Written so that a NaN (a zero direction, a degenerate map) is a miss.
    if !(discriminant >= 0.0 && dd > 0.0) {
        return [f64::NAN; 2];
    }
    let q = -od - (dd * discriminant).sqrt().copysign(od);
    let c = o.length_squared() - 1.0;
    let (far, near) = (q / dd, if q == 0.0 { 0.0 } else { c / q });
    if far < near { [far, near] } else { [near, far] }
}

/// Angle of `p` around z from +x, as a fraction of a turn in `[0, 1)`.
fn turn(p: DVec3) -> f64 {
    let angle = p.y.atan2(p.x) / TAU;
    if angle < 0.0 { angle + 1.0 } else { angle }
}

/// The box of half-size `extent` around `center`, grown by the rounding error of its computation.
fn around(center: Vec3A, extent: Vec3A) -> Bounds {
    let pad = (extent + center.abs()) * (4.0 * f32::EPSILON);
    Bounds {
        min: (center - extent - pad).into(),
        max: (center + extent + pad).into(),
    }
}
