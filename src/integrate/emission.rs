//! Light that a path meets by itself.
//!
//! MIS weighs it against next-event estimation, which would have drawn it with the density that the
//! lights tell. What no light sample can find (through a delta lobe, or straight from the camera)
//! has another weight, given by the caller, and its density is not asked for.

use super::context::PathContext;
use super::path::Path;
use crate::accel::Ray;
use crate::light::{Collision, Shining};
use crate::math::mis::power_heuristic;
use crate::math::{Rgb, Vec3};
use crate::scene::surface::Surface;
use crate::texture::SurfacePoint;

/// What shines from outside the scene, times throughput and MIS weight.
#[inline]
pub(super) fn from_environment(
    context: &PathContext,
    ray: &Ray,
    path: &Path,
    weight_after_delta: impl FnOnce(Shining) -> f32,
) -> Rgb {
    let PathContext {
        scene, settings, ..
    } = *context;
    let hidden = path.depth == 0 && (settings.hide_emitters || settings.hide_environment);
    if hidden || !scene.lights.has_environment() {
        return Rgb::ZERO;
    }
    let lights = &scene.lights;
    let (radiance, weight) = if path.pdf.is_finite() {
        let (radiance, pdf) = lights.environment_pdf(path.from, path.from_normal, ray.dir);
        (
            radiance,
            power_heuristic(path.pdf, pdf * path.light_probability),
        )
    } else {
        let weight = weight_after_delta(Shining::Sky(ray.dir));
        (lights.environment(ray.dir), weight)
    };
    if radiance == Rgb::ZERO {
        return Rgb::ZERO;
    }
    path.throughput * radiance * weight
}

/// What a surface that was met emits itself, times throughput and MIS weight.
#[inline]
pub(super) fn emitted(
    context: &PathContext,
    surface: &Surface,
    (point, wo): (&SurfacePoint, Vec3),
    (path, left): (&Path, Option<&Collision>),
    weight_after_delta: impl FnOnce(Shining) -> f32,
) -> Rgb {
    let PathContext {
        scene, settings, ..
    } = *context;
    if path.depth == 0 && settings.hide_emitters {
        return Rgb::ZERO;
    }
    let radiance = scene.emitted(surface, point, wo);
    if radiance == Rgb::ZERO {
        return Rgb::ZERO;
    }
    let emitter = surface.emitter;
    let weight = if path.pdf.is_finite() {
        let (from, n) = (path.from, path.from_normal);
        let lights = &scene.lights;
        let selection = context
            .guide
            .and_then(|guide| guide.light_factors(path.light_cell));
        let shape = (emitter, point.prim);
        let pdf = lights.pdf_area((from, n), &selection, shape, (point.p, point.ng));
        let weight = power_heuristic(path.pdf, pdf * path.light_probability);
        // Distances that are drawn by lights find it, too, where the path left a collision.
        left.map_or(weight, |collision| {
            let leaf = lights.leaf_at(from, shape, (point.p, point.ng));
            let share = |leaf| lights.free_flight_weight(collision, leaf);
            weight * leaf.map_or(1.0, share)
        })
    } else {
        weight_after_delta(Shining::Shape(emitter))
    };
    path.throughput * radiance * weight
}
