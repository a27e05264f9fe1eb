//! One bounce, up to the point where a path scatters: what its ray met, and the light from there.

use super::context::PathContext;
use super::emission::{emitted, from_environment};
use super::features;
use super::next_event::ShadowRay;
use super::observer::PathObserver;
use super::path::{FirstHit, Path};
use crate::accel::{Hit, Ray};
use crate::bsdf::Bsdf;
use crate::light::{Collision, LightSource, Shining};
use crate::math::{Rgb, Vec3};
use crate::scene::path_medium::PathMedium;
use crate::texture::SurfacePoint;

/// How a path goes on.
#[derive(Clone, Copy, Debug, Default)]
pub struct BounceResult {
    /// The next ray, or none if the path ends.
    pub ray: Option<Ray>,
    /// A shadow ray to trace.
    pub shadow: Option<(Ray, ShadowRay)>,
}

/// What a path's ray met, if anything.
pub(super) struct Met<'a> {
    pub ray: &'a Ray,
    pub hit: &'a Hit,
    /// Distance that the path went before this ray, through index-matched surfaces.
    pub before: f32,
    /// The media around it, in scenes that have any.
    pub media: Option<&'a PathMedium>,
    /// The vertex that it left, if it collided there.
    pub left: Option<&'a Collision>,
}

/// A point where a path scatters, and the radiance that its sample has come to so far.
pub(super) struct Arrived<'a, 's> {
    pub point: &'a SurfacePoint<'s>,
    pub bsdf: &'a mut Bsdf,
    /// Towards the vertex before.
    pub wo: Vec3,
    /// Distance from there.
    pub distance: f32,
    pub radiance: Rgb,
    /// The media around it, in scenes that have any.
    pub media: Option<&'a PathMedium>,
}

/// A way to trace paths: plain or guided.
pub(super) trait Scatter<'s> {
    /// The state of its paths.
    type Path: AsRef<Path> + AsMut<Path> + Copy;

    /// What light counts that a path meets behind a delta lobe or from the camera: 1 where no other
    /// way of sampling could have found it.
    fn weight_after_delta(
        &self,
        context: &PathContext<'s>,
        path: &Self::Path,
        light: Shining,
    ) -> f32;

    /// What a path's sample has seen, if it has met nothing but mirrors and glass since.
    fn seen_by<'f>(
        &self,
        path: &Self::Path,
        first_hits: &'f mut [FirstHit],
    ) -> Option<&'f mut FirstHit>;

    /// How many accumulators the wave has; `None` if no path opens more.
    fn accumulators(&self) -> Option<usize>;

    /// Samples lights and the next direction.
    fn scatter(
        &mut self,
        context: &PathContext<'s>,
        at: Arrived<'_, 's>,
        path: &mut Self::Path,
        observer: &mut impl PathObserver,
    ) -> BounceResult;
}

/// Handles what `ray` met: adds its emission to the path's radiance, weighed by MIS, looks up the
/// BSDF, and lets the path scatter. Of a path from the camera it adds the first hit, and what is seen
/// behind mirrors and glass. It ends where nothing was met, or where it is as deep as it may be.
///
/// Always inlined, and what it calls with it: rays, paths and BSDFs need not be handed over through
/// memory. What was just written by halves would be waited for when it is read as a whole. (With a
/// BSDF that is returned to a caller who scatters, plain path tracing of a Cornell box takes 1.2
/// times as long.)
#[inline(always)]
pub(super) fn bounce<'s, S: Scatter<'s>>(
    context: &PathContext<'s>,
    Met {
        ray,
        hit,
        before,
        media,
        left,
    }: Met,
    how: &mut S,
    path: &mut S::Path,
    radiance: &mut Rgb,
    first_hits: &mut Vec<FirstHit>,
    observer: &mut impl PathObserver,
) -> BounceResult {
    let PathContext {
        scene, settings, ..
    } = *context;
    let weight_after_delta = |light| how.weight_after_delta(context, path, light);
    let base = (*path).as_ref();
    let depth = base.depth;
    let distance = before + hit.t;
    let cone_width = base.cone_width + base.cone_spread * distance;
    let Some(surface) = scene.surfaces.met(hit) else {
        if depth == 0 {
            first_hits.push(FirstHit::NOTHING);
            observer.sees(None);
        } else if let Some(first) = how.seen_by(path, first_hits) {
            features::add_sky(first, base);
        }
        observer.arrive(base.accumulator, *radiance, f32::INFINITY);
        let light = from_environment(context, ray, base, weight_after_delta);
        *radiance += light;
        observer.shines(base.accumulator, depth, light, LightSource::Sky(ray.dir));
        return BounceResult::default();
    };
    let point = scene.surfaces.point(ray, hit, cone_width);
    let wo = -ray.dir;
    observer.arrive(base.accumulator, *radiance, distance);
    if surface.glows() {
        let light = emitted(
            context,
            surface,
            (&point, wo),
            (base, left),
            weight_after_delta,
        );
        *radiance += light;
        let from = LightSource::Emitter(surface.emitter);
        observer.shines(base.accumulator, depth, light, from);
    }
    if depth + 1 >= settings.max_depth && depth > 0 {
        return BounceResult::default();
    }
    let mut bsdf = scene.surfaces.bsdf(surface, &point, wo);
    if depth == 0 {
        let seen = features::first_hit(scene, surface, (&point, wo), &bsdf, distance);
        first_hits.push(seen);
        observer.sees(Some((&point, hit)));
        if settings.max_depth < 2 {
            return BounceResult::default();
        }
    } else if let Some(first) = how.seen_by(path, first_hits) {
        features::add(first, scene, surface, (&point, wo), &bsdf, base);
    }
    let at = Arrived {
        point: &point,
        bsdf: &mut bsdf,
        wo,
        distance,
        radiance: *radiance,
        media,
    };
    how.scatter(context, at, path, observer)
}
