//! `Scene.render` and `Scene.train`: the stages of the command line, in memory.

use crate::failure::Fault;
use crate::field::{Field, Guides};
use crate::picture::{Picture, Render};
use crate::progress::{Shown, Watcher};
use crate::scene::Scene;
use crate::state::plain;
use crate::words::{self, refuse, words};
use crate::work;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::ffi::OsString;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;
use twintree::cli::args::Command;
use twintree::cli::error_track::ErrorTrack;
use twintree::cli::field_file::{self, Opened};
use twintree::cli::help::options_of;
use twintree::cli::invalid::{self, LeftOut};
use twintree::cli::load::{self, Loaded};
use twintree::cli::prepared::{Prepared, Times};
use twintree::cli::render_args::RenderArgs;
use twintree::cli::scene_args::SceneArgs;
use twintree::cli::train::{TrainArgs, records};
use twintree::cli::{denoising, finish, memory, settings, train};
use twintree::film::{Film, Metadata};
use twintree::guide::FieldFile;
use twintree::image::Image;
use twintree::image::denoise::{DenoiseError, denoised};
use twintree::integrate::progress::{Spent, StoppedBy};
use twintree::report::stats::Stats;

/// Options of files and of the terminal, which a render in memory has none of.
const OF_FILES: [&str; 12] = [
    "output",
    "stats",
    "checkpoint",
    "resume",
    "shard",
    "frames",
    "pixel",
    "preview",
    "format",
    "compression",
    "exposure",
    "view",
];

/// A render, as its threads need it.
struct Work<'a> {
    scene: &'a Scene,
    args: RenderArgs,
    field: Option<Opened>,
    words: String,
    watcher: &'a Watcher,
}

impl Work<'_> {
    fn run(mut self) -> Result<Picture, Fault> {
        let denoiser = match self.args.files.denoise {
            true => Some(denoising::find(&self.args.files.oidn)?),
            false => None,
        };
        let picture = load::Picture::of(&self.args);
        let ready = self.scene.ready(picture, &self.args.rays)?;
        self.args.scene = ready.args;
        let mut loaded = Loaded::clone(&ready.loaded);
        settings::apply_to_film(&self.args, &mut loaded.description)?;
        let field = self.field.take();
        if let Some(field) = &field {
            field.check(loaded.fingerprint()?)?;
        }
        let prepared = Prepared::new(&self.args, &ready.scene, &loaded.description);
        let (film, mut stats) = self.trace(&prepared, &loaded, field, ready.times)?;
        let interrupted = stats.stopped_by == "interrupt";
        let metadata = Metadata {
            scene: self.args.scene.title(),
            settings: self.words.clone(),
            spp: stats.spp,
            seconds: stats.render_seconds,
        };
        let mut image = film.image(self.args.files.layers(), &metadata);
        if let Some(denoiser) = denoiser.filter(|_| !interrupted) {
            let start = Instant::now();
            image = clean(&denoiser, image, self.watcher)?;
            stats.denoise_seconds = start.elapsed().as_secs_f64();
        }
        stats.peak_memory_bytes = memory::peak_bytes();
        Ok(Picture {
            image,
            stats: stats.to_json(),
            exposure: prepared.film.exposure,
            interrupted,
        })
    }

    /// Learns, fills a film, and measures.
    fn trace(
        &self,
        prepared: &Prepared,
        loaded: &Loaded,
        field: Option<Opened>,
        times: Times,
    ) -> Result<(Film, Stats), Fault> {
        let mut film = Film::new(prepared.film);
        let reference = self.args.reference.as_deref();
        let track = reference.map(|path| ErrorTrack::against(path, prepared.film));
        let track = track.transpose()?.map(Arc::new);
        let start = Instant::now();
        let mut guiding = prepared.guiding(field, None)?;
        let train = start.elapsed().as_secs_f64();
        let pixels = film.held_pixels();
        self.watcher.pixels.store(pixels, Ordering::Relaxed);
        self.watcher.change(|state| {
            state.limits = Some(prepared.limits);
            state.track = track.clone();
        });
        let before = guiding.spent_after(Spent::default());
        let summary = prepared.trace(&mut guiding, &mut film, before, self.watcher);
        if film.samples_done() == 0 {
            let interrupted = summary.stopped_by == StoppedBy::Interrupt;
            return Err(finish::nothing_done(interrupted).into());
        }
        finish::warn_of_gaps(&film);
        let times = Times { train, ..times };
        let mut stats = prepared.stats(loaded, (&film, &summary), &guiding, times);
        self.watcher.change(|state| state.track = None);
        if let Some(track) = track.and_then(Arc::into_inner) {
            track.finish(&film, &summary, &mut stats);
        }
        if let Some((x, y, sample)) = film.first_invalid() {
            let count = film.invalid_samples();
            tracing::warn!(
                "{count} samples were not finite and were left out; the first is sample {sample} of \
                 pixel {x},{y}"
            );
        }
        let left_out = LeftOut::of(&stats, guiding.learner.as_ref());
        invalid::check(&self.args, left_out)?;
        Ok((film, stats))
    }
}

/// Takes the noise away; where Ctrl-C ends that, the picture is as it was.
fn clean(
    denoiser: &twintree::image::denoise::Denoiser,
    image: Image,
    watcher: &Watcher,
) -> Result<Image, Fault> {
    match denoised(denoiser, &image, &|_| !watcher.stops()) {
        Ok(clean) => Ok(clean),
        Err(DenoiseError::Cancelled) => Ok(image),
        Err(e) => Err(Fault::Runtime(e.to_string())),
    }
}

/// What was given as `field=`: its words for the parser, and the field.
fn field_of(
    py: Python<'_>,
    field: Option<&Bound<'_, PyAny>>,
) -> PyResult<Option<(String, Guides)>> {
    let Some(value) = field.filter(|v| !v.is_none()) else {
        return Ok(None);
    };
    if let Ok(field) = value.cast::<Field>() {
        let guides = Guides::Field(field.get().shared(py));
        return Ok(Some(("--field=any:a twintree.Field".into(), guides)));
    }
    let path: std::path::PathBuf = value.extract()?;
    let word = format!("--field={}", path.display());
    Ok(Some((word, Guides::File)))
}

#[pymethods]
impl Scene {
    /// Renders. Keywords are the options of `twintree render`: `spp=64`, `time=30` or
    /// `time="1m30s"`, `noise=0.02`, `guide="none"`, `seed=1`, `width=`, `max_depth=`,
    /// `denoise=True`; `twintree.options( "render")` lists all of them. Besides: `aovs=["albedo",
    /// "normal"]`, further layers; `field=`, a `Field` or the name of a file; `threads=`;
    /// `progress=`, True, False, a class like `tqdm`, or None, which shows a bar where somebody
    /// looks on.
    ///
    /// The same settings give the same bits as on the command line, on any number of threads. Other
    /// threads of Python run meanwhile. Ctrl-C ends the render: what there is is returned, with
    /// `interrupted` set; before the first sample, `KeyboardInterrupt` is raised.
    #[pyo3(signature = (*, aovs = None, field = None, threads = None, progress = None, **settings))]
    fn render(
        &self,
        py: Python<'_>,
        aovs: Option<&Bound<'_, PyAny>>,
        field: Option<&Bound<'_, PyAny>>,
        threads: Option<u16>,
        progress: Option<&Bound<'_, PyAny>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Render> {
        crate::messages::listen();
        let mut keywords = keywords_of(settings, aovs)?;
        let given = field_of(py, field)?;
        keywords.extend(given.iter().map(|(word, _)| word.clone()));
        let files = py.detach(|| self.files());
        let Command::Render(args) = words::read("render", &files, &keywords)? else {
            return Err(Fault::Runtime("another command was read".into()).into());
        };
        field_file::check_way(&args.guide).map_err(Fault::from)?;
        check_threads(threads)?;
        let watcher = Watcher::new(None);
        let work = Work {
            scene: self,
            words: typed("render", &files, &keywords),
            field: opened(given.map(|(_, guides)| guides), &args)?,
            args: *args,
            watcher: &watcher,
        };
        let mut shown = Shown::begin(py, &watcher, progress)?;
        let (outcome, raised) =
            work::watched(py, threads, &watcher.stop, &mut shown, || work.run())?;
        drop(shown);
        Render::new(
            py,
            kept(py, outcome, raised, |picture| picture.interrupted)?,
        )
    }

    /// Learns where light comes from, as `twintree train` does; keywords are its options:
    /// `photons=`, `paths=`, `guide_model=`, `guide_memory="256M"`, `seed=`, `width=`. `field=`, a
    /// `Field` of this scene, learns further over its structure. `threads` and `progress` are those
    /// of `render`.
    ///
    /// Ctrl-C ends learning: the field is returned as it is by then, with `interrupted` set; before
    /// the first records have taught, `KeyboardInterrupt` is raised.
    #[pyo3(signature = (*, field = None, threads = None, progress = None, **settings))]
    fn train(
        &self,
        py: Python<'_>,
        field: Option<&Bound<'_, PyAny>>,
        threads: Option<u16>,
        progress: Option<&Bound<'_, PyAny>>,
        settings: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Field> {
        crate::messages::listen();
        let mut keywords = words(settings)?;
        refuse(
            &keywords,
            &["output"],
            "a field is returned, and save(path) of it writes a file",
        )?;
        let given = field_of(py, field)?;
        keywords.extend(given.iter().map(|(word, _)| word.clone()));
        let files = py.detach(|| self.files());
        let Command::Train(args) = words::read("train", &files, &keywords)? else {
            return Err(Fault::Runtime("another command was read".into()).into());
        };
        check_threads(threads)?;
        let base = match given {
            Some((_, Guides::Field(shared))) => Some(shared.opened(false)),
            Some((_, Guides::File)) => {
                let path = args.field.as_deref();
                let read = path.map(Opened::read).transpose();
                read.map_err(Fault::from)?
            }
            None => None,
        };
        let watcher = Watcher::new(Some(records(&args)));
        let mut shown = Shown::begin(py, &watcher, progress)?;
        let work = || learned(self, &args, base.as_ref(), &watcher);
        let (outcome, raised) = work::watched(py, threads, &watcher.stop, &mut shown, work)?;
        drop(shown);
        kept(py, outcome, raised, Field::is_interrupted)
    }
}

/// What came of work, though Ctrl-C has ended it; nothing where anything else was raised meanwhile.
fn kept<T>(
    py: Python<'_>,
    outcome: Result<T, Fault>,
    raised: Option<PyErr>,
    is_interrupted: impl Fn(&T) -> bool,
) -> PyResult<T> {
    match (outcome, raised) {
        (Ok(kept), Some(e)) if is_interrupted(&kept) && is_interrupt(py, &e) => Ok(kept),
        (_, Some(e)) => Err(e),
        (outcome, None) => Ok(outcome?),
    }
}

fn learned(
    scene: &Scene,
    args: &TrainArgs,
    base: Option<&Opened>,
    watcher: &Watcher,
) -> Result<Field, Fault> {
    let ready = scene.ready(plain(args.size), &args.rays)?;
    let mut loaded = Loaded::clone(&ready.loaded);
    settings::resize(&mut loaded.description.film, args.size);
    let fingerprint = loaded.fingerprint()?;
    if let Some(base) = base {
        base.check(fingerprint)?;
    }
    let of = (&*ready.scene, &loaded.description);
    // A request that comes when all is learned ends nothing.
    let stopped = AtomicBool::new(false);
    let stop = || {
        let stops = watcher.stops();
        stopped.fetch_or(stops, Ordering::Relaxed);
        stops
    };
    let file = train::learn(args, of, base, fingerprint, &stop)?;
    let stopped = stopped.into_inner();
    let records = |f: &FieldFile| f.sample_ranges.photons.count() + f.sample_ranges.paths.count();
    // A share begins with nothing, whatever its base knows.
    let before = base.filter(|_| args.shard.is_none());
    if stopped && records(&file) == before.map_or(0, |b| records(&b.file)) {
        return Err(finish::nothing_done(true).into());
    }
    Ok(Field::learned(file, stopped))
}

/// The words of a render's keyword arguments, those of files and of the scene refused.
fn keywords_of(
    settings: Option<&Bound<'_, PyDict>>,
    aovs: Option<&Bound<'_, PyAny>>,
) -> PyResult<Vec<String>> {
    let mut keywords = words(settings)?;
    let help = "a render is returned, and save(path) of it writes files";
    refuse(&keywords, &OF_FILES, help)?;
    let options = options_of::<SceneArgs>();
    let of_scene: Vec<&str> = options.iter().filter_map(|arg| arg.get_long()).collect();
    let help = "give it to twintree.load, twintree.Scene or set() of the scene";
    refuse(&keywords, &of_scene, help)?;
    if let Some(layers) = aovs {
        let layer = PyDict::new(layers.py());
        layer.set_item("aov", layers)?;
        keywords.extend(words(Some(&layer))?);
    }
    Ok(keywords)
}

/// The field that is to guide.
fn opened(guides: Option<Guides>, args: &RenderArgs) -> Result<Option<Opened>, Fault> {
    match guides {
        Some(Guides::Field(field)) => Ok(Some(field.opened(true))),
        Some(Guides::File) => Ok(field_file::wanted_file(&args.guide)?),
        None => Ok(None),
    }
}

/// As one would type it, for the picture's file.
fn typed(command: &str, files: &[OsString], keywords: &[String]) -> String {
    let files = files.iter().map(|f| f.to_string_lossy().into_owned());
    let words = std::iter::once(command.to_owned()).chain(files);
    let words: Vec<String> = words.chain(keywords.iter().cloned()).collect();
    words.join(" ")
}

/// Refuses a number of threads that is none.
pub fn check_threads(threads: Option<u16>) -> Result<(), Fault> {
    match threads {
        Some(0) => Err(Fault::Value("threads: 0 is not in 1..=65535".into())),
        _ => Ok(()),
    }
}

fn is_interrupt(py: Python<'_>, e: &PyErr) -> bool {
    e.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py)
}
