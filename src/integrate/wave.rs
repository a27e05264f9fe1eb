//! A wave of paths that advance together, one bounce at a time.

use super::bounce::{Scatter, bounce};
use super::camera_sample::Origin;
use super::context::PathContext;
use super::guided_path::GuidedPath;
use super::guided_scatter::GuidedOutput;
use super::lobe_splitting;
use super::manifold::LastRoughVertex;
use super::next_event::ShadowRay;
use super::observer::PathObserver;
use super::path::{Outcome, Path};
use super::reuse::PrefixPool;
use super::scatter::Plain;
use super::splitting::SplitPaths;
use crate::accel::{Hit, Ray};
use crate::camera::CameraRay;
use crate::math::{PathSampler, Rgb};
use crate::scene::Scene;

/// Vertices whose data is brought into the cache at a time: a few times as many as a processor
/// waits for at once, few enough for the smallest cache.
const AHEAD: usize = 32;

/// Edges after which a wave may be given up, and from there on every so many: roulette and dark
/// surfaces have ended any other path by then (of a path between walls that reflect 0.99, 3e-5
/// would be left).
pub const LONG: u32 = 1024;
const BETWEEN_LOOKS: u32 = 64;

/// What a wave's samples came to. Behind the samples, in order, stand the ways that split off,
/// which the samples' outcomes include.
#[derive(Clone, Copy, Debug)]
pub struct Outcomes<'w> {
    /// By themselves.
    pub own: &'w [Outcome],
    /// For the image.
    pub image: &'w [Outcome],
    /// Rays that they took.
    pub rays: u64,
}

/// Buffers of a wave, kept from one tile to the next.
#[derive(Default)]
pub struct Wave {
    bounces: Bounces,
    paths: Vec<Path>,
    blocked: Vec<bool>,
    outcomes: Vec<Outcome>,
    /// What the samples came to with what they share.
    shared: Vec<Outcome>,
    guided_paths: Vec<GuidedPath>,
    split_paths: SplitPaths,
    rough_vertices: Vec<LastRoughVertex>,
    /// Radiance that vertices found by manifold next-event estimation, by accumulator.
    found: Vec<(u32, Rgb)>,
    rays_traced: u64,
}

impl Wave {
    /// Empties the wave.
    pub fn clear(&mut self) {
        self.bounces.rays.clear();
        self.paths.clear();
        self.outcomes.clear();
    }

    /// Adds a sample. Its outcome will stand at the same place in [`Wave::trace`]'s answer.
    #[inline]
    pub fn push(&mut self, camera: CameraRay, sampler: PathSampler) {
        let accumulator = self.outcomes.len() as u32;
        self.paths.push(Path::new(&camera, sampler, accumulator));
        self.bounces.rays.push(camera.ray);
        self.outcomes.push(Outcome::default());
    }

    /// Traces all samples to their ends, watched by `observer` (`&mut ()` for nobody). The samples'
    /// outcomes come first, in order; behind them those of ways that split off, which the samples'
    /// include.
    pub fn trace(&mut self, context: &PathContext, observer: &mut impl PathObserver) -> &[Outcome] {
        self.run(context, observer, &mut PrefixPool::new(1, 0), &|_| false);
        self.split_paths.reduce(&mut self.outcomes);
        &self.outcomes
    }

    /// The same for samples of the image, which may share what they find (see [`super::reuse`]).
    /// `own` is what they came to by themselves, `image` what they are worth to the image;
    /// `origins` tells where each comes from.
    ///
    /// Where paths go on after [`LONG`] edges, `gives_up` is asked now and then, with the number of
    /// edges so far. When it says so there is no outcome: without the long paths the rest would be
    /// biased.
    pub fn trace_image(
        &mut self,
        context: &PathContext,
        observer: &mut impl PathObserver,
        origins: &[Origin],
        gives_up: &dyn Fn(u32) -> bool,
    ) -> Option<Outcomes<'_>> {
        let before = self.rays_traced;
        let guided = context.guide.is_some();
        let most = if guided { context.settings.reuse } else { 1 };
        let mut pool = PrefixPool::new(most, self.paths.len());
        if !self.run(context, observer, &mut pool, gives_up) {
            return None;
        }
        if pool.is_open() {
            self.shared.clone_from(&self.outcomes);
        }
        self.split_paths.reduce(&mut self.outcomes);
        let mut image = &self.outcomes;
        if pool.is_open() {
            self.rays_traced +=
                pool.reduce(context, origins, &mut self.split_paths, &mut self.shared);
            image = &self.shared;
        }
        Some(Outcomes {
            own: &self.outcomes,
            image,
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
        self.split_paths.start(self.outcomes.len());
        self.rough_vertices.clear();
        self.guided_paths.clear();
        let guided = context.guide.is_some();
        if guided {
            let begin = |path| GuidedPath::new(path, lobe_splitting::FROM_CAMERA);
            self.guided_paths.extend(self.paths.drain(..).map(begin));
        }
        while !self.bounces.rays.is_empty() {
            self.bounces.hits.resize(self.bounces.rays.len(), Hit::NONE);
            context
                .scene
                .rays
                .intersect_batch(&self.bounces.rays, &mut self.bounces.hits);
            self.rays_traced += self.bounces.rays.len() as u64;
            match guided {
                true => self.advance_guided(context, observer, pool),
                false => self.advance(context, observer),
            }
            self.collect_light(context.scene, observer);
            edges = edges.saturating_add(1);
            let asks = edges >= LONG && edges % BETWEEN_LOOKS == 0;
            if asks && !self.bounces.rays.is_empty() && gives_up(edges) {
                return false;
            }
        }
        true
    }

    /// Rays traced since the wave was made, shadow rays included.
    pub fn rays_traced(&self) -> u64 {
        self.rays_traced
    }

    /// Handles one vertex of every path.
    fn advance(&mut self, context: &PathContext, observer: &mut impl PathObserver) {
        let outcomes = &mut self.outcomes;
        self.bounces
            .each(context, &mut Plain, &mut self.paths, outcomes, observer);
    }

    /// The same for guided paths.
    fn advance_guided<'s>(
        &mut self,
        context: &PathContext<'s>,
        observer: &mut impl PathObserver,
        pool: &mut PrefixPool<'s>,
    ) {
        let outcomes = &mut self.outcomes;
        let mut output = GuidedOutput {
            split_paths: &mut self.split_paths,
            rough_vertices: &mut self.rough_vertices,
            pool,
            found: &mut self.found,
            rays: &mut self.rays_traced,
        };
        self.bounces.each(
            context,
            &mut output,
            &mut self.guided_paths,
            outcomes,
            observer,
        );
        for (path, ray) in self.split_paths.take() {
            self.guided_paths.push(path);
            self.bounces.rays.push(ray);
        }
        let accumulators = self.split_paths.accumulators();
        self.outcomes.resize(accumulators, Outcome::default());
        for (accumulator, radiance) in self.found.drain(..) {
            self.outcomes[accumulator as usize].radiance += radiance;
        }
    }

    /// Adds the light of all unblocked shadow rays.
    fn collect_light(&mut self, scene: &Scene, observer: &mut impl PathObserver) {
        self.blocked.resize(self.bounces.shadow_rays.len(), false);
        scene
            .rays
            .occluded_batch(&self.bounces.shadow_rays, &mut self.blocked);
        self.rays_traced += self.bounces.shadow_rays.len() as u64;
        let mut blocked = self.blocked.iter();
        self.bounces
            .shadows
            .retain(|_| blocked.next() == Some(&false));
        for shadows in self.bounces.shadows.chunks(AHEAD) {
            let offers = shadows.iter().map(|shadow| &shadow.offer.incoming);
            scene.lights.prefetch(offers);
            for ShadowRay { accumulator, offer } in shadows {
                let radiance = offer.radiance(&scene.lights);
                self.outcomes[*accumulator as usize].radiance += radiance;
                observer.lit(*accumulator, radiance);
            }
        }
    }
}

/// The rays of one bounce of all paths of a wave.
#[derive(Default)]
struct Bounces {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    shadow_rays: Vec<Ray>,
    shadows: Vec<ShadowRay>,
}

impl Bounces {
    /// Lets every path bounce, and keeps those that go on, in order.
    #[inline(always)]
    fn each<'s, S: Scatter<'s>>(
        &mut self,
        context: &PathContext<'s>,
        how: &mut S,
        paths: &mut Vec<S::Path>,
        outcomes: &mut [Outcome],
        observer: &mut impl PathObserver,
    ) {
        self.shadows.clear();
        self.shadow_rays.clear();
        let mut kept = 0;
        for i in 0..paths.len() {
            if i % AHEAD == 0 {
                let next = &self.hits[i..(i + AHEAD).min(paths.len())];
                context.scene.surfaces.prefetch(next);
            }
            // Moved up before it goes on: a copy of what was just written would wait for it.
            paths[kept] = paths[i];
            let path = &mut paths[kept];
            let outcome = &mut outcomes[(*path).as_ref().accumulator as usize];
            let met = (&self.rays[i], &self.hits[i]);
            let result = bounce(context, met, how, path, outcome, observer);
            if let Some((ray, shadow)) = result.shadow {
                self.shadow_rays.push(ray);
                self.shadows.push(shadow);
            }
            let Some(ray) = result.ray else { continue };
            self.rays[kept] = ray;
            kept += 1;
        }
        paths.truncate(kept);
        self.rays.truncate(kept);
    }
}
