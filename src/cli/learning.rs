//! Learned fields, as the commands share them: learning one, and what is said about it.

use super::field_file::{Opened, records};
use super::guide_args::{Guide as Way, GuideArgs, LearnArgs, MODEL, Teachers, When};
use super::{Failure, settings};
use crate::guide::ppg::Target;
use crate::integrate::View;
use crate::integrate::guiding::{Guidance, Guide};
use crate::integrate::manifold::{ManifoldSampling, find_chains};
use crate::integrate::progress::{Limits, Spent, Stop};
use crate::integrate::training::extend::to_guide;
use crate::integrate::training::mixtures::{self, LearnedMixtures, learn_mixtures};
use crate::integrate::training::{LearnSettings, Learned, Learner, learn_until};
use crate::integrate::training::{prospect, trial};
use crate::photon::PhotonCounts;
use crate::photon::schedule::Budget;
use crate::report::words;
use std::time::Duration;

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
