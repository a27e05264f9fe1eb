//! Learning the field: from photons before rendering, then from camera paths.
//!
//! Photons come first, in batches (see [`crate::photon::schedule`]). Camera paths guided by what is
//! known so far then teach the rest, above all what the camera sees and photons hardly reach. They
//! are samples of the image like any other: whoever renders hands the [`TrainingSamples`] of its
//! first passes to a [`Learner`] and renders the next pass with what that has learned
//! ([`crate::integrate::render`] does). [`learn`] makes paths of its own, for a field without an
//! image.
//!
//! Until a trial ([`super::trial`]) has told that guiding pays, photons and training paths are so
//! few that learning takes about a twentieth of the work to come.  Memory
//! is bounded, too: batches are as large as the trees leave room for.

use super::camera_paths::training_samples;
use super::effort::Effort;
use super::importance::{self, Look};
use super::method::Method;
use super::photons::room;
use super::record::TrainingSamples;
use super::settings::LearnSettings;
use super::trial::Verdict;
use crate::guide::ppg::{self, PpgTrainer, SdTree};
use crate::guide::{
    Field, FractionRecord, Fractions, GuideError, ModelKind, PathSample, Stats, Trainer,
};
use crate::integrate::context::View;
use crate::integrate::guiding::{Guidance, Guide};
use crate::integrate::progress::Stop;
use crate::photon::PhotonCounts;
use crate::photon::schedule::doubling;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// Bytes of a vertex of a path that teaches, before and after it was learned from.
const VERTEX_BYTES: u64 = (size_of::<PathSample>() + size_of::<FractionRecord>()) as u64 + 16;
/// Most paths of a pass that teach. What more of them tell is not worth the time.
const MOST_TRAINING_PATHS: u64 = 1 << 19;
/// Guided paths have so many times the vertices of others, before any were counted.
const MORE_VERTICES: f64 = 2.0;
/// Samples of every pixel that have taught before the trial, where the number of samples is not
/// known.
const AFTER: u64 = 4;
/// Otherwise one in so many.
const ONE_IN: u64 = 64;
/// Where it is in doubt, it is tried again after so many times the samples.
const AGAIN: u64 = 4;

/// What learning came to.
#[derive(Debug)]
pub struct Learned {
    /// The field.
    pub guide: Guide,
    /// What became of the photons.
    pub counts: PhotonCounts,
    /// Camera paths that taught.
    pub paths: u64,
    /// The trees with their sums: what learning further and keeping the field take.
    pub trainer: Trainer,
    /// The trees in numbers.
    pub stats: Stats,
    /// Wall-clock time.
    pub elapsed: Duration,
}

/// A field that is being learned, and can be asked meanwhile.
#[derive(Debug)]
pub struct Learner {
    settings: LearnSettings,
    method: Method,
    effort: Effort,
    taught: u64,
    /// Vertices of a path that taught.
    vertices: f64,
    verdict: Option<Verdict>,
    /// Most bytes that learning held.
    peak: u64,
    elapsed: Duration,
}

impl Learner {
    /// Learns from photons, where the paths of `view` may come. Where a trial will tell whether
    /// guiding pays, the most of them wait for that.
    ///
    /// # Errors
    /// When the scene's bounds are empty or a setting is out of range.
    pub fn new(view: &View, settings: &LearnSettings) -> Result<Self, GuideError> {
        Self::until(view, settings, &|| false)
    }

    fn until(view: &View, settings: &LearnSettings, stop: Stop) -> Result<Self, GuideError> {
        Self::begin(view, settings, |look, begun| {
            Method::double(view, settings, look, begun, stop)
        })
    }

    /// The same for an SD-tree, which learns from camera paths alone.
    ///
    /// # Errors
    /// When the scene's bounds are empty or a setting is out of range.
    pub fn ppg(
        view: &View,
        settings: &LearnSettings,
        target: ppg::Target,
    ) -> Result<Self, GuideError> {
        Self::begin(view, settings, |_, _| Method::ppg(view, settings, target))
    }

    fn begin(
        view: &View,
        settings: &LearnSettings,
        method: impl FnOnce((&Look, Effort), Instant) -> Result<Method, GuideError>,
    ) -> Result<Self, GuideError> {
        let start = Instant::now();
        let look = importance::look(view, settings.photons);
        let effort = Effort::new(settings.photons, &look);
        let method = method((&look, effort), start)?;
        Ok(Self {
            vertices: MORE_VERTICES * look.vertices_a_path().max(1.0),
            peak: method.photons_peak(),
            method,
            effort,
            settings: settings.clone(),
            taught: 0,
            verdict: None,
            elapsed: start.elapsed(),
        })
    }

    /// Goes on in another view of the same scene: by what is known already, which the paths of
    /// this view teach further. The seed must be another one: what guides a sample must not have
    /// been learned from it.
    pub fn moved(mut self, view: &View, settings: &LearnSettings) -> Self {
        let start = Instant::now();
        let look = importance::look(view, settings.photons);
        self.method.look_anew(&look);
        Self {
            effort: Effort::new(settings.photons, &look),
            peak: self.method.bytes(),
            settings: settings.clone(),
            taught: 0,
            elapsed: start.elapsed(),
            ..self
        }
    }

    /// What is known so far.
    pub fn guide(&self) -> Guidance<'_> {
        self.method.guide()
    }

    /// What is known so far, unless it turned out that guiding does not pay.
    pub fn worthwhile_guide(&self) -> Option<Guidance<'_>> {
        let pays = self.verdict.is_none_or(|v| v.pays());
        pays.then(|| self.guide())
    }

    /// Whether more camera paths are wanted.
    pub fn wants_more(&self) -> bool {
        self.taught < self.settings.paths && self.worthwhile_guide().is_some()
    }

    /// Which share of its camera paths have taught; all of them where no more are wanted.
    pub fn share_learned(&self) -> f64 {
        match self.wants_more() {
            true => self.taught as f64 / self.settings.paths as f64,
            false => 1.0,
        }
    }

    /// Whether camera paths teach it.
    pub fn has_taken_paths(&self) -> bool {
        self.taught > 0
    }

    /// Whether a trial is to tell now if guiding pays, after so many samples of each of the film's
    /// pixels: once learning begins to be much beside the work to come, and again later where it
    /// was in doubt.
    pub fn is_to_be_judged(&self, after: u64, pixels: u64) -> bool {
        let spp = self.effort.samples().map(|s| s / pixels.max(1) / ONE_IN);
        let spp = spp.map_or(AFTER, |spp| spp.clamp(1, AFTER));
        let first = 1 << spp.ilog2();
        match self.verdict {
            None => after == first,
            Some(verdict) => after == AGAIN * first && verdict.pays() && verdict.is_doubtful(),
        }
    }

    /// Paths of each of the trial's ways.
    pub fn trial_paths(&self) -> u64 {
        self.effort.trial()
    }

    /// Paths of a pass that teach, at most.
    pub fn most_training_paths(&self) -> u64 {
        let bytes = VERTEX_BYTES as f64 * self.vertices;
        let most = (room(&self.settings, self.method.bytes()) as f64 / bytes) as u64;
        let sure = self.verdict.is_some() || !self.settings.trial;
        most.min(self.effort.training_paths(sure, self.method.lesson()))
            .clamp(1, MOST_TRAINING_PATHS)
    }

    /// Takes note of whether guiding pays. If it does, the rest of the photons teach.
    pub fn judge(&mut self, view: &View, verdict: Verdict) {
        if !self.settings.trial {
            return;
        }
        let start = Instant::now();
        let again = self.verdict.is_some();
        let verdict = Verdict { again, ..verdict };
        self.verdict = Some(verdict);
        if !verdict.pays() {
            return;
        }
        let begun = start.checked_sub(self.elapsed).unwrap_or(start);
        self.method.teach_photons(view.scene, &self.settings, begun);
        self.peak = self.peak.max(self.method.photons_peak());
        self.elapsed += start.elapsed();
    }

    /// Tries how often manifold next-event estimation pays, where no pass of an image will.
    pub fn try_manifold(&mut self, view: &View) {
        self.method.try_manifold(view);
    }

    /// Sets the rate of manifold next-event estimation.
    pub fn set_manifold_rate(&mut self, rate: f32) {
        self.method.set_manifold_rate(rate);
    }

    /// Whether guiding pays, if that was tried.
    pub fn verdict(&self) -> Option<Verdict> {
        self.verdict
    }

    /// Learns from `paths` camera paths that were guided by what was known until now, and forgets
    /// the training samples.
    pub fn take(&mut self, training_samples: &mut [TrainingSamples], paths: u64) {
        let start = Instant::now();
        self.taught = self.taught.saturating_add(paths);
        let vertices: u64 = training_samples
            .iter()
            .map(|l| l.samples.len() as u64)
            .sum();
        self.vertices = (vertices as f64 / paths.max(1) as f64).max(1.0);
        let bytes = self.method.bytes() + vertices * VERTEX_BYTES;
        self.peak = self.peak.max(bytes);
        let (samples, fractions): (Vec<_>, Vec<_>) = training_samples
            .iter_mut()
            .map(std::mem::take)
            .map(|training_samples| (training_samples.samples, training_samples.fractions))
            .unzip();
        self.method.take(samples, fractions, &self.settings);
        self.elapsed += start.elapsed();
    }

    /// What became of the photons.
    pub fn counts(&self) -> PhotonCounts {
        self.method.counts()
    }

    /// Most bytes that learning held: trees, and the records that they learned from.
    pub fn peak_bytes(&self) -> u64 {
        self.peak
    }

    /// The trees in numbers.
    pub fn stats(&self) -> Stats {
        self.method.stats()
    }

    /// Wall-clock time that learning took so far, the tracing of camera paths left out.
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }
}

/// Learns the light field of a scene, as the paths of `view` will need it. A field that the view
/// has already is not looked at.
///
/// # Errors
/// When the scene's bounds are empty or a setting is out of range.
pub fn learn(view: &View, settings: &LearnSettings) -> Result<Learned, GuideError> {
    learn_until(view, settings, &|| false)
}

/// The same until it is stopped: what it knows then comes from the first photons and paths, and none
/// of them is left out.
///
/// # Errors
/// As [`learn`].
pub fn learn_until(
    view: &View,
    settings: &LearnSettings,
    stop: Stop,
) -> Result<Learned, GuideError> {
    let start = Instant::now();
    let mut learner = Learner::until(view, settings, stop)?;
    'batches: for paths in doubling(settings.paths, settings.batches) {
        let mut from = paths.start;
        while from < paths.end {
            let to = (from + learner.most_training_paths()).min(paths.end);
            let guide = Some(learner.guide());
            let Some(mut training_samples) = training_samples(view, guide, from..to, stop) else {
                break 'batches;
            };
            learner.take(&mut training_samples, to - from);
            from = to;
        }
    }
    let (stats, counts) = (learner.stats(), learner.counts());
    let Method::Double(double) = learner.method else {
        unreachable!("a learner that was made by new");
    };
    Ok(Learned {
        stats,
        counts,
        paths: learner.taught,
        guide: double.guide,
        trainer: double.trainer,
        elapsed: start.elapsed(),
    })
}

/// A field of noise over the scene's bounds: for tests that show that no field can change the mean.
pub fn garbage(scene: &Scene, model: ModelKind, seed: u64) -> Guide {
    let bounds = scene.rays.bounds();
    let field = Field::random(bounds.min, bounds.max, model, seed);
    Guide {
        fractions: Fractions::random(&field, seed),
        manifold: None,
        field,
    }
}

/// An SD-tree of noise over the scene's bounds, for the same.
pub fn garbage_sd_tree(scene: &Scene, seed: u64) -> Guide<SdTree> {
    let bounds = scene.rays.bounds();
    let field = PpgTrainer::random(bounds.min, bounds.max, seed).freeze();
    Guide {
        fractions: Fractions::random(&field, seed),
        manifold: None,
        field,
    }
}
