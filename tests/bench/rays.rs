//! How much of a render is bare ray tracing.
//!
//! `cargo bench --bench rays -- SCENE.xml --width 160 --spp 16 [OPTIONS OF twintree render]`
//!
//! Renders once, records every ray of the same render, and traces the recorded rays again with
//! nothing around them: in the batches they came in (packets of sixteen for Embree), and one by one.
//! One thread, seconds of the processor, medians of three; learning is part of the render.

use clap::Parser;
use rustix::time::{ClockId, clock_gettime};
use std::sync::{Arc, Mutex, OnceLock};
use twintree::accel::{Bounds, BuildSettings, Hit, Ray, RayQuery};
use twintree::cli::args::{Cli, Command};
use twintree::cli::input::Input;
use twintree::cli::load::{self, Loaded, Picture};
use twintree::cli::prepared::Prepared;
use twintree::cli::render_args::RenderArgs;
use twintree::cli::settings;
use twintree::film::Film;
use twintree::integrate::progress::{Observer, Progress, Spent};
use twintree::scene::Scene;

const ROUNDS: usize = 3;

/// Rays that were traced together.
enum Batch {
    Closest(Vec<Ray>),
    Shadow(Vec<Ray>),
}

impl Batch {
    fn len(&self) -> usize {
        let (Self::Closest(rays) | Self::Shadow(rays)) = self;
        rays.len()
    }
}

/// Traces as another does, and keeps the rays.
#[derive(Clone, Default)]
struct Recorder {
    tracer: Arc<OnceLock<Box<dyn RayQuery>>>,
    kept: Arc<Mutex<Vec<Batch>>>,
}

impl Recorder {
    /// Takes the place of a scene's ray tracer.
    fn take_place(scene: &mut Scene) -> Self {
        let recorder = Self::default();
        let tracer = std::mem::replace(&mut scene.rays, Box::new(recorder.clone()));
        assert!(recorder.tracer.set(tracer).is_ok());
        recorder
    }

    fn tracer(&self) -> &dyn RayQuery {
        &**self.tracer.get().expect("set when it took the place")
    }

    fn keep(&self, batch: Batch) {
        self.kept.lock().unwrap().push(batch);
    }
}

impl RayQuery for Recorder {
    fn intersect(&self, ray: &Ray) -> Hit {
        self.keep(Batch::Closest(vec![*ray]));
        self.tracer().intersect(ray)
    }
    fn occluded(&self, ray: &Ray) -> bool {
        self.keep(Batch::Shadow(vec![*ray]));
        self.tracer().occluded(ray)
    }
    fn intersect_batch(&self, rays: &[Ray], hits: &mut [Hit]) {
        self.keep(Batch::Closest(rays.to_vec()));
        self.tracer().intersect_batch(rays, hits);
    }
    fn occluded_batch(&self, rays: &[Ray], blocked: &mut [bool]) {
        self.keep(Batch::Shadow(rays.to_vec()));
        self.tracer().occluded_batch(rays, blocked);
    }
    fn bounds(&self) -> Bounds {
        self.tracer().bounds()
    }
    fn memory_bytes(&self) -> usize {
        self.tracer().memory_bytes()
    }
    fn settings(&self) -> BuildSettings {
        self.tracer().settings()
    }
    fn name(&self) -> String {
        self.tracer().name()
    }
}

/// Renders without a word to anybody.
struct Silent;

impl Observer for Silent {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

/// Seconds of the processor that some work takes.
fn seconds(work: impl FnOnce()) -> f64 {
    let now = || {
        let t = clock_gettime(ClockId::ProcessCPUTime);
        t.tv_sec as f64 + 1e-9 * t.tv_nsec as f64
    };
    let start = now();
    work();
    now() - start
}

fn median(work: impl Fn() -> f64) -> f64 {
    let mut times: [f64; ROUNDS] = std::array::from_fn(|_| work());
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}

/// Learns and renders; the seconds of the processor.
fn render(args: &RenderArgs, scene: &Scene, loaded: &Loaded) -> f64 {
    let prepared = Prepared::new(args, scene, &loaded.description);
    let mut film = Film::new(prepared.film);
    seconds(|| {
        let mut guiding = prepared.guiding(None, None).expect("the scene has light");
        prepared.trace(&mut guiding, &mut film, Spent::default(), &Silent);
    })
}

/// Traces recorded rays alone, in their batches or one by one.
fn replay(tracer: &dyn RayQuery, batches: &[Batch], whole: bool) -> f64 {
    let most = batches.iter().map(Batch::len).max().unwrap_or(0);
    let (mut hits, mut blocked) = (vec![Hit::NONE; most], vec![false; most]);
    seconds(|| {
        for batch in batches {
            match (batch, whole) {
                (Batch::Closest(rays), true) => {
                    tracer.intersect_batch(rays, &mut hits[..rays.len()]);
                }
                (Batch::Shadow(rays), true) => {
                    tracer.occluded_batch(rays, &mut blocked[..rays.len()]);
                }
                (Batch::Closest(rays), false) => {
                    hits.iter_mut()
                        .zip(rays)
                        .for_each(|(h, r)| *h = tracer.intersect(r));
                }
                (Batch::Shadow(rays), false) => {
                    blocked
                        .iter_mut()
                        .zip(rays)
                        .for_each(|(b, r)| *b = tracer.occluded(r));
                }
            }
        }
        std::hint::black_box((&hits, &blocked));
    })
}

fn main() {
    // Cargo adds its own word.
    let words = std::env::args().skip(1).filter(|word| word != "--bench");
    let words = ["twintree".to_string(), "render".into()]
        .into_iter()
        .chain(words);
    let Command::Render(args) = Cli::parse_from(words).command else {
        unreachable!("the word is \"render\"");
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    pool.expect("one thread").install(|| measure(&args));
}

fn measure(args: &RenderArgs) {
    let input = Input::of(&args.scene).expect("a scene");
    let loaded = load::load(&args.scene, &input, Some(Picture::of(args)));
    let mut loaded = loaded.unwrap_or_else(|e| panic!("{e:?}"));
    settings::apply_to_film(args, &mut loaded.description).expect("a film");
    let mut scene = loaded.build(&args.rays).unwrap_or_else(|e| panic!("{e:?}"));
    let whole = median(|| render(args, &scene, &loaded));
    let recorder = Recorder::take_place(&mut scene);
    render(args, &scene, &loaded);
    let batches = recorder.kept.lock().unwrap();
    let rays: usize = batches.iter().map(Batch::len).sum();
    println!(
        "{}: {:.2} million rays, {whole:.2} s",
        args.scene.title(),
        rays as f64 * 1e-6
    );
    for (name, by_batch) in [("in their batches", true), ("one by one", false)] {
        let bare = median(|| replay(recorder.tracer(), &batches, by_batch));
        let share = 100.0 * bare / whole;
        println!("  rays alone, {name}: {bare:.2} s, {share:.0} % of the render");
    }
}
