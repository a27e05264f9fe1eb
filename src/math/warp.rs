//! Warps from the unit square to the domains light is sampled on, each with its density.

use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// Uniform on the unit disk, area preserving and without a seam (Shirley and Chiu 1997). Density
/// 1/pi.
#[inline]
pub fn concentric_disk(u: Vec2) -> Vec2 {
    let o = u * 2.0 - Vec2::ONE;
    let steep = o.x.abs() <= o.y.abs();
    let (major, minor) = if steep { (o.y, o.x) } else { (o.x, o.y) };
    if major == 0.0 {
        return Vec2::ZERO;
    }
    let (sin, cos) = sin_cos_octant(FRAC_PI_4 * (minor / major));
    let (along, across) = (major * cos, major * sin);
    // In the steep half the angle is pi/2 minus this one: sine and cosine change places.
    if steep {
        Vec2::new(across, along)
    } else {
        Vec2::new(along, across)
    }
}

/// Sine and cosine of `|x| <= pi/4` to 1e-7, by the polynomials of Moshier's Cephes library
/// (`sinf`, `cosf`): a third of the cost of the general functions, in the renderer's innermost
/// loop.
#[inline]
fn sin_cos_octant(x: f32) -> (f32, f32) {
    let z = x * x;
    let sin = ((-1.951_529_6e-4 * z + 8.332_161e-3) * z - 1.666_665_5e-1) * z * x + x;
    let cos = ((2.443_315_7e-5 * z - 1.388_731_6e-3) * z + 4.166_664_6e-2) * z * z - 0.5 * z + 1.0;
    (sin, cos)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    #[test]
    fn octant_sine_and_cosine_are_exact_to_a_rounding() {
        for i in -1000..=1000 {
            let x = FRAC_PI_4 * i as f32 / 1000.0;
            let (sin, cos) = sin_cos_octant(x);
            assert!((f64::from(sin) - f64::from(x).sin()).abs() < 1e-7, "{x}");
            assert!((f64::from(cos) - f64::from(x).cos()).abs() < 1e-7, "{x}");
        }
    }

    /// Moments of the cosine hemisphere: E[z] = 2/3, E[z^2] = 1/2, E[x^2] = 1/4, E[x] = 0.
    #[test]
    fn cosine_hemisphere_has_the_right_moments() {
        let mut rng = Pcg32::new(3, 4);
        let (mut z, mut zz, mut xx, mut x) = (0.0, 0.0, 0.0, 0.0);
        let n = 1_000_000;
        for _ in 0..n {
            let v = cosine_hemisphere(Vec2::new(rng.next_f32(), rng.next_f32()));
            assert!((v.length() - 1.0).abs() < 1e-5);
            z += f64::from(v.z);
            zz += f64::from(v.z * v.z);
            xx += f64::from(v.x * v.x);
            x += f64::from(v.x);
        }
        let n = f64::from(n);
        // Standard errors are below 5e-4; 1 % of 2/3 is fourteen of them.
        assert!((z / n - 2.0 / 3.0).abs() < 2e-3 && (zz / n - 0.5).abs() < 2e-3);
        assert!((xx / n - 0.25).abs() < 2e-3 && (x / n).abs() < 3e-3);
    }

    /// Equal areas of the unit square land on equal areas of the disk: 8 x 8 rings and sectors.
    #[test]
    fn concentric_disk_is_uniform() {
        let mut rng = Pcg32::new(5, 6);
        let mut counts = [0f64; 64];
        let n = 640_000;
        for _ in 0..n {
            let d = concentric_disk(Vec2::new(rng.next_f32(), rng.next_f32()));
            let ring = ((d.length_squared() * 8.0) as usize).min(7);
            let sector = (((d.y.atan2(d.x) / TAU + 0.5) * 8.0) as usize).min(7);
            counts[ring * 8 + sector] += 1.0;
        }
        let expected = f64::from(n) / 64.0;
        let chi2: f64 = counts
            .iter()
            .map(|c| (c - expected).powi(2) / expected)
            .sum();
        // 63 degrees of freedom: 1 % of uniform samples exceed 92.
        assert!(chi2 < 92.0, "{chi2}");
    }
}
