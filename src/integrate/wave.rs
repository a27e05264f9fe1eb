//! A wave of paths that advance together, one bounce at a time.

use super::chain::{Kinds, Station};
use super::forks::Forks;
use super::lots;
use super::next_event::ShadowRay;
use super::record::Witness;
use super::reuse::{Origin, Pool, Stage};
use super::vertex::{self, Walk, Watched};
use crate::accel::{Hit, Ray};
use crate::camera::CameraRay;
use crate::math::{PathSampler, Rgb, Vec3};
use crate::scene::Scene;

/// Vertices whose data is brought into the cache at a time: a few times as many as a processor waits for at
/// once, few enough for the smallest cache.
const AHEAD: usize = 32;

/// Edges after which a wave may be given up, and from there on every so many: roulette and dark surfaces have
/// ended any other path by then (of a path between walls that reflect 0.99, 3e-5 would be left).
pub const LONG: u32 = 1024;
const BETWEEN_LOOKS: u32 = 64;

/// [`Path::station`] of a path that has left no vertex where chains were sampled.
pub const NO_STATION: u32 = u32::MAX;

/// What a path carries from one vertex to the next.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Product of BSDF weights so far.
    pub throughput: Rgb,
    /// Density with which the last direction was drawn, solid angle; infinite after a delta lobe and at the camera.
    pub pdf: f32,
    /// The vertex the ray left.
    pub from: Vec3,
    /// The normal that light sampling was given there (zero: light from all sides).
    pub from_normal: Vec3,
    /// The chance with which a light was sampled there.
    pub light_chance: f32,
    /// Product of relative indices of refraction.
    pub eta: f32,
    /// Edges so far.
    pub depth: u32,
    /// Its account among the wave's outcomes: its sample's, or one of its own once it has split.
    pub slot: u32,
    /// What the sample is expected to come to by the field's account, summed over the channels; 0 until
    /// the field was asked.
    pub expected: f32,
    /// Into how many ways its sample would have been split by now, had all of them been split as often.
    pub ways: u32,
    /// In how many parts it may go on from delta lobes (see [`super::lots`]); 1 without a field.
    pub lots: f32,
    /// The path's standing (see [`super::roulette`]) when the field aimed it last; 1 until then.
    pub aimed_with: f32,
    /// How far it has come.
    pub stage: Stage,
    /// The mirrors and glass that it has passed since it left its last rough vertex.
    pub chain: Kinds,
    /// Number of that vertex among the wave's stations, or [`NO_STATION`].
    pub station: u32,
    /// Width of the ray's cone at its origin.
    pub cone_width: f32,
    /// Growth of that width per unit distance.
    pub cone_spread: f32,
    /// Numbers to come.
    pub sampler: PathSampler,
}

impl Path {
    /// A path that begins at the camera.
    #[inline]
    pub fn new(camera: &CameraRay, sampler: PathSampler, slot: u32) -> Self {
        Self {
            throughput: Rgb::ONE,
            pdf: f32::INFINITY,
            from: camera.ray.org,
            from_normal: Vec3::ZERO,
            light_chance: 1.0,
            eta: 1.0,
            depth: 0,
            expected: 0.0,
            ways: 1,
            lots: 1.0,
            stage: Stage::Fresh,
            chain: Kinds::EMPTY,
            station: NO_STATION,
            aimed_with: 1.0,
            slot,
            cone_width: camera.cone_width,
            cone_spread: camera.cone_spread,
            sampler,
        }
    }

    /// Makes it one of this walk's.
    #[inline]
    pub fn set_out(&mut self, walk: &Walk) {
        self.lots = lots::from_camera(walk.guide.is_some());
    }
}

/// What the camera sees first along a sample: for the AOVs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstHit {
    /// Reflectance.
    pub albedo: Rgb,
    /// Shading normal, world space.
    pub normal: Vec3,
    /// Distance; 0 where nothing was met.
    pub depth: f32,
}

/// What a sample came to.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Radiance.
    pub radiance: Rgb,
    /// First surface.
    pub first: FirstHit,
}

/// What a wave's samples came to. Behind the samples, in order, stand the ways that split off, which the
/// samples' outcomes include.
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
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    paths: Vec<Path>,
    shadows: Vec<ShadowRay>,
    shadow_rays: Vec<Ray>,
    blocked: Vec<bool>,
    outcomes: Vec<Outcome>,
    /// What the samples came to with what they share.
    shared: Vec<Outcome>,
    forks: Forks,
    stations: Vec<Station>,
    /// Light that vertices have found at once, for accounts.
    found: Vec<(u32, Rgb)>,
    rays_traced: u64,
}

impl Wave {
    /// Empties the wave.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.paths.clear();
        self.outcomes.clear();
    }

    /// Adds a sample. Its outcome will stand at the same place in [`Wave::trace`]'s answer.
    #[inline]
    pub fn push(&mut self, camera: CameraRay, sampler: PathSampler) {
        let slot = self.outcomes.len() as u32;
        self.paths.push(Path::new(&camera, sampler, slot));
        self.rays.push(camera.ray);
        self.outcomes.push(Outcome::default());
    }

    /// Traces all samples to their ends, watched by `witness` (`&mut ()` for nobody). The samples' outcomes
    /// come first, in order; behind them those of ways that split off, which the samples' include.
    pub fn trace(&mut self, walk: &Walk, witness: &mut impl Witness) -> &[Outcome] {
        self.run(walk, witness, &mut Pool::new(1, 0), &|_| false);
        self.forks.settle(&mut self.outcomes);
        &self.outcomes
    }

    /// The same for samples of the image, which may share what they find (see [`super::reuse`]). `own` is
    /// what they came to by themselves, `image` what they are worth to the image; `origins` tells where each comes from.
    ///
    /// Where paths go on after [`LONG`] edges, `gives_up` is asked now and then, with the number of edges so far. When
    /// it says so there is no outcome: without the long paths the rest would be biased.
    pub fn trace_image(
        &mut self,
        walk: &Walk,
        witness: &mut impl Witness,
        origins: &[Origin],
        gives_up: &dyn Fn(u32) -> bool,
    ) -> Option<Outcomes<'_>> {
        let before = self.rays_traced;
        let guided = walk.guide.is_some();
        let most = if guided { walk.settings.reuse } else { 1 };
        let mut pool = Pool::new(most, self.paths.len());
        if !self.run(walk, witness, &mut pool, gives_up) {
            return None;
        }
        if pool.is_open() {
            self.shared.clone_from(&self.outcomes);
        }
        self.forks.settle(&mut self.outcomes);
        let mut image = &self.outcomes;
        if pool.is_open() {
            self.rays_traced += pool.settle(walk, origins, &mut self.forks, &mut self.shared);
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
        walk: &Walk<'s>,
        witness: &mut impl Witness,
        pool: &mut Pool<'s>,
        gives_up: &dyn Fn(u32) -> bool,
    ) -> bool {
        let mut edges: u32 = 0;
        self.forks.start(self.outcomes.len());
        self.stations.clear();
        self.paths.iter_mut().for_each(|path| path.set_out(walk));
        while !self.paths.is_empty() {
            self.hits.resize(self.rays.len(), Hit::NONE);
            walk.scene.rays.intersect_batch(&self.rays, &mut self.hits);
            self.rays_traced += self.rays.len() as u64;
            match walk.guide {
                Some(_) => self.advance::<true>(walk, witness, pool),
                None => self.advance::<false>(walk, witness, pool),
            }
            self.collect_light(walk.scene, witness);
            edges = edges.saturating_add(1);
            let looks = edges >= LONG && edges % BETWEEN_LOOKS == 0;
            if looks && !self.paths.is_empty() && gives_up(edges) {
                return false;
            }
        }
        true
    }

    /// Rays traced since the wave was made, shadow rays included.
    pub fn rays_traced(&self) -> u64 {
        self.rays_traced
    }

    /// Handles one vertex of every path and keeps those that go on, in order.
    fn advance<'s, const GUIDED: bool>(
        &mut self,
        walk: &Walk<'s>,
        witness: &mut impl Witness,
        pool: &mut Pool<'s>,
    ) {
        self.shadows.clear();
        self.shadow_rays.clear();
        let mut kept = 0;
        for i in 0..self.paths.len() {
            if i % AHEAD == 0 {
                let next = &self.hits[i..(i + AHEAD).min(self.paths.len())];
                walk.scene.surfaces.touch(next);
            }
            // Moved up before it goes on: a copy of what was just written would wait for it.
            self.paths[kept] = self.paths[i];
            let path = &mut self.paths[kept];
            let outcome = &mut self.outcomes[path.slot as usize];
            let watched = Watched {
                outcome,
                forks: &mut self.forks,
                stations: &mut self.stations,
                witness: &mut *witness,
                pool: &mut *pool,
            };
            let (ray, hit) = (&self.rays[i], &self.hits[i]);
            let next = vertex::visit::<GUIDED>(walk, ray, hit, path, watched);
            self.found.extend(next.found);
            self.rays_traced += u64::from(next.rays);
            if let Some((ray, shadow)) = next.shadow {
                self.shadow_rays.push(ray);
                self.shadows.push(shadow);
            }
            let Some(ray) = next.ray else { continue };
            self.rays[kept] = ray;
            kept += 1;
        }
        self.paths.truncate(kept);
        self.rays.truncate(kept);
        for (path, ray) in self.forks.take() {
            self.paths.push(path);
            self.rays.push(ray);
        }
        let accounts = self.forks.accounts();
        self.outcomes.resize(accounts, Outcome::default());
        for (slot, radiance) in self.found.drain(..) {
            self.outcomes[slot as usize].radiance += radiance;
        }
    }

    /// Adds the light of all unblocked shadow rays.
    fn collect_light(&mut self, scene: &Scene, witness: &mut impl Witness) {
        self.blocked.resize(self.shadow_rays.len(), false);
        scene
            .rays
            .occluded_batch(&self.shadow_rays, &mut self.blocked);
        self.rays_traced += self.shadow_rays.len() as u64;
        let mut blocked = self.blocked.iter();
        self.shadows.retain(|_| blocked.next() == Some(&false));
        for shadows in self.shadows.chunks(AHEAD) {
            let offers = shadows.iter().map(|shadow| &shadow.offer.incoming);
            scene.lights.touch(offers);
            for ShadowRay { slot, offer } in shadows {
                let radiance = offer.radiance(&scene.lights);
                self.outcomes[*slot as usize].radiance += radiance;
                witness.lit(*slot, radiance);
            }
        }
    }
}
