//! The hemisphere as a square: Shirley and Chiu's concentric map from the square to the disk
//! (1997), then Lambert's from the disk to the hemisphere. Both keep areas.

use crate::math::warp::concentric_disk;
use crate::math::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Solid-angle density of a density of 1 over the square.
pub const DENSITY: f32 = 1.0 / TAU;

/// The direction (z up) of a point of the unit square.
#[inline]
pub fn to_hemisphere(u: Vec2) -> Vec3 {
    let p = concentric_disk(u);
    let r2 = p.length_squared().min(1.0);
    let xy = p * (2.0 - r2).sqrt();
    Vec3::new(xy.x, xy.y, 1.0 - r2)
}

/// The point of the unit square of a direction; `None` below the horizon.
#[inline]
pub fn to_square(d: Vec3) -> Option<Vec2> {
    if d.z.is_nan() || d.z < 0.0 {
        return None;
    }
    let p = Vec2::new(d.x, d.y) / (1.0 + d.z).sqrt();
    let r = p.length();
    let (near, far) = (p.x.abs().max(p.y.abs()), p.x.abs().min(p.y.abs()));
    if near <= 0.0 {
        return Some(Vec2::splat(0.5));
    }
    let along = r * (4.0 * FRAC_1_PI) * arc_tangent(far / near);
    let o = if p.x.abs() > p.y.abs() {
        Vec2::new(r.copysign(p.x), along.copysign(p.y))
    } else {
        Vec2::new(along.copysign(p.x), r.copysign(p.y))
    };
    Some(((o + 1.0) * 0.5).clamp(Vec2::ZERO, Vec2::ONE))
}

/// The angle whose tangent is `t`, in [0, 1].
#[inline]
fn arc_tangent(t: f32) -> f32 {
    crate::math::special::quarter_turn(1.0, t) * std::f32::consts::FRAC_PI_2
}
