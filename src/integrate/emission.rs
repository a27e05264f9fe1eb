//! Light that a path meets by itself.
//!
//! MIS weighs it against next-event estimation, which would have drawn it with the density that the lights
//! tell. What no light sample can find (through a delta lobe, or straight from the camera) counts in full,
//! and its density is not asked for.

use super::chain::Station;
use super::vertex::Walk;
use super::wave::{Outcome, Path};
use crate::accel::Ray;
use crate::light::Shining;
use crate::math::mis::power_heuristic;
use crate::math::{Rgb, Vec3};
use crate::scene::surface::Surface;
use crate::texture::SurfacePoint;

/// Adds what shines from outside the scene.
pub(super) fn add_environment(
    walk: &Walk,
    ray: &Ray,
    path: &Path,
    stations: &[Station],
    outcome: &mut Outcome,
) {
    let Walk {
        scene, settings, ..
    } = *walk;
    let hidden = path.depth == 0 && settings.hide_emitters;
    if hidden || !scene.lights.has_environment() {
        return;
    }
    let lights = &scene.lights;
    let (radiance, weight) = if path.pdf.is_finite() {
        let (radiance, pdf) = lights.environment_pdf(path.from, path.from_normal, ray.dir);
        (radiance, power_heuristic(path.pdf, pdf * path.light_chance))
    } else {
        (
            lights.environment(ray.dir),
            chained(walk, path, stations, Shining::Sky(ray.dir)),
        )
    };
    if radiance == Rgb::ZERO {
        return;
    }
    outcome.radiance += path.throughput * radiance * weight;
}

/// What the light counts that a path meets by a chain of mirrors and glass.
fn chained(walk: &Walk, path: &Path, stations: &[Station], light: Shining) -> f32 {
    let aiming = walk.guide.and_then(|guide| guide.aiming());
    let (Some(aiming), Some(station)) = (aiming, stations.get(path.station as usize)) else {
        return 1.0;
    };
    aiming
        .chains()
        .weight(walk.scene, station, path.chain, light)
}

/// Adds what the surface itself emits.
pub(super) fn add_emission(
    walk: &Walk,
    surface: &Surface,
    (point, wo): (&SurfacePoint, Vec3),
    path: &Path,
    stations: &[Station],
    outcome: &mut Outcome,
) {
    let Walk {
        scene, settings, ..
    } = *walk;
    if path.depth == 0 && settings.hide_emitters {
        return;
    }
    let radiance = scene.emitted(surface, point, wo);
    if radiance == Rgb::ZERO {
        return;
    }
    let emitter = surface.emitter;
    let weight = if path.pdf.is_finite() {
        let (from, n) = (path.from, path.from_normal);
        let lights = &scene.lights;
        let pdf = lights.pdf_area(from, n, emitter, point.prim, point.p, point.ng);
        power_heuristic(path.pdf, pdf * path.light_chance)
    } else {
        chained(walk, path, stations, Shining::Shape(emitter))
    };
    outcome.radiance += path.throughput * radiance * weight;
}
