//! A ray inside the unit cube, and the cells of a lattice that it passes (Amanatides and Woo, "A
//! Fast Voxel Traversal Algorithm for Ray Tracing", 1987).
//!
//! Everything is in double precision, and places along a ray are counted from where it enters the
//! cube: origins far away and grids of any size cost no digits that `f32` coordinates have.

use crate::math::{DAffine3, DVec3, Vec3};

/// What of a ray lies in the unit cube of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Where it begins, in the unit cube.
    origin: DVec3,
    /// By how much it moves per unit of length of the scene.
    direction: DVec3,
    /// Length before it, in the scene.
    pub start: f64,
    /// Length of it, in the scene; finite.
    pub length: f64,
}

impl Span {
    /// The part of the ray from `org` along `dir` (a unit vector), up to `distance` (may be
    /// infinite), in the unit cube that `to_grid` leads to. `None` where there is none, or a number
    /// is not finite.
    pub fn new(to_grid: &DAffine3, org: Vec3, dir: Vec3, distance: f32) -> Option<Self> {
        let origin = to_grid.transform_point3(org.as_dvec3());
        let direction = to_grid.transform_vector3(dir.as_dvec3());
        if !(origin.is_finite() && direction.is_finite() && distance > 0.0) {
            return None;
        }
        let (mut enter, mut leave) = (0.0f64, f64::from(distance));
        for axis in 0..3 {
            let (o, d) = (origin[axis], direction[axis]);
            if d == 0.0 {
                // Along the faces: the planes of this axis are never met.
                if !(0.0..=1.0).contains(&o) {
                    return None;
                }
                continue;
            }
            let (a, b) = (-o / d, (1.0 - o) / d);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        if !(enter < leave && leave.is_finite()) {
            return None;
        }
        Some(Self {
            origin: (origin + direction * enter).clamp(DVec3::ZERO, DVec3::ONE),
            direction,
            start: enter,
            length: leave - enter,
        })
    }

    /// The point at length `t` after its beginning, in the unit cube up to rounding.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }

    /// By how much a stretch of length `t` moves in the unit cube.
    #[inline]
    pub fn moved(&self, t: f64) -> DVec3 {
        self.direction * t
    }
}

/// Cells between equally spaced planes: `p * scale + offset` counts them from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lattice {
    /// Cells along the axes, none 0.
    pub cells: [u32; 3],
    /// Cells per unit of length.
    pub scale: DVec3,
    /// Number of the cell, with its fraction, where the cube begins.
    pub offset: f64,
}

/// A cell that a ray passes, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Step {
    /// The cell.
    pub cell: [i64; 3],
    /// Length along the span where the ray comes in.
    pub from: f64,
    /// Length where it leaves; not below `from`.
    pub to: f64,
}

/// The cells of a stretch of a span, in the order of passing: without gaps, and never more than
/// there are planes in its way, and one.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    cell: [i64; 3],
    last: [i64; 3],
    origin: DVec3,
    direction: DVec3,
    /// Length at the next plane of each axis; infinite where none comes.
    planes: [f64; 3],
    at: f64,
    end: f64,
    is_over: bool,
}

impl Walk {
    /// The cells between the lengths `from` and `to` of `span`.
    #[inline]
    pub fn new(span: &Span, lattice: &Lattice, from: f64, to: f64) -> Self {
        let origin = span.origin * lattice.scale + lattice.offset;
        let direction = span.direction * lattice.scale;
        let begin = origin + direction * from;
        let last = lattice.cells.map(|n| i64::from(n) - 1);
        let cell = [0, 1, 2].map(|axis| (begin[axis].floor() as i64).clamp(0, last[axis]));
        let mut walk = Self {
            cell,
            last,
            origin,
            direction,
            planes: [f64::INFINITY; 3],
            at: from,
            end: to,
            is_over: from >= to,
        };
        for axis in 0..3 {
            walk.planes[axis] = walk.next_plane(axis);
        }
        walk
    }

    /// Length at the plane where the cell at hand ends along an axis. The outermost cells have no
    /// end: no rounding leads out of the lattice.
    #[inline]
    fn next_plane(&self, axis: usize) -> f64 {
        let (cell, d) = (self.cell[axis], self.direction[axis]);
        if d > 0.0 && cell < self.last[axis] {
            ((cell + 1) as f64 - self.origin[axis]) / d
        } else if d < 0.0 && cell > 0 {
            (cell as f64 - self.origin[axis]) / d
        } else {
            f64::INFINITY
        }
    }
}

impl Iterator for Walk {
    type Item = Step;

    #[inline]
    fn next(&mut self) -> Option<Step> {
        if self.is_over {
            return None;
        }
        let [x, y, z] = self.planes;
        let axis = if x <= y && x <= z {
            0
        } else if y <= z {
            1
        } else {
            2
        };
        let plane = self.planes[axis];
        let (cell, from) = (self.cell, self.at);
        self.is_over = plane >= self.end;
        // Rounding may put a plane before the beginning.
        self.at = plane.max(from).min(self.end);
        if !self.is_over {
            self.cell[axis] += if self.direction[axis] > 0.0 { 1 } else { -1 };
            self.planes[axis] = self.next_plane(axis);
        }
        Some(Step {
            cell,
            from,
            to: self.at,
        })
    }
}
