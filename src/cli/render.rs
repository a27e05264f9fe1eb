//! `twintree render`: from a scene file to an image file.

use super::carried::Carried;
use super::checkpoint::Checkpoint;
use super::console::Console;
use super::denoising::Denoising;
use super::error_track::ErrorTrack;
use super::finish::Done;
use super::identity::{self, Fingerprints};
use super::interrupt::Interrupt;
use super::load::{self, Input, Loaded};
use super::output::Outputs;
use super::preview::{Preview, Tev};
use super::progress::Watch;
use super::render_args::RenderArgs;
use super::waiting::Waiting;
use super::{Failure, frames, invalid, learning, settings, threads, view};
use crate::camera::Camera;
use crate::film::Film;
use crate::integrate::View;
use crate::integrate::progress::{Limits, MIN_SPP_FOR_NOISE, PASS_SPP, Spent, StoppedBy, Summary};
use crate::integrate::render::resume;
use crate::integrate::training::Learner;
use crate::report::stats::Stats;
use crate::report::totals::triangles;
use crate::report::words;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// Seconds that the parts of a command took.
#[derive(Clone, Copy, Debug, Default)]
struct Times {
    load: f64,
    build: f64,
    train: f64,
}

/// What is rendered, from where on, and until when.
struct Setting<'a> {
    view: View<'a>,
    limits: Limits,
    done: &'a Done<'a>,
    track: Option<&'a ErrorTrack>,
    /// What earlier goes have cost.
    before: Spent,
}

/// Renders and writes.
///
/// # Errors
/// When the scene cannot be used or an image cannot be written; after an interrupt, with all
/// written.
pub fn run(args: &RenderArgs, console: &Console, interrupt: &Interrupt) -> Result<(), Failure> {
    if let Some(pixel) = args.doubt.pixel {
        return super::single::run(args, pixel);
    }
    if let Some(list) = &args.frames {
        let mut carried = Carried::wanted();
        let each = |one: &RenderArgs| render(one, console, interrupt, &mut carried);
        return frames::run(args, list, interrupt, each);
    }
    render(args, console, interrupt, &mut Carried::default())
}

/// Renders one image and writes it.
///
/// # Errors
/// As [`run`].
fn render(
    args: &RenderArgs,
    console: &Console,
    interrupt: &Interrupt,
    carried: &mut Carried,
) -> Result<(), Failure> {
    let input = Input::of(&args.scene)?;
    let outputs = Outputs::of_render(args, &input)?;
    let denoising = match args.parts.shard {
        // A part is no picture yet.
        Some(_) => None,
        None => Denoising::wanted(&args.files, console, interrupt)?,
    };
    warn_of_shard(args);
    let mut times = Times::default();
    let (mut loaded, triangles) = read(args, &input, &mut times)?;
    outputs.spare("an image of the scene", &loaded.image_files())?;
    let field = learning::wanted_file(&args.guide)?;
    let fingerprint = match args.parts.wanted() || field.is_some() {
        true => Some(loaded.fingerprint()?),
        false => None,
    };
    if let (Some(field), Some(scene)) = (&field, fingerprint) {
        field.check(scene)?;
    }
    let (scene, before_learner) = match carried.take(&mut loaded)? {
        Some(known) => known,
        None => (timed(&mut times.build, || loaded.build(&args.rays))?, None),
    };
    let description = &loaded.description;
    let (width, height) = (description.film.width, description.film.height);
    let settings = settings::of_render(args, &description.render);
    let limits = settings::limits(&args.stop, &description.render);
    let camera = Camera::new(&description.camera, width, height);
    view::warn(&scene, &camera, &description.camera, &description.film);
    let plain = View {
        scene: &scene,
        camera: &camera,
        film: &description.film,
        settings: &settings,
        guide: None,
    };
    let way = learning::decide(&args.guide, &plain, &limits);
    let record = fingerprint.filter(|_| args.parts.wanted()).map(|scene| {
        let field = field.as_ref().map(|f| f.fingerprint);
        let of = Fingerprints { scene, field };
        identity::record((args, way), &plain, &limits, of, triangles)
    });
    let mut film = identity::film(args, &description.film)?;
    let track = match &args.reference {
        Some(path) => Some(ErrorTrack::against(path, &description.film)?),
        None => None,
    };
    let checkpoint = Checkpoint::wanted(&args.parts, outputs.first(), record.as_ref());
    let Some(before) = go_on(args, &outputs, checkpoint.as_ref(), &mut film)? else {
        return Ok(());
    };
    let waiting = Waiting::for_learning(console, args.guide.learn.photons);
    let mut guiding = timed(&mut times.train, || {
        learning::guiding((&args.guide, way), (field, before_learner), &plain, &limits)
    })?;
    drop(waiting);
    let photons = guiding.elapsed();
    let mut learner = guiding.learner.take();
    let done = Done {
        args,
        outputs: &outputs,
        checkpoint: checkpoint.as_ref(),
        denoising,
        record,
        exposure: description.film.exposure,
    };
    let setting = Setting {
        view: View {
            guide: guiding.prepared(),
            ..plain
        },
        limits,
        done: &done,
        track: track.as_ref(),
        before: Spent {
            time: before.time + photons,
            ..before
        },
    };
    let learning = learner.as_mut();
    let summary = trace((console, interrupt), &setting, learning, &mut film);
    guiding.learner = learner;
    if let Some(learner) = &guiding.learner {
        learning::describe(learner);
        times.train = learner.elapsed().as_secs_f64();
    }
    let mut stats = measure(args, &scene, &loaded, &film, &summary);
    (stats.triangles, stats.load_seconds) = (triangles, times.load);
    (stats.build_seconds, stats.train_seconds) = (times.build, times.train);
    stats.settings = identity::settings((args, way), &plain, &limits);
    stats.field_memory_bytes = guiding.bytes();
    if let Some(track) = track {
        track.finish(&film, &summary, &mut stats);
    }
    stats.field = guiding.learner.as_ref().map(Learner::stats);
    stats.learning_memory_bytes = guiding.learner.as_ref().map_or(0, Learner::peak_bytes);
    stats.trial = guiding.learner.as_ref().and_then(Learner::verdict);
    tell(console, &stats, &summary);
    invalid::warn(&film);
    if args.frames.is_some() && summary.stopped_by == StoppedBy::Interrupt {
        return Err(frames::leave_out(&outputs));
    }
    done.write(&film, &summary, &mut stats)?;
    let left_out = invalid::LeftOut {
        samples: stats.invalid_samples,
        photons: guiding.learner.as_ref().map_or(0, |l| l.counts().invalid),
    };
    carried.keep(scene, guiding.learner.take());
    invalid::check(args, left_out)
}

/// Says what came of a render.
fn tell(console: &Console, stats: &Stats, summary: &Summary) {
    console.tell(&stats.sentence());
    if summary.noise.is_some_and(|noise| !noise.is_reliable()) {
        console.tell(
            "the true noise may be larger: a few pixels have most of it, by light that others still \
             miss",
        );
    }
    if let Some(sentence) = stats.error_sentence() {
        console.tell(&sentence);
    }
}

/// Fills the film from the checkpoint, if that is wanted, and says what it has cost so far; `None`
/// if there is nothing left to do.
fn go_on(
    args: &RenderArgs,
    outputs: &Outputs,
    checkpoint: Option<&Checkpoint>,
    film: &mut Film,
) -> Result<Option<Spent>, Failure> {
    let Some(checkpoint) = checkpoint.filter(|_| args.parts.resume) else {
        return Ok(Some(Spent::default()));
    };
    if outputs.has_part(checkpoint.record()) {
        checkpoint.remove();
        return Ok(None);
    }
    Ok(Some(checkpoint.load(film)?.unwrap_or_default()))
}

/// A shard that is interrupted leaves nothing: better said before than after.
fn warn_of_shard(args: &RenderArgs) {
    if args.parts.shard.is_some() && !args.parts.saves() {
        tracing::info!(
            "an interrupted shard leaves nothing: with --checkpoint 10m it can go on later"
        );
    }
}

fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *seconds = start.elapsed().as_secs_f64();
    result
}

/// Reads the scene, with what the command line changes about it; how many triangles it has.
fn read(args: &RenderArgs, input: &Input, times: &mut Times) -> Result<(Loaded, u64), Failure> {
    let mut loaded = timed(&mut times.load, || {
        load::load(&args.scene, input, Some(load::Picture::of(args)))
    })?;
    settings::apply_to_film(args, &mut loaded.description)?;
    let triangles = triangles(&loaded.description);
    tracing::info!(
        "{}: {} shapes, {} triangles, read in {}",
        args.scene.title(),
        loaded.description.shapes.len(),
        words::count(triangles as f64),
        words::time(times.load)
    );
    Ok((loaded, triangles))
}

fn trace(
    (console, interrupt): (&Console, &Interrupt),
    setting: &Setting,
    learner: Option<&mut Learner>,
    film: &mut Film,
) -> Summary {
    let done = setting.done;
    let preview = match &done.args.preview {
        Some(Preview::Tev(address)) => {
            Tev::connect(address, &done.outputs.first().display().to_string(), film)
        }
        None => None,
    };
    tracing::info!(
        "{} x {} pixels, {} threads",
        film.width(),
        film.height(),
        threads::count()
    );
    let limits = setting.limits;
    if let Some(noise) = limits.noise {
        console.tell(&format!(
            "stops at a noise of {noise}: after each pass of up to {PASS_SPP} samples a pixel, from \
             {MIN_SPP_FOR_NOISE} on, the variance among a pixel's samples tells the noise and its error"
        ));
    }
    let goes = (done, setting.before.time);
    interrupt.be_patient();
    let watch = Watch::start(interrupt, console, limits, film, preview, goes);
    let watch = watch.measuring(setting.track);
    let summary = resume(
        &setting.view,
        learner,
        film,
        &limits,
        setting.before,
        &watch,
    );
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
        noise: summary.noise.map(|n| n.value),
        noise_error: summary.noise.map(|n| n.error),
        noise_worst: summary.noise.map(|n| n.worst),
        invalid_samples: film.invalid_samples(),
        render_seconds: summary.elapsed.as_secs_f64(),
        accel_memory_bytes: scene.rays.memory_bytes() as u64,
        texture_memory_bytes: loaded.textures().bytes,
        warnings: loaded.description.warnings.clone(),
        // What the stages took is filled in where it is known.
        ..Stats::default()
    }
}
