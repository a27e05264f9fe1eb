//! One sample of one pixel, vertex by vertex: for finding out where a bad sample went bad.
//!
//! The path takes the same numbers and the same steps as in a render, so its radiance has the same
//! bits. With [`crate::integrate::reuse`] the image has another value: a share of this path and of
//! others.

use crate::accel::{Hit, Ray};
use crate::film::Film;
use crate::film::filter::FilterSampler;
use crate::integrate::bounce::{Met, bounce};
use crate::integrate::camera_sample::{PathNumber, first_ray};
use crate::integrate::context::View;
use crate::integrate::guided_path::GuidedPath;
use crate::integrate::guided_scatter::GuidedOutput;
use crate::integrate::lobe_splitting;
use crate::integrate::path::{FirstHit, Path};
use crate::integrate::progress::{Limits, Observer, PASS_SPP, Progress};
use crate::integrate::reuse::PrefixPool;
use crate::integrate::splitting::SplitPaths;
use crate::integrate::tiles::Job;
use crate::integrate::training::{Learner, train_passes};
use crate::math::{Rgb, Vec3};
use crate::scene::wavefront::Wavefront;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Edges after which a path is left: nobody reads on, and it may have no end.
pub const MOST_STEPS: usize = 100_000;

/// Light that a vertex's own light sample would bring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightBrought {
    /// Radiance that the sample gains if nothing is in between.
    pub radiance: Rgb,
    /// Whether something is.
    pub blocked: bool,
}

/// What one edge of a path met, and what that gave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The way it belongs to: 0 until the path splits.
    pub way: u32,
    /// The ray.
    pub ray: Ray,
    /// What it met.
    pub hit: Hit,
    /// Product of BSDF weights with which the path arrived.
    pub throughput: Rgb,
    /// Density with which the ray's direction was drawn; infinite at the camera and after a delta
    /// lobe.
    pub pdf: f32,
    /// Radiance that the sample gained by what the ray met: emission of the surface or of the sky.
    pub met: Rgb,
    /// Radiance by the light sample that was drawn there.
    pub light: Option<LightBrought>,
    /// Radiance by manifold next-event estimation from there.
    pub manifold: Rgb,
}

impl Step {
    /// Where the ray met something.
    pub fn position(&self) -> Option<Vec3> {
        self.hit.is_some().then(|| self.ray.at(self.hit.t))
    }

    /// Radiance that the sample gained at this vertex.
    pub fn gained(&self) -> Rgb {
        let light = self.light.filter(|l| !l.blocked);
        self.met + self.manifold + light.map_or(Rgb::ZERO, |l| l.radiance)
    }
}

/// One sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Traced {
    /// All edges of its path and of the ways that it was split into, bounce by bounce.
    pub steps: Vec<Step>,
    /// What it came to.
    pub radiance: Rgb,
    /// Its weight by the reconstruction filter.
    pub weight: f32,
}

/// Traces a path of the pixel `(x, y)` of the full film.
pub fn trace_sample(view: &View, [x, y]: [u32; 2], path: PathNumber) -> Traced {
    let filter = FilterSampler::new(view.film.filter);
    let (camera, sampler, weight) = first_ray(view, &filter, [x, y], path);
    let budget = match view.guide {
        Some(_) => lobe_splitting::FROM_CAMERA,
        // Then the steps of a guided path are those of a plain one.
        None => 1.0,
    };
    let path = GuidedPath::new(Path::new(&camera, sampler, 0), budget);
    let (mut split_paths, mut rough_vertices) = (SplitPaths::default(), Vec::new());
    split_paths.start(1);
    let (mut radiances, mut first_hits) = (vec![Rgb::ZERO], Vec::new());
    let mut steps = Vec::new();
    let mut wavefront = Wavefront::default();
    wavefront.push(path, camera.ray);
    while !wavefront.is_empty() && steps.len() < MOST_STEPS {
        let (mut found, mut lit) = (Vec::new(), Vec::new());
        wavefront.advance(view.scene, |path: &mut GuidedPath, ray, hit| {
            let sums = (
                &mut radiances[path.base.accumulator as usize],
                &mut first_hits,
            );
            let output = GuidedOutput {
                split_paths: &mut split_paths,
                rough_vertices: &mut rough_vertices,
                pool: &mut PrefixPool::default(),
                found: &mut found,
                rays: &mut 0,
            };
            let result = step(view, (ray, hit), path, sums, output, &mut steps);
            lit.extend(result.lit);
            result.ray
        });
        wavefront.extend(split_paths.take());
        radiances.resize(split_paths.accumulators(), Rgb::ZERO);
        for (accumulator, radiance) in found.into_iter().chain(lit) {
            radiances[accumulator as usize] += radiance;
        }
    }
    split_paths.reduce(&mut radiances);
    Traced {
        steps,
        radiance: radiances[0],
        weight,
    }
}

/// Ends teaching before the pass that holds a sample.
struct Before {
    sample: u64,
    spp: u64,
    reached: AtomicBool,
}

impl Before {
    /// After `done` samples a pixel: does the next pass reach the sample?
    fn look(&self, done: u64) {
        let pass = done.clamp(1, PASS_SPP).min(self.spp.saturating_sub(done));
        self.reached
            .fetch_or(done + pass > self.sample, Ordering::Relaxed);
    }
}

impl Observer for Before {
    fn pass_done(&self, progress: &Progress, _: &Film) {
        self.look(progress.spp);
    }

    fn should_stop(&self) -> bool {
        self.reached.load(Ordering::Relaxed)
    }
}

/// Teaches `learner` what it knows in a render of `spp` samples a pixel when sample number `sample`
/// is taken, and tells which path of `pixel` that is: the first, where it has several for that
/// sample, or the next. (A render that a limit of time told to learn no longer knows less.)
pub fn train_until(
    view: &View,
    learner: &mut Learner,
    spp: u64,
    pixel: [u32; 2],
    sample: u64,
) -> PathNumber {
    let before = Before {
        sample,
        spp,
        reached: AtomicBool::new(false),
    };
    before.look(0);
    let limits = Limits {
        spp,
        time: None,
        noise: None,
    };
    let mut film = Film::new(view.film);
    let job = Job::new(view, &before, 0);
    let iteration = train_passes(&job, learner, &mut film, &limits, &|| Duration::ZERO);
    let place = film.place(pixel);
    place.map_or(PathNumber::plain(sample), |(tile, i)| {
        iteration.path(tile, i, sample)
    })
}

/// What came of one edge.
struct EdgeResult {
    ray: Option<Ray>,
    /// The light of an unblocked light sample, by accumulator.
    lit: Option<(u32, Rgb)>,
}

/// One edge.
fn step<'s>(
    view: &View<'s>,
    (ray, hit): (&Ray, &Hit),
    path: &mut GuidedPath,
    (radiance, first_hits): (&mut Rgb, &mut Vec<FirstHit>),
    mut output: GuidedOutput<'_, 's>,
    steps: &mut Vec<Step>,
) -> EdgeResult {
    let Path {
        throughput,
        pdf,
        accumulator,
        ..
    } = path.base;
    let found_before = output.found.len();
    let before = std::mem::replace(radiance, Rgb::ZERO);
    let context = view.context();
    let result = bounce(
        &context,
        Met {
            ray,
            hit,
            before: 0.0,
            media: None,
            left: None,
        },
        &mut output,
        path,
        radiance,
        first_hits,
        &mut (),
    );
    let met = *radiance;
    *radiance = before + met;
    let light = result.shadow.map(|(shadow, brought)| {
        let light = LightBrought {
            radiance: brought.offer.radiance(&view.scene.lights),
            blocked: view.scene.is_blocked(&shadow),
        };
        (brought.accumulator, light)
    });
    steps.push(Step {
        way: accumulator,
        ray: *ray,
        hit: *hit,
        throughput,
        pdf,
        met,
        light: light.map(|(_, light)| light),
        manifold: output.found[found_before..]
            .iter()
            .map(|(_, found)| *found)
            .sum(),
    });
    let lit = light.filter(|(_, light)| !light.blocked);
    EdgeResult {
        ray: result.ray,
        lit: lit.map(|(accumulator, light)| (accumulator, light.radiance)),
    }
}
