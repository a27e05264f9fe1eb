//! An equal-area map between the unit square and the whole sphere, without poles, and the quadtree
//! of direction cells that it carries.
//!
//! The map is the octahedral one of Clarberg ("Fast Equal-Area Mapping of the (Hemi)Sphere using
//! SIMD", JGT 2008): the upper hemisphere fills the inner diamond of the square, the lower one is
//! folded out into the corners. Equal areas in the square are equal solid angles, so the quadtree
//! cell of level `l` covers exactly 4 pi / 4^l steradians and a uniform direction inside it costs
//! two random numbers. Nowhere is it singular: no pole where cells degenerate, no azimuth that
//! wraps.

use super::special::quarter_turn;
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_PI_4, PI};

/// Levels that a direction code resolves: 16 bits an axis.
pub const CODE_LEVELS: u8 = 16;

/// The unit direction for a point of the unit square. Density 1/(4 pi) for uniform points.
#[inline]
pub fn square_to_sphere(p: Vec2) -> Vec3 {
    let u = 2.0 * p.x - 1.0;
    let v = 2.0 * p.y - 1.0;
    let (au, av) = (u.abs(), v.abs());
    let d = 1.0 - (au + av);
    let r = 1.0 - d.abs();
    let phi = if r == 0.0 {
        FRAC_PI_4
    } else {
        ((av - au) / r + 1.0) * FRAC_PI_4
    };
    let (sin, cos) = phi.sin_cos();
    let z = (1.0 - r * r).copysign(d);
    let h = r * (2.0 - r * r).max(0.0).sqrt();
    Vec3::new((cos * h).copysign(u), (sin * h).copysign(v), z)
}

/// The point of the unit square for a unit direction: the inverse of [`square_to_sphere`].
#[inline]
pub fn sphere_to_square(w: Vec3) -> Vec2 {
    let (x, y, z) = (w.x.abs(), w.y.abs(), w.z.abs());
    // 1 - |z| without the cancellation near the z axis.
    let r = ((x * x + y * y) / (1.0 + z)).min(1.0).sqrt();
    let phi = if x == 0.0 && y == 0.0 {
        0.5
    } else {
        quarter_turn(x, y)
    };
    let v = phi * r;
    let u = r - v;
    let (u, v) = if w.z < 0.0 {
        (1.0 - v, 1.0 - u)
    } else {
        (u, v)
    };
    let p = Vec2::new(u.copysign(w.x), v.copysign(w.y)) * 0.5 + 0.5;
    p.clamp(Vec2::ZERO, Vec2::ONE)
}

/// The unit vector along `v` even where its square would overflow or underflow; `None` for a zero
/// or non-finite vector.
#[inline]
pub fn unit(v: Vec3) -> Option<Vec3> {
    let m = v.abs().max_element();
    if !(v.is_finite() && m > 0.0) {
        return None;
    }
    // Two steps: 1/m overflows for denormal m.
    let s = if m < 1e-30 {
        (v * 1e30) / (m * 1e30)
    } else {
        v / m
    };
    Some(s.normalize())
}

/// The Morton code of the finest cell that holds the unit direction `w`; its upper `2 l` bits name
/// the cell of level `l`.
#[inline]
pub fn direction_code(w: Vec3) -> u32 {
    let p = sphere_to_square(w) * 65536.0;
    // The cast saturates and turns NaN into 0.
    let x = (p.x as u32).min(65535);
    let y = (p.y as u32).min(65535);
    spread(x) | (spread(y) << 1)
}

#[inline]
fn spread(mut x: u32) -> u32 {
    x = (x | (x << 8)) & 0x00ff_00ff;
    x = (x | (x << 4)) & 0x0f0f_0f0f;
    x = (x | (x << 2)) & 0x3333_3333;
    (x | (x << 1)) & 0x5555_5555
}

#[inline]
fn squeeze(mut x: u32) -> u32 {
    x &= 0x5555_5555;
    x = (x | (x >> 1)) & 0x3333_3333;
    x = (x | (x >> 2)) & 0x0f0f_0f0f;
    x = (x | (x >> 4)) & 0x00ff_00ff;
    (x | (x >> 8)) & 0xffff
}

/// A cell of the direction quadtree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct DirectionCell {
    /// Its first direction code; the bits below its level are zero.
    start: u32,
    /// 0 for the whole sphere, at most [`CODE_LEVELS`].
    level: u8,
}

impl DirectionCell {
    /// The whole sphere.
    pub const SPHERE: Self = Self { start: 0, level: 0 };

    /// The cell of level `level` (at most [`CODE_LEVELS`]) that holds the direction code `code`.
    #[inline]
    pub fn containing(code: u32, level: u8) -> Self {
        let level = level.min(CODE_LEVELS);
        let low = (1u64 << (2 * u32::from(CODE_LEVELS - level))) - 1;
        Self {
            start: code & !(low as u32),
            level,
        }
    }

    /// Its depth in the quadtree.
    #[inline]
    pub fn level(self) -> u8 {
        self.level
    }

    /// Its smallest direction code.
    #[inline]
    pub fn start(self) -> u32 {
        self.start
    }

    /// The quadrant `i` (0 to 3) of this cell.
    #[inline]
    pub fn child(self, i: u32) -> Self {
        debug_assert!(self.level < CODE_LEVELS && i < 4);
        let level = self.level + 1;
        Self {
            start: self.start | (i << (2 * u32::from(CODE_LEVELS - level))),
            level,
        }
    }

    /// Whether the direction code lies inside.
    #[inline]
    pub fn contains(self, code: u32) -> bool {
        Self::containing(code, self.level).start == self.start
    }

    /// Its solid angle in steradians, 4 pi / 4^level.
    #[inline]
    pub fn solid_angle(self) -> f32 {
        4.0 * PI / self.inverse_share()
    }

    /// Density of the uniform distribution on the cell, 4^level / (4 pi).
    #[inline]
    pub fn uniform_pdf(self) -> f32 {
        self.inverse_share() / (4.0 * PI)
    }

    #[inline]
    fn inverse_share(self) -> f32 {
        (1u64 << (2 * u32::from(self.level))) as f32
    }

    /// The direction at the point `u` of the cell, `u` in the unit square: uniform for uniform `u`.
    #[inline]
    pub fn direction(self, u: Vec2) -> Vec3 {
        let corner = Vec2::new(squeeze(self.start) as f32, squeeze(self.start >> 1) as f32);
        let side = (1u32 << (CODE_LEVELS - self.level)) as f32;
        square_to_sphere((corner + u * side) * (1.0 / 65536.0))
    }

    /// A unit direction in the middle and the largest chord from it to any direction of the cell
    /// (an upper bound, 2 for the whole sphere).
    pub fn cap(self) -> (Vec3, f32) {
        let centre = self.direction(Vec2::splat(0.5));
        if self.level == 0 {
            return (centre, 2.0);
        }
        // Corners, edges and a 16x16 inside; between two lattice points a direction moves by less
        // than 2 pi sqrt(2) / 2^level / 16 (the map stretches lengths by at most pi), so half of it
        // is the slack.
        const N: u32 = 16;
        let mut radius = 0f32;
        for i in 0..=N {
            for j in 0..=N {
                let p = self.direction(Vec2::new(i as f32, j as f32) / N as f32);
                radius = radius.max(p.distance(centre));
            }
        }
        let step = PI * std::f32::consts::SQRT_2 / (1u32 << self.level) as f32 / N as f32;
        (centre, (radius + step).min(2.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    fn round_trip(w: Vec3) {
        let back = square_to_sphere(sphere_to_square(w));
        assert!((back - w).length() <= 2e-6, "{w:?} -> {back:?}");
        assert!((back.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn every_direction_survives_the_round_trip() {
        let mut rng = Pcg32::new(3, 1);
        for _ in 0..1_000_000 {
            let u = Vec2::new(rng.next_f32(), rng.next_f32());
            round_trip(crate::math::warp::uniform_sphere(u));
        }
        for s in [1.0f32, -1.0] {
            for t in [0.0f32, -0.0, 1e-7, -1e-7, 1e-20, 1e-3] {
                for w in [
                    Vec3::new(s, t, t),
                    Vec3::new(t, s, -t),
                    Vec3::new(t, t, s),
                    Vec3::new(t, -t, s),
                    Vec3::new(s, s, t),
                ] {
                    round_trip(unit(w).unwrap());
                }
            }
        }
        for scale in [1e-38f32, 1e-42, 1e-20, 1.0, 1e20, 1e38] {
            let w = unit(Vec3::new(0.3, -0.9, 0.2) * scale).unwrap();
            assert!((w.length() - 1.0).abs() < 1e-6);
            round_trip(w);
        }
        assert!(unit(Vec3::ZERO).is_none() && unit(Vec3::NAN).is_none());
        assert!(unit(Vec3::new(f32::INFINITY, 0.0, 0.0)).is_none());
    }

    /// The area of each cell by integrating the spherical polygon of a fine outline (Girard).
    #[test]
    fn cells_cover_equal_areas_that_sum_to_the_sphere() {
        let mut sum = 0f64;
        for i in 0..64u32 {
            let cell = DirectionCell::containing(i << 26, 3);
            sum += f64::from(cell.solid_angle());
            let area = outline_area(cell);
            let expected = f64::from(cell.solid_angle());
            assert!((area / expected - 1.0).abs() < 2e-4, "{i} {area}");
        }
        assert!((sum - 4.0 * std::f64::consts::PI).abs() < 1e-6);
    }

    fn outline_area(cell: DirectionCell) -> f64 {
        const N: usize = 64;
        let mut area = 0f64;
        for i in 0..N {
            for j in 0..N {
                let at = |a: usize, b: usize| {
                    cell.direction(Vec2::new(a as f32, b as f32) / N as f32)
                        .as_dvec3()
                };
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                for (p, q, r) in [(a, b, c), (a, c, d)] {
                    let num = p.dot(q.cross(r)).abs();
                    area += 2.0 * num.atan2(1.0 + p.dot(q) + q.dot(r) + r.dot(p));
                }
            }
        }
        area
    }

    #[test]
    fn cells_hold_their_own_directions_and_caps_bound_them() {
        let mut rng = Pcg32::new(4, 1);
        for level in 1..=10u8 {
            let mut stray = 0;
            for _ in 0..2000 {
                let cell = DirectionCell::containing(rng.next_u32(), level);
                let w = cell.direction(Vec2::new(rng.next_f32(), rng.next_f32()));
                let (centre, radius) = cell.cap();
                assert!(w.distance(centre) <= radius);
                stray += u32::from(!cell.contains(direction_code(w)));
            }
            // Only rounding at an edge of a small cell may carry a direction over.
            assert!(stray <= 10, "level {level}: {stray}");
        }
        for i in 0..4 {
            let c = DirectionCell::SPHERE.child(2).child(i);
            assert!(DirectionCell::SPHERE.child(2).contains(c.start()));
        }
    }
}
