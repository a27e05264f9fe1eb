//! What a learner teaches: a double hierarchy, or the rival that it is compared with.

use super::effort::{self, Effort};
use super::importance::{self, Look};
use super::photons::{PhotonTraining, Portion, ROUNDS, prepare, trees_memory};
use super::settings::LearnSettings;
use super::trial;
use crate::guide::ppg::{self, PpgTrainer, SdTree};
use crate::guide::{FractionRecord, GuideError, PathSample, Stats, Trainer};
use crate::integrate::context::View;
use crate::integrate::guiding::{Guidance, Guide};
use crate::integrate::manifold::{ManifoldSampling, find_chains};
use crate::integrate::progress::Stop;
use crate::math::Vec3;
use crate::photon::PhotonCounts;
use crate::scene::Scene;
use std::time::Instant;

/// A double hierarchy.
#[derive(Debug)]
pub(super) struct Double {
    pub trainer: Trainer,
    pub guide: Guide,
    pub photons: PhotonTraining,
}

/// An SD-tree.
#[derive(Debug)]
pub(super) struct Ppg {
    trainer: PpgTrainer,
    guide: Guide<SdTree>,
}

/// What is taught.
#[derive(Debug)]
pub(super) enum Method {
    Double(Box<Double>),
    Ppg(Box<Ppg>),
}

impl Method {
    /// A double hierarchy that has learned from photons, where the paths of a look came.
    pub fn double(
        view: &View,
        settings: &LearnSettings,
        (look, effort): (&Look, Effort),
        begun: Instant,
        stop: Stop,
    ) -> Result<Self, GuideError> {
        let mut trainer = prepare(view.scene, settings)?;
        if !settings.photons.is_none() {
            trainer.set_importance(&look.points, importance::PER_CELL);
        }
        let mut photons = PhotonTraining::new(settings, effort);
        let helping = match settings.trial && settings.paths > 0 {
            true => Portion::First,
            false => Portion::All,
        };
        photons.teach((view.scene, settings), &mut trainer, helping, begun, stop);
        let mut guide = Guide::new(trainer.freeze()).with_mixture(settings.mixture);
        guide.manifold = find_chains(view, settings.photons).map(ManifoldSampling::new);
        Ok(Self::Double(Box::new(Double {
            trainer,
            guide,
            photons,
        })))
    }

    /// An SD-tree that knows nothing yet.
    pub fn ppg(
        view: &View,
        settings: &LearnSettings,
        target: ppg::Target,
    ) -> Result<Self, GuideError> {
        let bounds = view.scene.rays.bounds();
        let trainer = PpgTrainer::new(ppg::Settings {
            target,
            memory: trees_memory(settings),
            ..ppg::Settings::new(bounds.min, bounds.max)
        })?;
        let mut guide = Guide::new(trainer.freeze()).with_mixture(settings.mixture);
        guide.manifold = find_chains(view, settings.photons).map(ManifoldSampling::new);
        Ok(Self::Ppg(Box::new(Ppg { trainer, guide })))
    }

    /// Grows from now on where these paths of a camera came.
    pub fn look_anew(&mut self, look: &Look) {
        if let Self::Double(double) = self {
            double
                .trainer
                .set_importance(&look.points, importance::PER_CELL);
        }
    }

    /// What is known so far.
    pub fn guide(&self) -> Guidance<'_> {
        match self {
            Self::Double(double) => (&double.guide).into(),
            Self::Ppg(ppg) => (&ppg.guide).into(),
        }
    }

    /// Cost of a vertex that teaches.
    pub fn lesson(&self) -> f64 {
        match self {
            Self::Double(_) => effort::LESSON,
            Self::Ppg(_) => effort::SD_TREE_LESSON,
        }
    }

    /// Bytes that the trees take while they learn.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Double(double) => double.trainer.bytes(),
            Self::Ppg(ppg) => ppg.trainer.bytes(),
        }
    }

    /// The trees in numbers.
    pub fn stats(&self) -> Stats {
        match self {
            Self::Double(double) => double.trainer.stats(),
            Self::Ppg(ppg) => ppg.trainer.stats(),
        }
    }

    /// What became of the photons.
    pub fn counts(&self) -> PhotonCounts {
        self.photons().map(|p| p.counts).unwrap_or_default()
    }

    /// Most bytes that learning from photons held.
    pub fn photons_peak(&self) -> u64 {
        self.photons().map_or(0, |p| p.peak)
    }

    fn photons(&self) -> Option<&PhotonTraining> {
        match self {
            Self::Double(double) => Some(&double.photons),
            Self::Ppg(_) => None,
        }
    }

    /// Learns from all photons that are worth their while. `begun` is when learning began.
    pub fn teach_photons(&mut self, scene: &Scene, settings: &LearnSettings, begun: Instant) {
        let Self::Double(double) = self else { return };
        let Double {
            trainer,
            guide,
            photons,
        } = &mut **double;
        photons.teach((scene, settings), trainer, Portion::All, begun, &|| false);
        guide.renew(trainer.freeze(), settings.mixture);
    }

    /// Learns from camera paths, and guides by what is known then. The records are let go of as
    /// soon as they have taught: they are most of what learning holds.
    pub fn take(
        &mut self,
        mut samples: Vec<Vec<PathSample>>,
        fractions: Vec<Vec<FractionRecord>>,
        settings: &LearnSettings,
    ) {
        if settings.mixture.is_none() {
            match self {
                Self::Double(double) => double.guide.learn_fractions(&fractions),
                Self::Ppg(ppg) => ppg.guide.learn_fractions(&fractions),
            }
        }
        drop(fractions);
        match self {
            Self::Double(double) => {
                let Double { trainer, guide, .. } = &mut **double;
                trainer.train_paths(samples);
                trainer.refine_rounds(ROUNDS);
                guide.renew(trainer.freeze(), settings.mixture);
            }
            Self::Ppg(ppg) => {
                let on_surfaces = |s: &PathSample| s.normal != Vec3::ZERO;
                samples.iter_mut().for_each(|part| part.retain(on_surfaces));
                ppg.trainer.train(&samples);
                drop(samples);
                ppg.guide.renew(ppg.trainer.freeze(), settings.mixture);
                ppg.trainer.refine();
            }
        }
    }

    /// Tries how often manifold next-event estimation pays, where no pass of an image will.
    pub fn try_manifold(&mut self, view: &View) {
        match self {
            Self::Double(double) => trial::try_manifold(view, &mut double.guide),
            Self::Ppg(ppg) => trial::try_manifold(view, &mut ppg.guide),
        }
    }

    /// Sets the rate of manifold next-event estimation.
    pub fn set_manifold_rate(&mut self, rate: f32) {
        match self {
            Self::Double(double) => double.guide.set_manifold_rate(rate),
            Self::Ppg(ppg) => ppg.guide.set_manifold_rate(rate),
        }
    }
}
