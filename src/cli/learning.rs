//! Learned fields, as the commands share them: learning one, reading one, and what is said about
//! it.

use super::guide_args::{FieldName, Guide as Way, GuideArgs, LearnArgs, MODEL, Teachers, When};
use super::{Failure, output, settings};
use crate::guide::FieldFile;
use crate::guide::ppg::Target;
use crate::integrate::View;
use crate::integrate::guiding::{Guidance, Guide};
use crate::integrate::manifold::{ManifoldSampling, find_chains};
use crate::integrate::progress::{Limits, Spent, Stop};
use crate::integrate::training::extend::{check_scene, to_guide};
use crate::integrate::training::mixtures::{self, LearnedMixtures, learn_mixtures};
use crate::integrate::training::{LearnSettings, Learned, Learner, learn_until};
use crate::integrate::training::{prospect, trial};
use crate::photon::PhotonCounts;
use crate::photon::schedule::Budget;
use crate::report::words;
use std::path::{Path, PathBuf};
use std::time::Duration;
use xxhash_rust::xxh3::xxh3_64;

/// A field that was read.
pub struct Opened {
    /// Its name.
    pub path: PathBuf,
    /// What is in it.
    pub file: FieldFile,
    /// A number that tells it from others.
    pub fingerprint: u64,
    /// Whether it may be of another scene.
    pub any_scene: bool,
}

impl Opened {
    /// Reads a field.
    ///
    /// # Errors
    /// When it cannot be read, is not a field, or is damaged.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        let bytes = crate::image::regular::read(path)
            .map_err(|e| Failure::Wrong(format!("{} cannot be read: {e}", path.display())))?;
        let file = FieldFile::from_bytes(&bytes)
            .map_err(|e| Failure::Wrong(format!("{}: {e}", path.display())))?;
        Ok(Self {
            path: path.to_owned(),
            file,
            fingerprint: xxh3_64(&bytes),
            any_scene: false,
        })
    }

    /// The same, of a field that may be of any scene if its name says so.
    ///
    /// # Errors
    /// As [`Opened::read`].
    pub fn named(name: &FieldName) -> Result<Self, Failure> {
        Ok(Self {
            any_scene: name.any_scene,
            ..Self::read(&name.path)?
        })
    }

    /// Refuses a field of another scene; one that may be of any scene is only warned about.
    ///
    /// # Errors
    /// When it is of another scene.
    pub fn check(&self, scene: u64) -> Result<(), Failure> {
        let Err(why) = check_scene(self.file.trainer.settings(), scene) else {
            return Ok(());
        };
        let message = format!("{}: {why}", self.path.display());
        if self.any_scene {
            tracing::warn!("{message}");
            return Ok(());
        }
        let help = "learn one with \"twintree train\", or take it all the same as any:FILE";
        Err(Failure::wrong(message, help))
    }
}

/// The field that a render is to be guided by, if it is in a file.
///
/// # Errors
/// When it cannot be used, or guiding is switched off beside it.
pub fn wanted_file(args: &GuideArgs) -> Result<Option<Opened>, Failure> {
    check_way(args)?;
    args.field.as_ref().map(Opened::named).transpose()
}

/// Refuses a field beside a way of guiding that has none of its kind.
///
/// # Errors
/// When guiding is switched off, or another way is asked for.
pub fn check_way(args: &GuideArgs) -> Result<(), Failure> {
    if args.field.is_none() {
        return Ok(());
    }
    if args.guide == Some(Way::None) {
        let help = "leave one of them away";
        return Err(Failure::wrong(
            "--guide none does not go with --field",
            help,
        ));
    }
    if let Some(way @ (Way::Gmm | Way::Ppg)) = args.guide {
        let message = format!(
            "--guide {} does not go with --field: only double hierarchies are kept in files",
            if way == Way::Gmm { "gmm" } else { "ppg" }
        );
        let help = match way {
            Way::Gmm => "leave --field away: the mixtures are learned before rendering",
            _ => "leave --field away: the tree is learned while rendering",
        };
        return Err(Failure::wrong(message, help));
    }
    Ok(())
}

/// What guides a render: a field that was kept, one that is learned on the way, or nothing.
#[derive(Default)]
pub struct Guiding {
    /// From a file.
    pub kept: Option<Guide>,
    /// Learned on the way.
    pub learner: Option<Learner>,
    /// Cached mixtures.
    pub mixtures: Option<LearnedMixtures>,
}

impl Guiding {
    /// What guides from the first sample on.
    pub fn prepared(&self) -> Option<Guidance<'_>> {
        let mixtures = self.mixtures.as_ref().map(|m| (&m.mixtures).into());
        mixtures.or(self.kept.as_ref().map(Into::into))
    }

    /// Bytes of the field as it is.
    pub fn bytes(&self) -> u64 {
        let learned = self.learner.as_ref().map(Learner::guide);
        learned.or(self.prepared()).map_or(0, |g| g.bytes())
    }

    /// Time that learning took so far.
    pub fn elapsed(&self) -> Duration {
        let mixtures = self.mixtures.as_ref().map(|m| m.elapsed);
        let learner = self.learner.as_ref().map(Learner::elapsed);
        mixtures.or(learner).unwrap_or_default()
    }

    /// What a render has cost before its first sample, `before` this go and in this one.
    pub fn spent_after(&self, before: Spent) -> Spent {
        Spent {
            time: before.time + self.elapsed(),
            ..before
        }
    }
}

/// What guides a render: where that is left to the program, a double hierarchy or nothing.
pub fn decide(args: &GuideArgs, view: &View, limits: &Limits) -> Way {
    if args.way() != Way::Auto {
        return args.way();
    }
    match prospect::not_worthwhile(view, limits) {
        Some(why) => {
            tracing::info!("{why}: no field is learned");
            Way::None
        }
        None => Way::Double,
    }
}

/// Prepares guiding, if it is wanted: by the field of a file, by one that was learned for another
/// view of the scene, or by a new one. `way` is what was decided.
///
/// # Errors
/// When there is nothing to learn from.
pub fn guiding(
    (args, way): (&GuideArgs, Way),
    (opened, before): (Option<Opened>, Option<Learner>),
    view: &View,
    limits: &Limits,
) -> Result<Guiding, Failure> {
    if let Some(opened) = opened {
        let mut guide = to_guide(&opened.file).with_mixture(args.guided.mixture.0);
        // The same chains for any number of samples: a render that is resumed may ask for more.
        let chains = find_chains(view, settings::photons_alone(&args.learn));
        guide.manifold = chains.map(ManifoldSampling::new);
        trial::try_manifold(view, &mut guide);
        describe_manifold(guide.manifold.as_ref());
        tracing::info!(
            "guided by {}: {}, {}",
            opened.path.display(),
            records(&opened.file),
            words::bytes(guide.field.bytes())
        );
        return Ok(Guiding {
            kept: Some(guide),
            ..Guiding::default()
        });
    }
    if way == Way::None {
        return Ok(Guiding::default());
    }
    let photons = match args.guide {
        Some(Way::Gmm) => Budget::Exactly {
            photons: args.learn.photons.unwrap_or(mixtures::PHOTONS),
            batches: args.learn.batches,
        },
        _ => settings::photons_for(args, view.film, limits),
    };
    let mut settings = settings::learn_settings(&args.learn, view.settings, photons)?;
    settings.mixture = args.guided.mixture.0;
    settings.trial = args.guided.trial == When::Auto;
    if let Some(why) = prospect::nothing_to_learn(view) {
        tracing::info!("{why}: no field is learned");
        return Ok(Guiding::default());
    }
    match way {
        Way::Gmm => mixtures(args, view, &settings),
        Way::Ppg => {
            // Whatever --train says.
            let paths = args.learn.paths;
            let settings = LearnSettings {
                photons,
                paths,
                ..settings
            };
            sd_tree(view, &settings)
        }
        _ => match before {
            Some(learner) => Ok(go_on(learner, view, &settings)),
            None => double(view, &settings),
        },
    }
}

/// Goes on with what was learned for another view of the scene.
fn go_on(learner: Learner, view: &View, settings: &LearnSettings) -> Guiding {
    let learner = learner.moved(view, settings);
    tracing::info!("guided by what the frames before have taught");
    Guiding {
        learner: Some(learner),
        ..Guiding::default()
    }
}

/// Begins a double hierarchy, which the first passes teach further.
fn double(view: &View, settings: &LearnSettings) -> Result<Guiding, Failure> {
    let mut learner = Learner::new(view, settings)?;
    if !learner.wants_more() {
        learner.try_manifold(view);
    }
    let counts = learner.counts();
    tracing::info!(
        "learned from {} photons ({} landings) in {}",
        words::count(counts.emitted as f64),
        words::count(counts.landings as f64),
        words::time(learner.elapsed().as_secs_f64()),
    );
    warn_of_invalid_photons(&counts);
    Ok(Guiding {
        learner: Some(learner),
        ..Guiding::default()
    })
}

/// Begins an SD-tree, which the first passes teach.
fn sd_tree(view: &View, settings: &LearnSettings) -> Result<Guiding, Failure> {
    if settings.paths == 0 {
        let message = "--guide ppg learns from camera paths alone";
        return Err(Failure::wrong(message, "give --paths a number above 0"));
    }
    Ok(Guiding {
        learner: Some(Learner::ppg(view, settings, Target::default())?),
        ..Guiding::default()
    })
}

/// Learns mixtures.
fn mixtures(args: &GuideArgs, view: &View, settings: &LearnSettings) -> Result<Guiding, Failure> {
    if args.learn.train == Teachers::Paths || settings.photons.is_none() {
        let message = "--guide gmm learns from photons alone";
        let help = "leave \"--train paths\" away, and give --photons a number above 0";
        return Err(Failure::wrong(message, help));
    }
    if args.learn.guide_model != MODEL {
        let message = "--guide gmm has a model of its own";
        let help = "leave --guide-model away, or take --guide double";
        return Err(Failure::wrong(message, help));
    }
    let learned = learn_mixtures(view, settings)?;
    tracing::info!(
        "learned from {} photons ({} landings) in {}: {} mixtures, {}",
        words::count(learned.counts.emitted as f64),
        words::count(learned.counts.landings as f64),
        words::time(learned.elapsed.as_secs_f64()),
        words::count(learned.mixtures.len() as f64),
        words::bytes(learned.mixtures.bytes()),
    );
    warn_of_invalid_photons(&learned.counts);
    Ok(Guiding {
        mixtures: Some(learned),
        ..Guiding::default()
    })
}

/// Says what was learned on the way.
pub fn describe(learner: &Learner) {
    let stats = learner.stats();
    tracing::info!(
        "the field: {} links in {} cells, {}; learning it took {}",
        words::count(stats.links as f64),
        words::count(stats.space_cells as f64),
        words::bytes(learner.guide().bytes()),
        words::time(learner.elapsed().as_secs_f64()),
    );
    describe_manifold(learner.guide().manifold());
    let Some(verdict) = learner.verdict() else {
        return;
    };
    let work = 1.0 / verdict.gain();
    if !verdict.pays() {
        tracing::info!(
            "guiding would take {work:.1} times the work here: it was stopped after {} samples a pixel",
            verdict.after
        );
    } else if verdict.gain() >= 1.0 {
        tracing::info!("guiding takes {work:.2} of the work");
    } else if verdict.may_catch_up() {
        tracing::info!(
            "guiding goes on: it takes {work:.1} times the work so far, and still learns"
        );
    } else {
        tracing::info!(
            "guiding goes on for light that is rare: elsewhere it takes {work:.1} times the work"
        );
    }
}

/// Says how often suns and lamps are sampled through specular chains.
fn describe_manifold(manifold: Option<&ManifoldSampling>) {
    if let Some(manifold) = manifold {
        let share = 100.0 * manifold.rate();
        tracing::info!(
            "samples suns and lamps behind glass and in mirrors at {share} % of the first rough vertices"
        );
    }
}

/// Learns a field, until it is stopped, and says what came of it.
///
/// # Errors
/// When there is nothing to learn from.
pub fn teach(args: &LearnArgs, view: &View, stop: Stop) -> Result<Learned, Failure> {
    let photons = settings::photons_alone(args);
    let settings = settings::learn_settings(args, view.settings, photons)?;
    let learned = learn_until(view, &settings, stop)?;
    tracing::info!(
        "learned from {} photons ({} landings) and {} camera paths in {}: {} links in {} cells, {}",
        words::count(learned.counts.emitted as f64),
        words::count(learned.counts.landings as f64),
        words::count(learned.paths as f64),
        words::time(learned.elapsed.as_secs_f64()),
        words::count(learned.stats.links as f64),
        words::count(learned.stats.space_cells as f64),
        words::bytes(learned.guide.field.bytes())
    );
    warn_of_invalid_photons(&learned.counts);
    Ok(learned)
}

/// Says how many photons were not finite, if any.
pub fn warn_of_invalid_photons(counts: &PhotonCounts) {
    if counts.invalid > 0 {
        tracing::warn!(
            "{} photons were not finite and were left out",
            counts.invalid
        );
    }
}

/// What a field has learned from, in words.
pub fn records(file: &FieldFile) -> String {
    format!(
        "{} photons and {} camera paths",
        words::count(file.sample_ranges.photons.count() as f64),
        words::count(file.sample_ranges.paths.count() as f64)
    )
}

/// Writes a field, whole or not at all.
///
/// # Errors
/// When the system refuses.
pub fn write(path: &Path, file: &FieldFile) -> Result<(), Failure> {
    let bytes = file.to_bytes();
    output::write_file(path, &bytes)?;
    tracing::info!(
        "wrote {}: {}, {}",
        path.display(),
        records(file),
        words::bytes(bytes.len() as u64)
    );
    Ok(())
}
