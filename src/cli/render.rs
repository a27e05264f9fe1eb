//! `twintree render`: from a scene file to an image file.

use super::args::{Accel, RenderArgs};
use super::console::Console;
use super::interrupt::Interrupt;
use super::load::{self, Loaded};
use super::output::Outputs;
use super::preview::Tev;
use super::progress::Watch;
use super::values::Preview;
use super::{Failure, invalid, memory, overrides, threads};
use crate::accel::{Backend, BuildSettings};
use crate::camera::Camera;
use crate::film::Film;
use crate::film::layers::Metadata;
use crate::integrate::PathSettings;
use crate::integrate::learn::{Learned, learn};
use crate::integrate::render::{StoppedBy, Summary, View, render};
use crate::report::scene::triangles;
use crate::report::stats::Stats;
use crate::report::words;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// Seconds that the parts of a command took.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Times {
    load: f64,
    build: f64,
    train: f64,
    write: f64,
}

/// What is rendered, and how.
struct Setting<'a> {
    loaded: &'a Loaded,
    prepared: &'a Prepared,
}

/// Everything that stands before the first sample is taken.
pub(super) struct Prepared {
    /// The scene, built.
    pub scene: Scene,
    /// How paths are traced.
    pub settings: PathSettings,
    /// From where.
    pub camera: Camera,
    /// The field, if one is wanted.
    pub learned: Option<Learned>,
    /// How long that took.
    pub times: Times,
}

/// Renders and writes.
///
/// # Errors
/// When the scene cannot be used or an image cannot be written; after an interrupt, with all written.
pub fn run(args: &RenderArgs, console: &Console) -> Result<(), Failure> {
    if let Some(pixel) = args.doubt.pixel {
        return super::single::run(args, pixel.0);
    }
    let interrupt = Interrupt::listen()?;
    let outputs = Outputs::plan(&args.files, &args.scene.scene)?;
    let mut load_seconds = 0.0;
    let mut loaded = timed(&mut load_seconds, || load::load(&args.scene))?;
    overrides::apply_to_film(args, &mut loaded.description)?;
    let triangles = triangles(&loaded.description);
    tracing::info!(
        "{}: {} shapes, {} triangles, read in {}",
        args.scene.scene.display(),
        loaded.description.shapes.len(),
        words::count(triangles as f64),
        words::time(load_seconds)
    );
    let mut prepared = prepare(args, &mut loaded)?;
    prepared.times.load = load_seconds;
    let mut film = Film::new(&loaded.description.film);
    let setting = Setting {
        loaded: &loaded,
        prepared: &prepared,
    };
    let summary = trace(args, console, &interrupt, &outputs, &setting, &mut film);
    let mut stats = measure(args, &setting, &film, &summary);
    stats.triangles = triangles;
    tracing::info!("{}", stats.sentence());
    invalid::warn(&film);
    if summary.samples == 0 && summary.stopped_by == StoppedBy::Interrupt {
        tracing::warn!("no sample was finished: nothing is written");
        return Err(Failure::Interrupted);
    }
    let mut times = prepared.times;
    let written = timed(&mut times.write, || {
        let exposure = loaded.description.film.exposure;
        outputs.write_images(&film, &args.files, exposure, &metadata(args, &stats))
    });
    stats.write_seconds = times.write;
    stats.peak_memory_bytes = memory::peak_bytes();
    outputs.write_stats(&stats.to_json())?;
    written?;
    if summary.stopped_by == StoppedBy::Interrupt {
        return Err(Failure::Interrupted);
    }
    let left_out = invalid::LeftOut {
        samples: stats.invalid_samples,
        photons: prepared.learned.as_ref().map_or(0, |l| l.counts.invalid),
    };
    invalid::check(args, left_out)
}

/// Builds the scene and learns the field.
pub(super) fn prepare(args: &RenderArgs, loaded: &mut Loaded) -> Result<Prepared, Failure> {
    let mut times = Times::default();
    let scene = timed(&mut times.build, || build(args, loaded))?;
    tracing::debug!(
        "{} holds {}, built in {}",
        scene.rays.name(),
        words::bytes(scene.rays.memory_bytes() as u64),
        words::time(times.build)
    );
    if scene.lights.is_empty() {
        tracing::warn!("nothing in the scene shines: the image will be black");
    }
    if scene.lights.rejected_texels() > 0 {
        tracing::warn!(
            "{} values of environment maps were negative or not finite and count as 0",
            scene.lights.rejected_texels()
        );
    }
    let settings = overrides::path_settings(&args.light, &loaded.description.render);
    let film = &loaded.description.film;
    let camera = Camera::new(&loaded.description.camera, film.width, film.height);
    let plain = View {
        scene: &scene,
        camera: &camera,
        film,
        settings: &settings,
        guide: None,
    };
    let learned = timed(&mut times.train, || train(args, &plain))?;
    Ok(Prepared {
        scene,
        settings,
        camera,
        learned,
        times,
    })
}

fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}

fn build(args: &RenderArgs, loaded: &mut Loaded) -> Result<Scene, Failure> {
    let backend = match args.accel {
        None => Backend::default(),
        Some(Accel::Embree) => Backend::Embree,
        Some(Accel::Obvhs) => Backend::Obvhs,
    };
    let settings = BuildSettings {
        threads: threads::count(),
        ..BuildSettings::default()
    };
    Ok(Scene::build(&mut loaded.description, settings, backend)?)
}

/// Learns the field, if one is wanted, and says what came of it.
fn train(args: &RenderArgs, view: &View) -> Result<Option<Learned>, Failure> {
    let Some(settings) = overrides::learn_settings(&args.light, view.settings) else {
        return Ok(None);
    };
    if view.scene.lights.is_empty() {
        return Ok(None);
    }
    let learned = learn(view, &settings)?;
    tracing::info!(
        "learned from {} photons ({} landings) in {}: {} links in {} cells, {}",
        words::count(learned.counts.emitted as f64),
        words::count(learned.counts.landings as f64),
        words::time(learned.elapsed.as_secs_f64()),
        words::count(learned.stats.links as f64),
        words::count(learned.stats.space_cells as f64),
        words::bytes(learned.guide.field.bytes())
    );
    if learned.counts.invalid > 0 {
        tracing::warn!(
            "{} photons were not finite and were left out",
            learned.counts.invalid
        );
    }
    Ok(Some(learned))
}

fn trace(
    args: &RenderArgs,
    console: &Console,
    interrupt: &Interrupt,
    outputs: &Outputs,
    setting: &Setting,
    film: &mut Film,
) -> Summary {
    let description = &setting.loaded.description;
    let limits = overrides::limits(&args.stop, &description.render);
    let preview = match &args.preview {
        Some(Preview::Tev(address)) => Tev::connect(address, &outputs.title(), film),
        None => None,
    };
    tracing::info!(
        "{} x {} pixels, {} threads",
        film.width(),
        film.height(),
        threads::count()
    );
    let watch = Watch::start(interrupt, console, limits, film, preview);
    interrupt.be_patient();
    let view = View {
        scene: &setting.prepared.scene,
        camera: &setting.prepared.camera,
        film: &description.film,
        settings: &setting.prepared.settings,
        guide: setting.prepared.learned.as_ref().map(|l| &l.guide),
    };
    let summary = render(&view, film, &limits, &watch);
    watch.finish(film);
    summary
}

fn measure(args: &RenderArgs, setting: &Setting, film: &Film, summary: &Summary) -> Stats {
    let Setting { loaded, prepared } = setting;
    let Prepared { scene, times, .. } = prepared;
    let field = prepared.learned.as_ref().map(|l| &l.guide.field);
    // A render of no time at all has no rate to speak of, and must not divide by zero.
    let seconds = summary.elapsed.max(Duration::from_nanos(1)).as_secs_f64();
    Stats {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: args.scene.scene.display().to_string(),
        width: film.width(),
        height: film.height(),
        seed: args.light.seed,
        threads: threads::count(),
        accel: scene.rays.name(),
        stopped_by: match summary.stopped_by {
            StoppedBy::Samples => "samples",
            StoppedBy::Time => "time",
            StoppedBy::Noise => "noise",
            StoppedBy::Interrupt => "interrupt",
        },
        spp: summary.spp,
        samples: summary.samples,
        samples_per_second: summary.samples as f64 / seconds,
        rays: summary.rays,
        rays_per_second: summary.rays as f64 / seconds,
        noise: summary.noise,
        invalid_samples: film.invalid_samples(),
        load_seconds: times.load,
        build_seconds: times.build,
        train_seconds: times.train,
        field_memory_bytes: field.map_or(0, |f| f.bytes()),
        render_seconds: summary.elapsed.as_secs_f64(),
        write_seconds: 0.0,
        peak_memory_bytes: None,
        accel_memory_bytes: scene.rays.memory_bytes() as u64,
        texture_memory_bytes: loaded.textures().bytes,
        triangles: 0,
        warnings: loaded.description.warnings.clone(),
    }
}

/// What a file says about how it was made.
fn metadata(args: &RenderArgs, stats: &Stats) -> Metadata {
    let words = std::env::args_os().skip(1);
    let words: Vec<_> = words.map(|w| w.to_string_lossy().into_owned()).collect();
    Metadata {
        scene: args.scene.scene.display().to_string(),
        settings: words.join(" "),
        spp: stats.spp,
        seconds: stats.render_seconds,
    }
}
