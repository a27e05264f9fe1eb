//! `twintree render`: from a scene file to an image file.

use super::carried::Carried;
use super::checkpoint::Checkpoint;
use super::console::Console;
use super::denoising::Denoising;
use super::error_track::ErrorTrack;
use super::field_file::{self, Opened};
use super::finish::Done;
use super::identity::{self, Fingerprints};
use super::input::Input;
use super::interrupt::Interrupt;
use super::invalid::LeftOut;
use super::load::{self, Loaded};
use super::output::Outputs;
use super::prepared::{Prepared, Times};
use super::preview::{Preview, Tev};
use super::progress::Watch;
use super::render_args::RenderArgs;
use super::waiting::Waiting;
use super::{Failure, frames, invalid, output, settings, threads};
use crate::film::Film;
use crate::film::part::Record;
use crate::integrate::progress::{MIN_SPP_FOR_NOISE, PASS_SPP, Spent, StoppedBy, Summary};
use crate::report::stats::Stats;
use crate::report::totals::triangles;
use crate::report::words;
use std::time::Instant;

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
    // A part is no picture yet.
    let whole = args.parts.shard.is_none();
    let denoising = whole.then(|| Denoising::wanted(&args.files, console, interrupt));
    let denoising = denoising.transpose()?.flatten();
    warn_of_shard(args);
    let mut times = Times::default();
    let mut loaded = read(args, &input, &mut times)?;
    outputs.spare("an image of the scene", &loaded.image_files())?;
    let (field, fingerprint) = check_field(args, &loaded)?;
    let (scene, before_learner) = match carried.take(&mut loaded)? {
        Some(known) => known,
        None => (timed(&mut times.build, || loaded.build(&args.rays))?, None),
    };
    let prepared = Prepared::new(args, &scene, &loaded.description);
    let record = record(&prepared, (args, fingerprint, field.as_ref()), &times);
    let mut film = identity::film(args, prepared.film)?;
    let reference = args.reference.as_ref();
    let track = reference.map(|path| ErrorTrack::against(path, prepared.film));
    let track = track.transpose()?;
    let checkpoint = Checkpoint::wanted(&args.parts, outputs.first(), record.as_ref());
    let Some(before) = go_on(args, &outputs, checkpoint.as_ref(), &mut film)? else {
        return Ok(());
    };
    let waiting = Waiting::for_learning(console, args.guide.learn.photons);
    let mut guiding = timed(&mut times.train, || prepared.guiding(field, before_learner))?;
    drop(waiting);
    let done = Done {
        args,
        outputs: &outputs,
        checkpoint: checkpoint.as_ref(),
        denoising,
        record,
        exposure: prepared.film.exposure,
    };
    let before = guiding.spent_after(before);
    let watched = (&done, track.as_ref(), before);
    let watch = watch((console, interrupt), &prepared, watched, &film);
    let summary = prepared.trace(&mut guiding, &mut film, before, &watch);
    watch.finish(&film);
    if whole {
        // What began with the first tile, or why the render was stopped.
        output::load_library()?;
    }
    let mut stats = prepared.stats(&loaded, (&film, &summary), &guiding, times);
    if let Some(track) = track {
        track.finish(&film, &summary, &mut stats);
    }
    tell(console, &stats, &summary);
    invalid::warn(&film);
    if args.frames.is_some() && summary.stopped_by == StoppedBy::Interrupt {
        return Err(frames::leave_out(&outputs));
    }
    done.write(&film, &summary, &mut stats)?;
    let left_out = LeftOut::of(&stats, guiding.learner.as_ref());
    carried.keep(scene, guiding.learner.take());
    invalid::check(args, left_out)
}

/// What makes this render that render and no other, where parts or checkpoints need to know.
fn record(
    prepared: &Prepared,
    (args, fingerprint, field): (&RenderArgs, Option<u64>, Option<&Opened>),
    times: &Times,
) -> Option<Record> {
    let scene = fingerprint.filter(|_| args.parts.wanted())?;
    let field = field.map(|f| f.fingerprint);
    let of = Fingerprints { scene, field };
    let (view, limits) = (&prepared.view(), &prepared.limits);
    let how = (args, prepared.way);
    Some(identity::record(how, view, limits, of, times.triangles))
}

/// The field that is to guide, if it is in a file, once it is known to be of the scene; the scene's
/// fingerprint, where that is asked for.
fn check_field(
    args: &RenderArgs,
    loaded: &Loaded,
) -> Result<(Option<Opened>, Option<u64>), Failure> {
    let field = field_file::wanted_file(&args.guide)?;
    let fingerprint = match args.parts.wanted() || field.is_some() {
        true => Some(loaded.fingerprint()?),
        false => None,
    };
    if let (Some(field), Some(scene)) = (&field, fingerprint) {
        field.check(scene)?;
    }
    Ok((field, fingerprint))
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

/// Reads the scene, with what the command line changes about it.
fn read(args: &RenderArgs, input: &Input, times: &mut Times) -> Result<Loaded, Failure> {
    let mut loaded = timed(&mut times.load, || {
        load::load(&args.scene, input, Some(load::Picture::of(args)))
    })?;
    settings::apply_to_film(args, &mut loaded.description)?;
    times.triangles = triangles(&loaded.description);
    tracing::info!(
        "{}: {} shapes, {} triangles, read in {}",
        args.scene.title(),
        loaded.description.shapes.len(),
        words::count(times.triangles as f64),
        words::time(times.load)
    );
    Ok(loaded)
}

/// Begins to watch a render for the person who waits, and says what it will be.
fn watch<'a>(
    (console, interrupt): (&'a Console, &'a Interrupt),
    prepared: &Prepared,
    (done, track, before): (&'a Done<'a>, Option<&'a ErrorTrack>, Spent),
    film: &Film,
) -> Watch<'a> {
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
    let limits = prepared.limits;
    if let Some(noise) = limits.noise {
        console.tell(&format!(
            "stops at a noise of {noise}: after each pass of up to {PASS_SPP} samples a pixel, from \
             {MIN_SPP_FOR_NOISE} on, the variance among a pixel's samples tells the noise and its error"
        ));
    }
    interrupt.be_patient();
    let watch = Watch::start(
        interrupt,
        console,
        limits,
        film,
        preview,
        (done, before.time),
    );
    watch.measuring(track)
}
