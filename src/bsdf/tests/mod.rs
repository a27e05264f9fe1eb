//! Tests of the scattering models: against Mitsuba 3, against their own densities, and against what
//! physics allows.

use super::{Bsdf, Materials};
use crate::math::{Vec2, Vec3};
use crate::texture::SurfacePoint;

mod densities;
mod mitsuba;
mod models;
mod statistics;

/// The named model at a flat point whose local frame is the world's.
fn resolved(name: &str, wo: Vec3) -> Bsdf {
    let mut materials = Materials::default();
    let id = models::add(&mut materials, name);
    materials.resolve(id, &SurfacePoint::at_uv(Vec2::ZERO), wo)
}
