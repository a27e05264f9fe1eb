//! `twintree render`: from a scene file to an image file.

use super::args::{Accel, AccelBuild, RenderArgs};
use super::console::Console;
use super::interrupt::Interrupt;
use super::load::{self, Loaded, Subject};
use super::output::Outputs;
use super::preview::Tev;
use super::progress::Watch;
use super::values::Preview;
use super::{Failure, budget, memory, overrides, threads};
use crate::accel::{Backend, BuildQuality, BuildSettings};
use crate::camera::Camera;
use crate::film::Film;
use crate::film::layers::Metadata;
use crate::integrate::PathSettings;
use crate::integrate::guiding::Guide;
use crate::integrate::learn::learn;
use crate::integrate::render::{StoppedBy, Summary, View, render};
use crate::report::scene::triangles;
use crate::report::stats::Stats;
use crate::report::words;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// Seconds that the parts of a command took.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    load: f64,
    build: f64,
    train: f64,
    write: f64,
}

/// What is rendered, and how.
struct Setting<'a> {
    scene: &'a Scene,
    loaded: &'a Loaded,
    path: &'a PathSettings,
    guide: Option<&'a Guide>,
}

/// Renders and writes.
///
/// # Errors
/// When the scene cannot be used or an image cannot be written; after an interrupt, with all written.
pub fn run(args: &RenderArgs, console: &Console) -> Result<(), Failure> {
    let interrupt = Interrupt::listen()?;
    let subject = Subject::of(&args.scene)?;
    let outputs = Outputs::plan(&args.files, subject.first_path())?;
    let mut times = Times::default();
    let mut loaded = timed(&mut times.load, || {
        load::load(&args.scene, &subject, Some(&args.picture))
    })?;
    overrides::apply_to_film(args, &mut loaded.description)?;
    let triangles = triangles(&loaded.description);
    tracing::info!(
        "{}: {} shapes, {} triangles, read in {}",
        args.scene.title(),
        loaded.description.shapes.len(),
        words::count(triangles as f64),
        words::time(times.load)
    );
    let scene = timed(&mut times.build, || build(args, &mut loaded))?;
    tracing::debug!(
        "{} holds {}, built in {}",
        scene.rays.name(),
        words::bytes(scene.rays.memory_bytes() as u64),
        words::time(times.build)
    );
    let mut film = Film::new(&loaded.description.film);
    let settings = overrides::path_settings(&args.light, &loaded.description.render);
    let camera = Camera::new(
        &loaded.description.camera,
        loaded.description.film.width,
        loaded.description.film.height,
    );
    let plain = View {
        scene: &scene,
        camera: &camera,
        film: &loaded.description.film,
        settings: &settings,
        guide: None,
    };
    let guide = timed(&mut times.train, || train(args, &plain))?;
    let view = Setting {
        scene: &scene,
        loaded: &loaded,
        path: &settings,
        guide: guide.as_ref(),
    };
    let summary = trace(args, console, &interrupt, &outputs, &view, &mut film);
    let mut stats = measure(args, &scene, &loaded, &film, &summary);
    (stats.triangles, stats.load_seconds, stats.build_seconds) =
        (triangles, times.load, times.build);
    (stats.train_seconds, stats.field_memory_bytes) =
        (times.train, guide.as_ref().map_or(0, |g| g.field.bytes()));
    tracing::info!("{}", stats.sentence());
    warn_of_invalid_samples(&film);
    if summary.samples == 0 {
        tracing::warn!("no sample was finished: nothing is written");
        return Err(Failure::Interrupted);
    }
    let written = timed(&mut times.write, || {
        let exposure = loaded.description.film.exposure;
        outputs.write_images(&film, &args.files, exposure, &metadata(args, &stats))
    });
    stats.write_seconds = times.write;
    stats.peak_memory_bytes = memory::peak_bytes();
    outputs.write_stats(&stats.to_json())?;
    written?;
    match summary.stopped_by {
        StoppedBy::Interrupt => Err(Failure::Interrupted),
        _ => Ok(()),
    }
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
    let load = budget::Load {
        triangles: triangles(&loaded.description),
        instances: loaded.description.instances.len() as u64,
    };
    let way = budget::choose(args.accel_build, backend, load, memory::available_bytes())?;
    if way == AccelBuild::Compact && args.accel_build.is_none() {
        tracing::info!("memory is short: the ray tracer's trees are built small");
    }
    let settings = BuildSettings {
        quality: match way {
            AccelBuild::Fast => BuildQuality::Fast,
            AccelBuild::Balanced | AccelBuild::Compact => BuildQuality::Balanced,
            AccelBuild::High => BuildQuality::High,
        },
        compact: way == AccelBuild::Compact,
        threads: threads::count(),
        ..BuildSettings::default()
    };
    Ok(Scene::build(&mut loaded.description, settings, backend)?)
}

/// Learns the field, if one is wanted, and says what came of it.
fn train(args: &RenderArgs, view: &View) -> Result<Option<Guide>, Failure> {
    let Some(settings) = overrides::learn_settings(&args.light, view.settings) else {
        return Ok(None);
    };
    if view.scene.lights.is_empty() {
        tracing::warn!("nothing shines: there is nothing to learn");
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
    Ok(Some(learned.guide))
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
    let camera = Camera::new(
        &description.camera,
        description.film.width,
        description.film.height,
    );
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
        scene: setting.scene,
        camera: &camera,
        film: &description.film,
        settings: setting.path,
        guide: setting.guide,
    };
    let summary = render(&view, film, &limits, &watch);
    watch.finish(film);
    summary
}

fn measure(
    args: &RenderArgs,
    scene: &Scene,
    loaded: &Loaded,
    film: &Film,
    summary: &Summary,
) -> Stats {
    // A render of no time at all has no rate to speak of, and must not divide by zero.
    let seconds = summary.elapsed.max(Duration::from_nanos(1)).as_secs_f64();
    Stats {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: args.scene.title(),
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
        load_seconds: 0.0,
        build_seconds: 0.0,
        train_seconds: 0.0,
        field_memory_bytes: 0,
        render_seconds: summary.elapsed.as_secs_f64(),
        write_seconds: 0.0,
        peak_memory_bytes: None,
        accel_memory_bytes: scene.rays.memory_bytes() as u64,
        texture_memory_bytes: loaded.textures().bytes,
        triangles: 0,
        warnings: loaded.description.warnings.clone(),
    }
}

fn warn_of_invalid_samples(film: &Film) {
    let Some((x, y, sample)) = film.first_invalid() else {
        return;
    };
    tracing::warn!(
        "{} samples were not finite and were left out; the first is sample {sample} of pixel {x},{y}",
        film.invalid_samples()
    );
}

/// What a file says about how it was made.
fn metadata(args: &RenderArgs, stats: &Stats) -> Metadata {
    let words = std::env::args_os().skip(1);
    let words: Vec<_> = words.map(|w| w.to_string_lossy().into_owned()).collect();
    Metadata {
        scene: args.scene.title(),
        settings: words.join(" "),
        spp: stats.spp,
        seconds: stats.render_seconds,
    }
}
