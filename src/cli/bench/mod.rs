//! `twintree bench`: measurements of parts of the program.

pub mod args;
mod closed;
mod rays;
mod scale;
mod subject;

use self::args::{Bench, BenchAccelArgs, QUALITIES};
use self::rays::{Kind, RaySets};
use self::subject::Subject;
use super::{Failure, console, output, targets, threads};
use crate::accel::{self, Backend, BuildSettings, Hit, Ray, RayQuery};
use crate::report::accel::{AccelBench, Misses, Rates, Tracer};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// Measures what was asked for.
///
/// # Errors
/// When the scene cannot be used or a file cannot be written.
pub fn run(what: &Bench) -> Result<(), Failure> {
    match what {
        Bench::Accel(args) => accel(args),
        Bench::Scale(args) => scale::run(args),
    }
}

/// Rays that are handed to a tracer at once: as many as a wave of the renderer has.
const BATCH: usize = 4096;

/// Builds and traces with every configuration, prints the table.
fn accel(args: &BenchAccelArgs) -> Result<(), Failure> {
    if let Some(path) = &args.rates.json {
        targets::try_target(path)?;
    }
    let subject = Subject::load(&args.scene)?;
    let sets = RaySets::of(&subject, args.rates.rays)?;
    let inside = closed::rays_inside(&subject, args.rates.rays as usize);
    let mut report = AccelBench {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: args.scene.title(),
        triangles: subject.triangles,
        threads: threads::count(),
        rays: sets.camera.len(),
        rays_inside: inside.uniform.len(),
        closed_meshes: inside.meshes,
        shadow_blocked: sets.blocked_share(&*subject.scene.rays),
        tracers: Vec::new(),
    };
    for (backend, settings) in configurations(args) {
        let start = Instant::now();
        let tracer = accel::build(subject.world.clone(), settings, None, backend)?;
        let build_seconds = start.elapsed().as_secs_f64();
        let (quality, mode) = (
            QUALITIES.word(&settings.quality),
            mode_name(settings.robust),
        );
        tracing::info!("{}, {quality}, {mode}", tracer.name());
        report.tracers.push(Tracer {
            name: tracer.name(),
            quality,
            mode,
            build_seconds,
            memory_bytes: tracer.memory_bytes() as u64,
            single: rates(&*tracer, &sets, args.rates.seconds, false),
            all: rates(&*tracer, &sets, args.rates.seconds, true),
            misses: inside.misses(&*tracer),
        });
    }
    console::print_result(&report.to_table())?;
    output::write_if_wanted(args.rates.json.as_deref(), &report.to_json())
}

/// Every backend, quality and mode. The tree in Rust is always watertight: it has one mode.
fn configurations(args: &BenchAccelArgs) -> Vec<(Backend, BuildSettings)> {
    let mut list = Vec::new();
    for backend in backends(&args.rates.accel) {
        for (_, quality, _) in QUALITIES.0.iter().filter(|q| args.quality.contains(&q.1)) {
            for robust in [false, true] {
                let settings = BuildSettings {
                    quality: *quality,
                    robust,
                    compact: false,
                    threads: threads::count(),
                    memory: 0,
                };
                if robust || backend == Backend::Embree {
                    list.push((backend, settings));
                }
            }
        }
    }
    list
}

/// The ray tracers that are asked for: all there are if none is named.
fn backends(named: &[Backend]) -> impl Iterator<Item = Backend> {
    let asked = |backend: &Backend| match named.is_empty() {
        true => *backend != Backend::Embree || cfg!(feature = "embree"),
        false => named.contains(backend),
    };
    [Backend::Embree, Backend::Obvhs].into_iter().filter(asked)
}

fn mode_name(robust: bool) -> &'static str {
    if robust { "robust" } else { "fast" }
}

/// Rays a second of each kind.
fn rates(tracer: &dyn RayQuery, sets: &RaySets, seconds: f64, all_threads: bool) -> Rates {
    let of = |kind| rate(tracer, sets.of_kind(kind), kind, seconds, all_threads);
    Rates {
        camera: of(Kind::Camera),
        shadow: of(Kind::Shadow),
        diffuse: of(Kind::Diffuse),
    }
}

/// Fewest passes over the rays that a rate is made of.
const PASSES: usize = 3;

/// The median rate of as many passes as fit into the time.
fn rate(tracer: &dyn RayQuery, rays: &[Ray], kind: Kind, seconds: f64, all_threads: bool) -> f64 {
    let trace = |batch: &[Ray]| match kind {
        Kind::Shadow => {
            let mut blocked = [false; BATCH];
            tracer.occluded_batch(batch, &mut blocked[..batch.len()]);
            black_box(&blocked);
        }
        Kind::Camera | Kind::Diffuse => {
            let mut hits = [Hit::NONE; BATCH];
            tracer.intersect_batch(batch, &mut hits[..batch.len()]);
            black_box(&hits);
        }
    };
    let begin = Instant::now();
    let mut passes = Vec::new();
    while passes.len() < PASSES || begin.elapsed().as_secs_f64() < seconds {
        let start = Instant::now();
        if all_threads {
            rays.par_chunks(BATCH).for_each(trace);
        } else {
            rays.chunks(BATCH).for_each(trace);
        }
        passes.push(start.elapsed().as_secs_f64());
    }
    passes.sort_by(f64::total_cmp);
    rays.len() as f64 / passes[passes.len() / 2]
}

impl closed::InsideRays {
    /// Rays from inside that come out without meeting anything; `None` without a closed mesh.
    fn misses(&self, tracer: &dyn RayQuery) -> Option<Misses> {
        let share = |rays: &[Ray]| {
            let missed = rays.par_iter().filter(|r| !tracer.intersect(r).is_some());
            missed.count() as f64 / rays.len() as f64
        };
        (!self.uniform.is_empty()).then(|| Misses {
            uniform: share(&self.uniform),
            edges: share(&self.edges),
            vertices: share(&self.vertices),
        })
    }
}
