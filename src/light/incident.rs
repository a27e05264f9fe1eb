//! Light that arrives at a point from a light of the scene, and its density in solid angle.

use crate::math::{Rgb, Vec2, Vec3};

/// Where on an area light a sample fell, as its texture needs to know.
#[derive(Clone, Copy, Debug)]
pub(super) enum EmitterPlace {
    /// On a triangle of the mesh, at the weights of its second and third corner.
    Barycentric(u32, Vec2),
    /// On an exact shape: its texture coordinates follow from the position.
    Surface,
}

/// Light that arrives at a point, before its radiance is known.
#[derive(Clone, Copy, Debug)]
pub(super) struct Incident {
    /// Unit direction to the light.
    pub dir: Vec3,
    /// Distance to it.
    pub distance: f32,
    /// Density in solid angle.
    pub pdf: f32,
    /// Where on the light.
    pub place: EmitterPlace,
}

/// Light from a place without extent: unit direction to it, distance, irradiance facing it.
pub(super) struct DeltaIncident {
    pub dir: Vec3,
    pub distance: f32,
    pub irradiance: Rgb,
}

/// The sample that the point `q` with normal `n`, drawn with `density` in area, is for `p`.
#[inline]
pub(super) fn at_distance(
    p: Vec3,
    q: Vec3,
    n: Vec3,
    density: f32,
    place: EmitterPlace,
) -> Option<Incident> {
    let to = q - p;
    let distance = to.length();
    let dir = to / distance;
    let cos = -dir.dot(n);
    let pdf = distance * distance * density / cos;
    // Also refuses q = p, whose direction is not a number, and a density that overflows: what
    // divides by it would be lost or not a number.
    if cos > 0.0 && pdf > 0.0 && pdf.is_finite() {
        Some(Incident {
            dir,
            distance,
            pdf,
            place,
        })
    } else {
        None
    }
}

/// The density of [`at_distance`] alone; 0 where it draws nothing.
#[inline]
pub(super) fn solid_angle_density(p: Vec3, q: Vec3, n: Vec3, density: f32) -> f32 {
    at_distance(p, q, n, density, EmitterPlace::Surface).map_or(0.0, |i| i.pdf)
}
