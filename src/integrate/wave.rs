//! A wave of paths that advance together, one bounce at a time.

use super::bounce::{Met, Scatter, bounce};
use super::camera_sample::Origin;
use super::context::PathContext;
use super::guided_path::GuidedPath;
use super::guided_scatter::GuidedOutput;
use super::lobe_splitting;
use super::manifold::LastRoughVertex;
use super::media;
use super::next_event::ShadowRay;
use super::observer::PathObserver;
use super::path::{FirstHit, Path};
use super::recording::{Recorded, Recording};
use super::reuse::PrefixPool;
use super::scatter::Plain;
use super::shadows::ShadowRays;
use super::splitting::SplitPaths;
use crate::camera::CameraRay;
use crate::film::Extras;
use crate::math::{PathSampler, Rgb};
use crate::scene::Scene;
use crate::scene::path_medium::PathMedium;
use crate::scene::wavefront::{AHEAD, Wavefront};
use std::sync::Arc;

/// Edges after which a wave may be given up, and from there on every so many: roulette and dark
/// surfaces have ended any other path by then (of a path between walls that reflect 0.99, 3e-5
/// would be left).
pub const LONG: u32 = 1024;
const BETWEEN_LOOKS: u32 = 64;

/// What a wave's samples came to: the radiance of each. Behind the samples, in order, stand the
/// ways that split off, which the samples' radiance includes.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'w> {
    /// By themselves.
    pub own: &'w [Rgb],
    /// For the image.
    pub image: &'w [Rgb],
    /// What the samples met first.
    pub first_hits: &'w [FirstHit],
    /// What the film wanted to know of them besides.
    pub recorded: &'w Recorded,
    /// Rays that they took.
    pub rays: u64,
}

/// Buffers of a wave, kept from one tile to the next.
#[derive(Default)]
pub struct Wave {
    /// Plain paths, and the samples of guided ones before they begin.
    plain: Wavefront<Path>,
    guided: Wavefront<GuidedPath>,
    shadows: ShadowRays,
    /// Where paths are, by accumulator, in scenes with media.
    path_media: Vec<PathMedium>,
    blocked: Vec<bool>,
    /// Radiance by accumulator.
    radiances: Vec<Rgb>,
    /// The same with what the samples share.
    shared: Vec<Rgb>,
    first_hits: Vec<FirstHit>,
    recorded: Recorded,
    split_paths: SplitPaths,
    rough_vertices: Vec<LastRoughVertex>,
    /// Radiance that vertices found by manifold next-event estimation, by accumulator.
    found: Vec<(u32, Rgb)>,
    rays_traced: u64,
}

impl Wave {
    /// Empties the wave.
    pub fn clear(&mut self) {
        self.plain.clear();
        self.guided.clear();
        self.radiances.clear();
        self.first_hits.clear();
    }

    /// Adds a sample. Its radiance will stand at the same place in [`Wave::trace`]'s answer.
    #[inline]
    pub fn push(&mut self, camera: CameraRay, sampler: PathSampler) {
        let accumulator = self.radiances.len() as u32;
        let path = Path::new(&camera, sampler, accumulator);
        self.plain.push(path, camera.ray);
        self.radiances.push(Rgb::ZERO);
    }

    /// Traces all samples to their ends, watched by `observer` (`&mut ()` for nobody). The samples'
    /// radiances come first, in order; behind them those of ways that split off, which the samples'
    /// include.
    pub fn trace(&mut self, context: &PathContext, observer: &mut impl PathObserver) -> &[Rgb] {
        self.begin_in(PathMedium::inside(context.scene.media.camera), context);
        self.run(context, observer, &mut PrefixPool::new(1, 0), &|_| false);
        self.split_paths.reduce(&mut self.radiances);
        &self.radiances
    }

    /// The same for samples that begin at a place of the scene instead of the camera, with this
    /// around it.
    pub fn trace_from(&mut self, around: PathMedium, context: &PathContext) -> &[Rgb] {
        self.begin_in(around, context);
        self.run(context, &mut (), &mut PrefixPool::new(1, 0), &|_| false);
        self.split_paths.reduce(&mut self.radiances);
        &self.radiances
    }

    /// Puts all samples into a medium, where the scene has media.
    fn begin_in(&mut self, around: PathMedium, context: &PathContext) {
        self.path_media.clear();
        if !context.scene.media.is_empty() {
            self.path_media.resize(self.radiances.len(), around);
        }
    }

    /// The same for samples of the image, which may share what they find (see [`super::reuse`]).
    /// `own` is what they came to by themselves, `image` what they are worth to the image;
    /// `origins` tells where each comes from, `extras` what the film wants to know besides.
    ///
    /// Where paths go on after [`LONG`] edges, `gives_up` is asked now and then, with the number of
    /// edges so far. When it says so there is no outcome: without the long paths the rest would be
    /// biased.
    pub fn trace_image(
        &mut self,
        context: &PathContext,
        observer: &mut impl PathObserver,
        (origins, extras): (&[Origin], &Arc<Extras>),
        gives_up: &dyn Fn(u32) -> bool,
    ) -> Option<Outcomes<'_>> {
        let before = self.rays_traced;
        let media = &context.scene.media;
        let most = match context.guide {
            // Through index-matched surfaces each connection would have to be followed, which costs
            // what it gains; where media scatter, blocks lose (EXPERIMENTS.md).
            Some(_) if !media.has_index_matched && !media.scatter() => {
                context.settings.guided.reuse
            }
            _ => 1,
        };
        let mut pool = PrefixPool::new(most, self.radiances.len());
        let mut recorded = std::mem::take(&mut self.recorded);
        recorded.start(extras);
        let mut recording = Recording {
            observer,
            recorded: &mut recorded,
            lights: &context.scene.lights,
        };
        self.begin_in(PathMedium::inside(context.scene.media.camera), context);
        let is_whole = self.run(context, &mut recording, &mut pool, gives_up);
        self.recorded = recorded;
        if !is_whole {
            return None;
        }
        if pool.is_open() {
            self.shared.clone_from(&self.radiances);
        }
        self.split_paths.reduce(&mut self.radiances);
        let mut image = &self.radiances;
        if pool.is_open() {
            let parts = self.recorded.light();
            self.rays_traced += pool.reduce(
                context,
                origins,
                &mut self.split_paths,
                &mut self.shared,
                parts,
            );
            image = &self.shared;
        } else if let Some(parts) = self.recorded.light() {
            parts.reduce(&self.split_paths);
        }
        Some(Outcomes {
            own: &self.radiances,
            image,
            first_hits: &self.first_hits,
            recorded: &self.recorded,
            rays: self.rays_traced - before,
        })
    }

    /// Traces all samples to their ends; `false` if they were given up before.
    fn run<'s>(
        &mut self,
        context: &PathContext<'s>,
        observer: &mut impl PathObserver,
        pool: &mut PrefixPool<'s>,
        gives_up: &dyn Fn(u32) -> bool,
    ) -> bool {
        let mut edges: u32 = 0;
        self.split_paths.start(self.radiances.len());
        self.rough_vertices.clear();
        if context.guide.is_some() {
            let begin = |(path, ray)| (GuidedPath::new(path, lobe_splitting::FROM_CAMERA), ray);
            self.guided.extend(self.plain.drain().map(begin));
        }
        while self.is_under_way() {
            match context.guide {
                Some(_) => self.advance_guided(context, observer, pool),
                None => self.advance(context, observer),
            }
            edges = edges.saturating_add(1);
            self.collect_light(context.scene, observer, edges);
            let asks = edges >= LONG && edges % BETWEEN_LOOKS == 0;
            if asks && self.is_under_way() && gives_up(edges) {
                return false;
            }
        }
        true
    }

    fn is_under_way(&self) -> bool {
        !(self.plain.is_empty() && self.guided.is_empty())
    }

    /// Rays traced since the wave was made, shadow rays included.
    pub fn rays_traced(&self) -> u64 {
        self.rays_traced
    }

    /// Handles one vertex of every path.
    fn advance(&mut self, context: &PathContext, observer: &mut impl PathObserver) {
        let sums = (&mut self.radiances[..], &mut self.first_hits);
        self.rays_traced += advance(
            &mut self.plain,
            context,
            &mut Plain,
            sums,
            (&mut self.shadows, &mut self.path_media),
            observer,
        );
    }

    /// The same for guided paths.
    fn advance_guided<'s>(
        &mut self,
        context: &PathContext<'s>,
        observer: &mut impl PathObserver,
        pool: &mut PrefixPool<'s>,
    ) {
        let sums = (&mut self.radiances[..], &mut self.first_hits);
        let mut output = GuidedOutput {
            split_paths: &mut self.split_paths,
            rough_vertices: &mut self.rough_vertices,
            pool,
            found: &mut self.found,
            rays: &mut self.rays_traced,
        };
        let rays = advance(
            &mut self.guided,
            context,
            &mut output,
            sums,
            (&mut self.shadows, &mut self.path_media),
            observer,
        );
        self.rays_traced += rays;
        self.guided.extend(self.split_paths.take());
        let accumulators = self.split_paths.accumulators();
        self.radiances.resize(accumulators, Rgb::ZERO);
        for (accumulator, radiance) in self.found.drain(..) {
            self.radiances[accumulator as usize] += radiance;
        }
    }

    /// Adds the light of all unblocked shadow rays. It was scattered so often: all paths of a wave
    /// have as many edges.
    fn collect_light(&mut self, scene: &Scene, observer: &mut impl PathObserver, bounces: u32) {
        self.blocked.clear();
        self.blocked.resize(self.shadows.rays.len(), false);
        self.rays_traced += match scene.media.is_empty() {
            true => {
                let rays = &self.shadows.rays;
                scene.rays.occluded_batch(rays, &mut self.blocked);
                rays.len() as u64
            }
            false => self.shadows.cast(scene, &mut self.blocked),
        };
        let ShadowRays { rays, offers, .. } = &mut self.shadows;
        let mut blocked = self.blocked.iter();
        offers.retain(|_| blocked.next() == Some(&false));
        if observer.wants_sources() {
            let mut blocked = self.blocked.iter();
            rays.retain(|_| blocked.next() == Some(&false));
            for (ray, ShadowRay { accumulator, offer }) in rays.iter().zip(&*offers) {
                let from = scene.lights.source_of(&offer.incoming, ray.dir);
                let light = offer.radiance(&scene.lights);
                observer.shines(*accumulator, bounces, light, from);
            }
        }
        for shadows in offers.chunks(AHEAD) {
            let offers = shadows.iter().map(|shadow| &shadow.offer.incoming);
            scene.lights.prefetch(offers);
            for ShadowRay { accumulator, offer } in shadows {
                let radiance = offer.radiance(&scene.lights);
                self.radiances[*accumulator as usize] += radiance;
                observer.lit(*accumulator, radiance);
            }
        }
    }
}

/// Lets every path of a wavefront bounce; returns the number of rays.
#[inline(always)]
fn advance<'s, S: Scatter<'s>>(
    wavefront: &mut Wavefront<S::Path>,
    context: &PathContext<'s>,
    how: &mut S,
    (radiances, first_hits): (&mut [Rgb], &mut Vec<FirstHit>),
    (shadows, path_media): (&mut ShadowRays, &mut Vec<PathMedium>),
    observer: &mut impl PathObserver,
) -> u64 {
    shadows.clear();
    if !context.scene.media.is_empty() {
        let sums = (radiances, first_hits);
        let places = (path_media, shadows);
        return media::advance(wavefront, context, how, sums, places, observer);
    }
    wavefront.advance(context.scene, |path, ray, hit| {
        let radiance = &mut radiances[(*path).as_ref().accumulator as usize];
        let met = Met {
            ray,
            hit,
            before: 0.0,
            media: None,
            left: None,
        };
        let result = bounce(context, met, how, path, radiance, first_hits, observer);
        if let Some((ray, shadow)) = result.shadow {
            shadows.rays.push(ray);
            shadows.offers.push(shadow);
        }
        result.ray
    })
}
