//! Paths in scenes with participating media. A scene without media has no part in this: its paths
//! are advanced by [`super::wave`] alone.
//!
//! Between two surfaces a path may collide (see [`crate::medium`]): then it scatters by a phase
//! function, like at a surface. Index-matched surfaces are passed within one edge: they change the
//! medium and nothing else. Next-event estimation passes them, too, and is attenuated. MIS weighs
//! both by the densities of their directions: what comes through is the same for both.
//!
//! A path's medium is kept beside it, by accumulator: split paths have accumulators of their own.

use super::bounce::{Arrived, BounceResult, Met, Scatter, bounce};
use super::context::PathContext;
use super::equiangular::{BesideFlight, EDGES};
use super::features;
use super::observer::PathObserver;
use super::path::FirstHit;
use super::settings::PathSettings;
use super::shadows::{ShadowMedium, ShadowRays};
use crate::bsdf::Bsdf;
use crate::math::{NumberStream, Rgb};
use crate::medium::MediumId;
use crate::scene::free_flight::{FreeFlight, sample_flight};
use crate::scene::path_medium::PathMedium;
use crate::scene::wavefront::Wavefront;
use crate::texture::SurfacePoint;

/// Numbers of the paths' sequences: beside those of the path itself.
const BESIDE: u32 = 0x6265_7369;
const FLIGHT: u32 = 0x666c_6967;
const SHADOW: u32 = 0x7368_6164;

/// Lets every path of a wavefront go to its next vertex and scatter there; returns the number of
/// rays.
#[inline(never)]
pub(super) fn advance<'s, S: Scatter<'s>>(
    wavefront: &mut Wavefront<S::Path>,
    context: &PathContext<'s>,
    how: &mut S,
    (radiances, first_hits): (&mut [Rgb], &mut Vec<FirstHit>),
    (path_media, shadows): (&mut Vec<PathMedium>, &mut ShadowRays),
    observer: &mut impl PathObserver,
) -> u64 {
    let scene = context.scene;
    let mut passed = 0;
    let rays = wavefront.advance(scene, |path, ray, hit| {
        let accumulator = (*path).as_ref().accumulator as usize;
        let mut at = path_media[accumulator];
        let base = path.as_mut();
        let first = base.sampler.next4();
        let mut numbers = NumberStream::new(first, base.sampler.fork(FLIGHT));
        let mut beside = BesideFlight::new(scene, base.sampler.fork(BESIDE));
        let u = &mut || numbers.draw();
        let before = base.throughput;
        let lights_draw = base.depth < EDGES && may_scatter(base.depth, context.settings);
        let flight = match lights_draw {
            true => sample_flight(scene, (ray, hit), &mut at, &mut beside, u),
            false => sample_flight(scene, (ray, hit), &mut at, &mut (), u),
        };
        base.throughput *= flight.factor;
        passed += flight.rays + beside.rays;
        let radiance = &mut radiances[accumulator];
        // Before the vertex: its own light samples and directions have no part in it.
        if !beside.found.is_empty() {
            observer.arrive(base.accumulator, *radiance, flight.distance());
        }
        for (light, from) in beside.found.drain(..) {
            let light = before * light;
            *radiance += light;
            observer.shines(base.accumulator, base.depth + 1, light, from);
        }
        let result = match flight.collision {
            Some((distance, id)) => {
                let medium = scene.media.list().get(id);
                at.collision = medium.and_then(|medium| beside.collision(distance, medium));
                let place = (&flight, (distance, id), &at);
                collide(context, place, how, path, radiance, first_hits, observer)
            }
            None => {
                if flight.hit.is_some() {
                    at.arrive(scene, &flight.ray, &flight.hit);
                }
                let left = at.collision.take();
                let met = Met {
                    ray: &flight.ray,
                    hit: &flight.hit,
                    before: flight.before,
                    media: Some(&at),
                    left: left.as_ref(),
                };
                bounce(context, met, how, path, radiance, first_hits, observer)
            }
        };
        path_media[accumulator] = at;
        if let Some(accumulators) = how.accumulators() {
            path_media.resize(accumulators, at);
        }
        if let Some((ray, shadow)) = result.shadow {
            shadows.media.push(ShadowMedium {
                medium: at.medium(ray.dir),
                sampler: (*path).as_ref().sampler.fork(SHADOW),
            });
            shadows.rays.push(ray);
            shadows.offers.push(shadow);
        }
        result.ray
    });
    rays + passed
}

/// Whether a path of a depth may scatter once more.
fn may_scatter(depth: u32, settings: &PathSettings) -> bool {
    match depth {
        0 => settings.max_depth >= 2,
        _ => depth + 1 < settings.max_depth,
    }
}

/// Handles a collision: the path scatters by the medium's phase function.
fn collide<'s, S: Scatter<'s>>(
    context: &PathContext<'s>,
    (flight, (distance, medium), around): (&FreeFlight, (f32, MediumId), &PathMedium),
    how: &mut S,
    path: &mut S::Path,
    radiance: &mut Rgb,
    first_hits: &mut Vec<FirstHit>,
    observer: &mut impl PathObserver,
) -> BounceResult {
    let PathContext {
        scene, settings, ..
    } = *context;
    let Some(medium) = scene.media.list().get(medium) else {
        return BounceResult::default();
    };
    let base = (*path).as_ref();
    let (wo, depth) = (-flight.ray.dir, base.depth);
    let gone = flight.before + distance;
    observer.arrive(base.accumulator, *radiance, gone);
    if depth > 0 && !may_scatter(depth, settings) {
        return BounceResult::default();
    }
    let footprint = base.cone_width + base.cone_spread * gone;
    let point = SurfacePoint::in_volume(flight.ray.at(distance), wo, footprint);
    let albedo = medium.extinction.albedo(point.p);
    let mut bsdf = Bsdf::of_medium(medium.phase, albedo, wo);
    if depth == 0 {
        first_hits.push(features::first_collision(albedo, gone));
        observer.sees(None);
        if !may_scatter(depth, settings) {
            return BounceResult::default();
        }
    } else if let Some(first) = how.seen_by(path, first_hits) {
        features::add_collision(first, albedo, base);
    }
    let at = Arrived {
        point: &point,
        bsdf: &mut bsdf,
        wo,
        distance: gone,
        radiance: *radiance,
        media: Some(around),
    };
    how.scatter(context, at, path, observer)
}
