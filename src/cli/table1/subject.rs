//! A scene that is rendered by one method after the other.

use super::args::{Extras, Method, Table1Args};
use crate::camera::Camera;
use crate::cli::guide_args::REUSE;
use crate::cli::input::Input;
use crate::cli::load::{self, Loaded};
use crate::cli::picture_args::SizeArgs;
use crate::cli::scene_args::SceneArgs;
use crate::cli::{Failure, settings};
use crate::film::{Film, FilmDescription};
use crate::film::{Layers, Metadata};
use crate::guide::ModelKind;
use crate::guide::ppg::Target;
use crate::image::Image;
use crate::integrate::guiding::Guidance;
use crate::integrate::progress::{Limits, Observer, Progress, Spent};
use crate::integrate::render::{render, resume};
use crate::integrate::training::mixtures::learn_mixtures;
use crate::integrate::training::{LearnSettings, Learner};
use crate::integrate::{GuidedSettings, PathSettings, View};
use crate::photon::schedule::Budget;
use crate::scene::Scene;
use std::path::Path;
use std::time::{Duration, Instant};
use xxhash_rust::xxh3::xxh3_64;

/// Batches of the double hierarchy, each twice as large as the one before: the program's own
/// default.
pub const DOUBLING_BATCHES: u32 = 8;

/// A scene, built.
pub struct Subject {
    name: String,
    loaded: Loaded,
    scene: Scene,
    camera: Camera,
    settings: PathSettings,
    fingerprint: u64,
    spp: u64,
    photons: u64,
    batches: u32,
    paths: u64,
    memory: u64,
    gmm_memory: u64,
}

/// What one method came to.
pub struct Run {
    /// The image.
    pub image: Image,
    /// Bytes of the field.
    pub memory_bytes: u64,
    /// Bytes that it took while it was learned.
    pub training_bytes: u64,
    /// Time of learning.
    pub preprocessing: Duration,
    /// Time of rendering.
    pub rendering: Duration,
}

/// How guided paths are traced with what a render does besides. Where no number of pixels that
/// share is given, it is a render's.
fn with_extras(guided: GuidedSettings, extras: Extras) -> GuidedSettings {
    GuidedSettings {
        reuse: match guided.reuse {
            1 if extras.reuse => REUSE,
            given => given,
        },
        manifold: extras.manifold,
        adaptive: extras.adaptive,
        ..guided
    }
}

/// An end after so many samples a pixel.
pub fn samples(spp: u64) -> Limits {
    Limits {
        spp,
        time: None,
        noise: None,
    }
}

/// Renders without a word.
struct Silent;

impl Observer for Silent {
    fn pass_done(&self, _: &Progress, _: &Film) {}
    fn should_stop(&self) -> bool {
        false
    }
}

impl Subject {
    /// Reads and builds a scene.
    ///
    /// # Errors
    /// When it cannot be used, or nothing shines in it.
    pub fn load(args: &Table1Args, path: &Path) -> Result<Self, Failure> {
        let named = SceneArgs::of(path, &args.read);
        let mut loaded = load::load(&named, &Input::of(&named)?, None)?;
        let size = SizeArgs {
            width: args.width,
            height: None,
        };
        settings::resize(&mut loaded.description.film, size);
        let film = &mut loaded.description.film;
        film.crop = None;
        settings::check_memory([0, 0, film.width, film.height], &film.extras)?;
        let fingerprint = loaded.fingerprint()?;
        let scene = loaded.build(&args.rays)?;
        if scene.lights.is_empty() {
            let message = format!(
                "{}: nothing shines, there is nothing to compare",
                path.display()
            );
            return Err(Failure::wrong(message, "add an emitter to the scene"));
        }
        let description = &loaded.description;
        let film = &description.film;
        let guided = GuidedSettings {
            reuse: args.reuse,
            ..GuidedSettings::PLAIN
        };
        let name = path.file_stem().map(|n| n.to_string_lossy().into_owned());
        Ok(Self {
            name: name.unwrap_or_default(),
            camera: Camera::new(&description.camera, film.width, film.height),
            settings: settings::path_settings(&args.light, &description.render, guided),
            loaded,
            scene,
            fingerprint,
            spp: args.spp,
            photons: args.photons.saturating_mul(u64::from(args.batches)),
            batches: args.batches,
            memory: args.guide_memory as u64,
            gmm_memory: args.gmm_memory as u64,
            paths: args.paths,
        })
    }

    /// The scene file's name without its end.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The film.
    pub fn film(&self) -> &FilmDescription {
        &self.loaded.description.film
    }

    /// A number for everything that the expected image depends on.
    pub fn identity(&self) -> u64 {
        let settings = PathSettings {
            seed: 0,
            guided: GuidedSettings::PLAIN,
            ..self.settings.clone()
        };
        let film = self.film();
        let words = format!("{:x} {settings:?} {:?}", self.fingerprint, film.filter);
        xxh3_64(words.as_bytes())
    }

    /// How paths are traced with another seed.
    pub fn settings(&self, seed: u64) -> PathSettings {
        PathSettings {
            seed,
            ..self.settings.clone()
        }
    }

    /// The seed of the whole comparison.
    pub fn seed(&self) -> u64 {
        self.settings.seed
    }

    /// What is looked at, unguided.
    pub fn view<'a>(&'a self, settings: &'a PathSettings) -> View<'a> {
        View {
            scene: &self.scene,
            camera: &self.camera,
            film: self.film(),
            settings,
            guide: None,
        }
    }

    /// How fields are learned: from photons alone.
    pub fn learning(
        &self,
        settings: &PathSettings,
        batches: u32,
        model: ModelKind,
    ) -> LearnSettings {
        LearnSettings {
            photons: Budget::Exactly {
                photons: self.photons,
                batches,
            },
            paths: 0,
            mixture: None,
            trial: true,
            batches,
            memory: self.memory,
            photon: settings::photon_settings(settings),
            model,
        }
    }

    /// Learns and renders once.
    ///
    /// # Errors
    /// When there is nothing to learn from.
    pub fn run(&self, method: Method, repeat: u32) -> Result<Run, Failure> {
        let settings = self.settings(self.settings.seed.wrapping_add(u64::from(repeat)));
        let view = self.view(&settings);
        let start = Instant::now();
        let model = match method {
            Method::None => return Ok(self.draw(&view, None, [0, 0], Duration::ZERO)),
            Method::Gmm => {
                let how = LearnSettings {
                    memory: self.gmm_memory,
                    ..self.learning(&settings, self.batches, ModelKind::default())
                };
                let learned = learn_mixtures(&view, &how)?;
                let bytes = [learned.mixtures.bytes(), learned.training_bytes];
                let guide = (&learned.mixtures).into();
                return Ok(self.draw(&view, Some(guide), bytes, start.elapsed()));
            }
            Method::Double(model) => model,
            Method::Ppg => return self.learn_and_draw(&view, method),
            Method::Render(extras) => {
                let guided = with_extras(settings.guided, extras);
                let settings = PathSettings { guided, ..settings };
                return self.learn_and_draw(&self.view(&settings), method);
            }
        };
        let how = self.learning(&settings, DOUBLING_BATCHES, model);
        let learner = Learner::new(&view, &how)?;
        let elapsed = start.elapsed();
        let bytes = [learner.guide().bytes(), learner.stats().training_bytes];
        Ok(self.draw(&view, Some(learner.guide()), bytes, elapsed))
    }

    /// Learns on the way, from the image's own first samples, and from photons as needed where the
    /// method takes any.
    fn learn_and_draw(&self, view: &View, method: Method) -> Result<Run, Failure> {
        let limits = samples(self.spp);
        let how = LearnSettings {
            photons: settings::photons_as_needed(self.film(), &limits),
            paths: self.paths,
            ..self.learning(view.settings, DOUBLING_BATCHES, ModelKind::Gauss)
        };
        let start = Instant::now();
        let learner = match method {
            Method::Ppg => Learner::ppg(view, &how, Target::default()),
            _ => Learner::new(view, &how),
        }?;
        let (film, learner) = self.draw_learning(view, learner, &limits);
        let preprocessing = learner.elapsed();
        Ok(Run {
            rendering: start.elapsed().saturating_sub(preprocessing),
            image: film.image(Layers::NONE, &Metadata::default()),
            memory_bytes: learner.guide().bytes(),
            training_bytes: learner.stats().training_bytes,
            preprocessing,
        })
    }

    /// Renders with a field that is learned on the way.
    pub fn draw_learning(
        &self,
        view: &View,
        mut learner: Learner,
        limits: &Limits,
    ) -> (Film, Learner) {
        let mut film = Film::new(self.film());
        let (taught, spent) = (Some(&mut learner), Spent::default());
        resume(view, taught, &mut film, limits, spent, &Silent);
        (film, learner)
    }

    fn draw(
        &self,
        view: &View,
        guide: Option<Guidance>,
        [memory_bytes, training_bytes]: [u64; 2],
        preprocessing: Duration,
    ) -> Run {
        let view = View { guide, ..*view };
        let mut film = Film::new(self.film());
        let start = Instant::now();
        render(&view, &mut film, &samples(self.spp), &Silent);
        Run {
            rendering: start.elapsed(),
            image: film.image(Layers::NONE, &Metadata::default()),
            memory_bytes,
            training_bytes,
            preprocessing,
        }
    }
}
