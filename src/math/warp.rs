//! Warps from the unit square to the domains light is sampled on, each with its density.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, TAU};

/// Uniform on the unit disk, area preserving and without a seam (Shirley and Chiu 1997). Density 1/pi.
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let o = u * 2.0 - Vec2::ONE;
    if o == Vec2::ZERO {
        return Vec2::ZERO;
    }
    let (r, theta) = if o.x.abs() > o.y.abs() {
        (o.x, FRAC_PI_4 * (o.y / o.x))
    } else {
        (o.y, FRAC_PI_2 - FRAC_PI_4 * (o.x / o.y))
    };
    let (sin, cos) = theta.sin_cos();
    Vec2::new(r * cos, r * sin)
}

/// Cosine-distributed on the hemisphere around +z. Density [`cosine_hemisphere_pdf`].
#[inline]
pub fn cosine_hemisphere(u: Vec2) -> Vec3 {
    let d = concentric_disk(u);
    let z = (1.0 - d.length_squared()).max(0.0).sqrt();
    // A z of exactly 0 would have density 0: the smallest step keeps sample and pdf consistent.
    Vec3::new(d.x, d.y, z.max(1e-7))
}

/// Density of [`cosine_hemisphere`] in solid angle; 0 below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf(cos_theta: f32) -> f32 {
    cos_theta.max(0.0) * FRAC_1_PI
}

/// Uniform on the unit sphere. Density 1/(4 pi).
#[inline]
pub fn uniform_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Uniform in the cone of half-angle `acos(cos_max)` around +z, accurate for cones as narrow as
/// `1 - cos_max = 1e-7` because it works with `1 - cos`. Density [`uniform_cone_pdf`].
#[inline]
pub fn uniform_cone(u: Vec2, one_minus_cos_max: f32) -> Vec3 {
    let h = u.x * one_minus_cos_max;
    let r = (h * (2.0 - h)).max(0.0).sqrt();
    let (sin, cos) = (TAU * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, 1.0 - h)
}

/// Density of [`uniform_cone`] inside the cone.
#[inline]
pub fn uniform_cone_pdf(one_minus_cos_max: f32) -> f32 {
    1.0 / (TAU * one_minus_cos_max)
}

/// Uniform barycentric coordinates `(b1, b2)` on a triangle.
#[inline]
pub fn uniform_triangle(u: Vec2) -> Vec2 {
    let s = u.x.max(0.0).sqrt();
    Vec2::new(1.0 - s, u.y * s)
}
