//! Films of angles: the sphere and the fisheye.

use crate::math::DVec3;
use std::f64::consts::{PI, TAU};

/// Where a point of such a film looks.
pub(super) struct Look {
    /// Direction in camera space, of unit length.
    pub dir: DVec3,
    /// Solid angle over area on the film, both measured by angles.
    pub area: f64,
}

/// The direction of longitude `phi` from the left edge and latitude `theta` from the top: Mitsuba
/// 0.6's `spherical`.
#[inline]
pub(super) fn on_sphere(phi: f64, theta: f64) -> Option<Look> {
    let ((sin_phi, cos_phi), (sin_theta, cos_theta)) = (phi.sin_cos(), theta.sin_cos());
    Some(Look {
        dir: DVec3::new(sin_phi * sin_theta, cos_theta, -cos_phi * sin_theta),
        // Columns come together at the poles.
        area: sin_theta.abs(),
    })
}

/// The inverse of [`on_sphere`]; `None` at the camera itself.
pub(super) fn angles_on_sphere(point: DVec3) -> Option<[f64; 2]> {
    let across = point.x.hypot(point.z);
    let is_away = across > 0.0 || point.y != 0.0;
    let phi = point.x.atan2(-point.z).rem_euclid(TAU);
    is_away.then_some([phi, across.atan2(point.y)])
}

/// The direction at the angle |(x, y)| to the axis, if that is not beyond `edge`.
#[inline]
pub(super) fn in_circle(x: f64, y: f64, edge: f64) -> Option<Look> {
    let angle = x.hypot(y);
    if angle > edge {
        return None;
    }
    let (sin, cos) = angle.sin_cos();
    // sin(angle) / angle, which is 1 within the last digit where the angle is that small.
    let shrink = if angle > 1e-9 { sin / angle } else { 1.0 };
    Some(Look {
        dir: DVec3::new(x * shrink, y * shrink, cos),
        area: shrink,
    })
}

/// The inverse of [`in_circle`]. Straight behind the camera is all of a circle of 360 degrees: a
/// point there is given its left end.
pub(super) fn angles_in_circle(point: DVec3, edge: f64) -> Option<[f64; 2]> {
    let across = point.x.hypot(point.y);
    let angle = across.atan2(point.z);
    let is_away = across > 0.0 || point.z != 0.0;
    if !is_away || angle > edge {
        return None;
    }
    if across == 0.0 {
        return Some([if point.z < 0.0 { PI } else { 0.0 }, 0.0]);
    }
    Some([point.x, point.y].map(|along| along / across * angle))
}
