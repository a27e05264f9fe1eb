//! Spheres on spheres: each carries nine, a third as large.
//!
//! All spheres of a level together have the area of the first, so each level gets the same number
//! of triangles and all triangles are about of one size.

use crate::math::DVec3;
use glam::DMat3;
use std::f64::consts::{FRAC_PI_3, PI};

/// Spheres that each one carries.
const CHILDREN: u64 = 9;
/// Fewest rings of a sphere.
const FEWEST_RINGS: u64 = 5;
/// Height of the three upper children above their parent's equator, radians.
const UPPER: f64 = 0.96;

/// A flake of several levels.
#[derive(Clone, Debug)]
pub struct Flake {
    levels: Vec<Level>,
}

/// Spheres of one size.
#[derive(Clone, Copy, Debug)]
struct Level {
    /// Bands of triangles from pole to pole; there are twice as many around.
    rings: u64,
    /// Spheres.
    spheres: u64,
    /// Vertices and triangles of the levels before.
    before: (u64, u64),
}

impl Level {
    fn sphere_vertices(&self) -> u64 {
        2 + (self.rings - 1) * 2 * self.rings
    }

    fn sphere_triangles(&self) -> u64 {
        4 * self.rings * (self.rings - 1)
    }
}

/// Levels of a flake of that many triangles.
#[cfg(test)]
pub fn levels(triangles: u64) -> usize {
    Flake::new(triangles).levels.len()
}

/// Rings of the spheres on level `level` if those of the first have `first`.
fn rings_on(first: u64, level: u32) -> u64 {
    (first as f64 / 3f64.powi(level as i32)).round() as u64
}

impl Flake {
    /// Of about that many triangles.
    pub fn new(triangles: u64) -> Self {
        let mut best = Self::with(FEWEST_RINGS, 1);
        for count in 1.. {
            let first = (triangles as f64 / (4.0 * f64::from(count))).sqrt() as u64;
            // A level of coarse spheres has fewer triangles than its share: the first makes up for
            // it.
            let fit = (first..=first + first / 4 + 1)
                .take_while(|&f| Self::with(f.max(FEWEST_RINGS), count).triangles() <= triangles)
                .last();
            let first = fit.unwrap_or(first);
            if rings_on(first, count - 1) < FEWEST_RINGS {
                return best;
            }
            best = Self::with(first, count);
        }
        best
    }

    fn with(first: u64, count: u32) -> Self {
        let mut levels = Vec::new();
        let mut before = (0, 0);
        for level in 0..count {
            let level = Level {
                rings: rings_on(first, level).max(2),
                spheres: CHILDREN.pow(level),
                before,
            };
            before.0 += level.spheres * level.sphere_vertices();
            before.1 += level.spheres * level.sphere_triangles();
            levels.push(level);
        }
        Self { levels }
    }

    fn last(&self) -> &Level {
        &self.levels[self.levels.len() - 1]
    }

    pub fn vertices(&self) -> u64 {
        let last = self.last();
        last.before.0 + last.spheres * last.sphere_vertices()
    }

    pub fn triangles(&self) -> u64 {
        let last = self.last();
        last.before.1 + last.spheres * last.sphere_triangles()
    }

    pub fn vertex(&self, i: u64) -> DVec3 {
        let at = self.levels.partition_point(|l| l.before.0 <= i) - 1;
        let level = &self.levels[at];
        let i = i - level.before.0;
        let (sphere, i) = (i / level.sphere_vertices(), i % level.sphere_vertices());
        let (center, axes, radius) = place(sphere, at);
        center + axes * on_sphere(level.rings, i) * radius
    }

    pub fn triangle(&self, i: u64) -> [u64; 3] {
        let at = self.levels.partition_point(|l| l.before.1 <= i) - 1;
        let level = &self.levels[at];
        let i = i - level.before.1;
        let (sphere, i) = (i / level.sphere_triangles(), i % level.sphere_triangles());
        let first = level.before.0 + sphere * level.sphere_vertices();
        on_grid(level.rings, i).map(|v| first + v)
    }
}

/// Vertex `i` of the unit sphere: the poles, then the rings from the upper one down.
fn on_sphere(rings: u64, i: u64) -> DVec3 {
    if i < 2 {
        return if i == 0 { DVec3::Y } else { DVec3::NEG_Y };
    }
    let (ring, side) = ((i - 2) / (2 * rings), (i - 2) % (2 * rings));
    let (sin, cos) = (PI * (ring + 1) as f64 / rings as f64).sin_cos();
    let (sin_a, cos_a) = (PI * side as f64 / rings as f64).sin_cos();
    DVec3::new(sin * cos_a, cos, sin * sin_a)
}

/// Triangle `i` of a sphere.
fn on_grid(rings: u64, i: u64) -> [u64; 3] {
    let around = 2 * rings;
    let at = |ring: u64, side: u64| 2 + ring * around + side % around;
    if i < around {
        return [0, at(0, i + 1), at(0, i)];
    }
    if i < 2 * around {
        let side = i - around;
        return [1, at(rings - 2, side), at(rings - 2, side + 1)];
    }
    let quad = (i - 2 * around) / 2;
    let (ring, side) = (quad / around, quad % around);
    let corners = [
        at(ring, side),
        at(ring, side + 1),
        at(ring + 1, side),
        at(ring + 1, side + 1),
    ];
    super::half_quad(corners, i % 2 == 1)
}

/// Centre, axes and radius of a sphere: its number's digits to the base nine are the way to it.
fn place(sphere: u64, level: usize) -> (DVec3, DMat3, f64) {
    let (mut center, mut axes, mut radius) = (DVec3::ZERO, DMat3::IDENTITY, 1.0);
    for digit in (0..level as u32).rev() {
        let child = sphere / CHILDREN.pow(digit) % CHILDREN;
        let (angle, height) = match child {
            0..=5 => (child as f64 * FRAC_PI_3, 0.0),
            _ => ((child as f64 * 2.0 + 0.5) * FRAC_PI_3, UPPER),
        };
        let ((sin_a, cos_a), (sin_h, cos_h)) = (angle.sin_cos(), height.sin_cos());
        let up = DVec3::new(cos_a * cos_h, sin_h, sin_a * cos_h);
        let side = DVec3::new(-sin_a, 0.0, cos_a);
        center += axes * up * (radius * 4.0 / 3.0);
        axes *= DMat3::from_cols(up.cross(side), up, side);
        radius /= 3.0;
    }
    (center, axes, radius)
}
