//! Tests of the scattering models: against Mitsuba 3, against their own densities, and against what
//! physics allows.

use super::{Bsdf, Material, MaterialId, Materials};
use crate::math::{Vec2, Vec3};
use crate::texture::SurfacePoint;

mod densities;
mod energy;
mod extremes;
mod limits;
mod mitsuba;
pub(super) mod models;
mod parts;
mod statistics;
mod structure;

/// A material at a flat point whose local frame is the world's.
fn at_flat_point(materials: &Materials, id: MaterialId, wo: Vec3) -> Bsdf {
    materials.resolve(id, &SurfacePoint::at_uv(Vec2::ZERO), wo)
}

/// The named model there.
fn resolved(name: &str, wo: Vec3) -> Bsdf {
    let mut materials = Materials::default();
    let id = models::add(&mut materials, name);
    at_flat_point(&materials, id, wo)
}

/// A material that names no other, there.
fn of_material(material: impl Into<Material>, wo: Vec3) -> Bsdf {
    let mut materials = Materials::default();
    let id = materials.push(material);
    at_flat_point(&materials, id, wo)
}
