//! A render in memory: what is decided before the first ray, the field that guides, the film, and what
//! was measured. `twintree render` adds files, messages and checkpoints; who embeds the program goes
//! through the same stages:
//!
//! ```text
//! load::load -> Loaded::build -> Prepared::new -> guiding -> trace -> stats
//! ```

use super::field_file::Opened;
use super::guide_args::Guide;
use super::learning::{self, Guiding};
use super::load::Loaded;
use super::render_args::RenderArgs;
use super::{Failure, identity, settings, threads, view};
use crate::camera::Camera;
use crate::film::{Film, FilmDescription};
use crate::integrate::progress::{Limits, Observer, Spent, StoppedBy, Summary};
use crate::integrate::render::resume;
use crate::integrate::training::Learner;
use crate::integrate::{PathSettings, View};
use crate::report::stats::Stats;
use crate::scene::{Description, Scene};
use std::time::Duration;

/// What the stages before rendering took, and what they found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Times {
    /// Seconds of reading the scene.
    pub load: f64,
    /// Seconds of building it.
    pub build: f64,
    /// Seconds of learning before the first sample.
    pub train: f64,
    /// Triangles of the scene, instances counted once.
    pub triangles: u64,
}

/// A render that is decided about: how a scene is seen, by which paths, until when.
pub struct Prepared<'a> {
    args: &'a RenderArgs,
    scene: &'a Scene,
    camera: Camera,
    settings: PathSettings,
    /// The film, with what the arguments change about it.
    pub film: &'a FilmDescription,
    /// When to stop.
    pub limits: Limits,
    /// What guides.
    pub way: Guide,
}

impl<'a> Prepared<'a> {
    /// Decides, and warns if the camera sees nothing. The film of the description is as
    /// [`settings::apply_to_film`] left it.
    pub fn new(args: &'a RenderArgs, scene: &'a Scene, description: &'a Description) -> Self {
        let film = &description.film;
        let mut prepared = Self {
            args,
            scene,
            camera: Camera::new(&description.camera, film.width, film.height),
            settings: settings::of_render(args, &description.render),
            film,
            limits: settings::limits(&args.stop, &description.render),
            way: Guide::None,
        };
        view::warn(scene, &prepared.camera, &description.camera, film);
        prepared.way = learning::decide(&args.guide, &prepared.view(), &prepared.limits);
        prepared
    }

    /// What paths see, without a field.
    pub fn view(&self) -> View<'_> {
        View {
            scene: self.scene,
            camera: &self.camera,
            film: self.film,
            settings: &self.settings,
            guide: None,
        }
    }

    /// Prepares guiding: by the field of a file, by what was learned for another view (`before`), or
    /// by a new field.
    ///
    /// # Errors
    /// When there is nothing to learn from.
    pub fn guiding(
        &self,
        field: Option<Opened>,
        before: Option<Learner>,
    ) -> Result<Guiding, Failure> {
        let (how, view) = ((&self.args.guide, self.way), &self.view());
        learning::guiding(how, (field, before), view, &self.limits)
    }

    /// Renders on from where the film is, at a cost of `before` so far.
    pub fn trace(
        &self,
        guiding: &mut Guiding,
        film: &mut Film,
        before: Spent,
        observer: &dyn Observer,
    ) -> Summary {
        let mut learner = guiding.learner.take();
        let view = View {
            guide: guiding.prepared(),
            ..self.view()
        };
        let summary = resume(
            &view,
            learner.as_mut(),
            film,
            &self.limits,
            before,
            observer,
        );
        guiding.learner = learner;
        if let Some(learner) = &guiding.learner {
            learning::describe(learner);
        }
        summary
    }

    /// What was measured. Times of writing and denoising, and errors against a reference, are
    /// filled in where they are known.
    pub fn stats(
        &self,
        loaded: &Loaded,
        (film, summary): (&Film, &Summary),
        guiding: &Guiding,
        times: Times,
    ) -> Stats {
        let learner = guiding.learner.as_ref();
        // A render of no time at all has no rate to speak of, and must not divide by zero.
        let seconds = summary.elapsed.max(Duration::from_nanos(1)).as_secs_f64();
        Stats {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: self.args.scene.title(),
            width: film.width(),
            height: film.height(),
            seed: self.args.light.seed,
            settings: identity::settings((self.args, self.way), &self.view(), &self.limits),
            threads: threads::count(),
            accel: self.scene.rays.name(),
            stopped_by: word_of(summary.stopped_by),
            spp: summary.spp,
            samples: summary.samples,
            samples_per_second: summary.samples as f64 / seconds,
            rays: summary.rays,
            rays_per_second: summary.rays as f64 / seconds,
            noise: summary.noise.map(|n| n.value),
            noise_error: summary.noise.map(|n| n.error),
            noise_worst: summary.noise.map(|n| n.worst),
            invalid_samples: film.invalid_samples(),
            load_seconds: times.load,
            build_seconds: times.build,
            train_seconds: learner.map_or(times.train, |l| l.elapsed().as_secs_f64()),
            field_memory_bytes: guiding.bytes(),
            learning_memory_bytes: learner.map_or(0, Learner::peak_bytes),
            render_seconds: summary.elapsed.as_secs_f64(),
            accel_memory_bytes: self.scene.rays.memory_bytes() as u64,
            texture_memory_bytes: loaded.textures().bytes,
            triangles: times.triangles,
            field: learner.map(Learner::stats),
            trial: learner.and_then(Learner::verdict),
            warnings: loaded.description.warnings.clone(),
            ..Stats::default()
        }
    }
}

/// What stopped a render, as the `--stats` file has it.
fn word_of(stopped_by: StoppedBy) -> &'static str {
    match stopped_by {
        StoppedBy::Samples => "samples",
        StoppedBy::Time => "time",
        StoppedBy::Noise => "noise",
        StoppedBy::Interrupt => "interrupt",
    }
}
