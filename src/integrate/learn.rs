//! Learning the field: from photons before rendering, then from camera paths.
//!
//! Photons come first, in batches (see [`crate::photon::schedule`]). Camera paths guided by what is known so far then teach the rest, above all what the
//! camera sees and photons hardly reach. They are samples of the image like any other: whoever renders
//! hands the [`Lessons`] of its first passes to a [`Learner`] and renders the next pass with what that
//! has learned ([`super::render`] does). [`learn`] makes paths of its own, for a field without an image.

use super::chain::Aiming;
use super::guiding::Guide;
use super::importance;
use super::record::{Lessons, Records};
use super::render::View;
use super::trial::{self, Verdict};
use super::vertex::Walk;
use super::wave::Wave;
use crate::camera::CameraRay;
use crate::guide::{
    BATCH, Field, Fractions, GuideError, ModelKind, Photon, Settings, Source, Stats, SurfacePoint,
    Trainer,
};
use crate::math::{PathSampler, Vec2};
use crate::photon::schedule::{Budget, Experience, Schedule, doubling, part};
use crate::photon::wave::PhotonWave;
use crate::photon::{Landing, PhotonCounts, PhotonSettings};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Photons in a wave: one task.
const WAVE_PHOTONS: u64 = 8192;
/// Camera paths in a wave.
const WAVE_PATHS: u64 = 4096;
/// Points that measure the area inside cells, at most; at least a sixteenth of that.
const AREA_POINTS: usize = 1 << 20;
/// A small image has one for so many of its samples: its field has few cells.
const SAMPLES_A_POINT: u64 = 8;
/// Rounds of refining after a batch.
const ROUNDS: u32 = 4;

/// How a field is learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnSettings {
    /// Photon paths; none of them learns from camera paths alone.
    pub photons: Budget,
    /// Camera paths in all; 0 learns from photons alone.
    pub paths: u64,
    /// Batches that paths come in, where they are not those of an image; each is twice as large as the
    /// one before.
    pub batches: u32,
    /// Most bytes of the trees while they are trained.
    pub memory: u64,
    /// How photons are traced.
    pub photon: PhotonSettings,
    /// The model on each link.
    pub model: ModelKind,
    /// Share of the directions that are drawn from the field everywhere; `None` learns it.
    pub mixture: Option<f32>,
    /// Whether guiding may turn out not to pay, and end.
    pub trial: bool,
}

/// What learning came to.
#[derive(Debug)]
pub struct Learned {
    /// The field.
    pub guide: Guide,
    /// What became of the photons.
    pub counts: PhotonCounts,
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
    trainer: Trainer,
    guide: Guide,
    mixture: Option<f32>,
    trial: bool,
    paths: u64,
    taught: u64,
    counts: PhotonCounts,
    verdict: Option<Verdict>,
    elapsed: Duration,
}

impl Learner {
    /// Learns from photons, where the paths of `view` may come.
    ///
    /// # Errors
    /// When the scene's bounds are empty or a setting is out of range.
    pub fn new(view: &View, settings: &LearnSettings) -> Result<Self, GuideError> {
        let start = Instant::now();
        let scene = view.scene;
        let mut trainer = prepare(scene, settings)?;
        if !settings.photons.is_none() {
            trainer.set_importance_sample(&importance::met_by_camera(view), importance::PER_CELL);
        }
        let mut counts = PhotonCounts::default();
        let mut schedule = Schedule::new(settings.photons);
        let mut landings = 0;
        while let Some(mut photons) = schedule.next_batch() {
            let (before, mut gain) = (landings, 0.0);
            while !photons.is_empty() {
                let part = part(&mut photons, landings, BATCH);
                let emitted = part.end - part.start;
                let (landed, batch) = trace_batch(scene, settings, part);
                counts += batch;
                landings += landed.len() as u64;
                trainer.train(&landed, emitted);
                gain += trainer.refine_rounds(ROUNDS).gain;
            }
            schedule.learned(Experience {
                landings: landings - before,
                gain,
                elapsed: start.elapsed(),
            });
        }
        let mut guide = Guide::new(trainer.freeze()).with_mixture(settings.mixture);
        guide.aiming = Aiming::find(view, settings.photons);
        Ok(Self {
            guide,
            trainer,
            mixture: settings.mixture,
            trial: settings.trial,
            paths: settings.paths,
            taught: 0,
            counts,
            verdict: None,
            elapsed: start.elapsed(),
        })
    }

    /// What is known so far.
    pub fn guide(&self) -> &Guide {
        &self.guide
    }

    /// What is known so far, unless it turned out that guiding does not pay.
    pub fn worthwhile_guide(&self) -> Option<&Guide> {
        let pays = self.verdict.is_none_or(|v| v.pays());
        pays.then_some(&self.guide)
    }

    /// Whether more camera paths are wanted.
    pub fn wants_more(&self) -> bool {
        self.taught < self.paths && self.worthwhile_guide().is_some()
    }

    /// Whether camera paths teach it.
    pub fn has_taken_paths(&self) -> bool {
        self.taught > 0
    }

    /// Takes note of whether guiding pays.
    pub fn judge(&mut self, verdict: Verdict) {
        self.verdict = Some(verdict).filter(|_| self.trial);
    }

    /// Tries how often aiming at suns and lamps pays, where no pass of an image will.
    pub fn try_aiming(&mut self, view: &View) {
        trial::aim(view, &mut self.guide);
    }

    /// Takes note of how often aiming at suns and lamps pays.
    pub fn aim(&mut self, chance: f32) {
        self.guide.aim(chance);
    }

    /// Whether guiding pays, if that was tried.
    pub fn verdict(&self) -> Option<Verdict> {
        self.verdict
    }

    /// Learns from `paths` camera paths that were guided by what was known until now.
    pub fn take(&mut self, lessons: &[Lessons], paths: u64) {
        let start = Instant::now();
        self.taught = self.taught.saturating_add(paths);
        train(&mut self.trainer, lessons);
        self.trainer.refine_rounds(ROUNDS);
        if self.mixture.is_none() {
            let parts: Vec<_> = lessons.iter().map(|l| &l.fractions[..]).collect();
            let Guide {
                field, fractions, ..
            } = &mut self.guide;
            fractions.update_in_parts(field, &parts);
        }
        let field = self.trainer.freeze();
        let fractions = self.guide.fractions.carried_over(&self.guide.field, &field);
        self.guide = Guide {
            field,
            fractions,
            aiming: self.guide.aiming.take(),
        }
        .with_mixture(self.mixture);
        self.elapsed += start.elapsed();
    }

    /// What became of the photons.
    pub fn counts(&self) -> PhotonCounts {
        self.counts
    }

    /// The trees in numbers.
    pub fn stats(&self) -> Stats {
        self.trainer.stats()
    }

    /// Wall-clock time that learning took so far, the tracing of camera paths left out.
    pub fn elapsed(&self) -> Duration {
        self.elapsed
    }
}

/// Learns the light field of a scene, as the paths of `view` will need it. A field that the view has
/// already is not looked at.
///
/// # Errors
/// When the scene's bounds are empty or a setting is out of range.
pub fn learn(view: &View, settings: &LearnSettings) -> Result<Learned, GuideError> {
    let start = Instant::now();
    let mut learner = Learner::new(view, settings)?;
    for paths in doubling(settings.paths, settings.batches) {
        let count = paths.end - paths.start;
        let lessons = lessons(view, Some(learner.guide()), paths);
        learner.take(&lessons, count);
    }
    Ok(Learned {
        stats: learner.stats(),
        counts: learner.counts,
        guide: learner.guide,
        trainer: learner.trainer,
        elapsed: start.elapsed(),
    })
}

/// Points for a field that is learned from so many photons.
fn area_points(photons: Budget) -> usize {
    let Budget::AsNeeded { samples, .. } = photons else {
        return AREA_POINTS;
    };
    let points = usize::try_from(samples / SAMPLES_A_POINT).unwrap_or(AREA_POINTS);
    points.clamp(AREA_POINTS / 16, AREA_POINTS)
}

/// A trainer that knows the scene's bounds and how much surface lies where.
fn prepare(scene: &Scene, settings: &LearnSettings) -> Result<Trainer, GuideError> {
    let bounds = scene.rays.bounds();
    let mut guide_settings = Settings::new(bounds.min, bounds.max);
    guide_settings.memory = settings.memory;
    guide_settings.seed = settings.photon.seed;
    guide_settings.model = settings.model;
    guide_settings.source = match (settings.photons.is_none(), settings.paths) {
        (true, _) => Source::Paths,
        (_, 0) => Source::Photons,
        _ => Source::Both,
    };
    // Thin walls, lit from one side, are everywhere in real scenes.
    guide_settings.normal_split = true;
    let mut trainer = Trainer::build(guide_settings)?;
    if settings.photons.is_none() {
        return Ok(trainer);
    }
    let (points, area) = scene.area_points(area_points(settings.photons), settings.photon.seed);
    // Light lands on either side of a surface.
    let sides = points.iter().flat_map(|p| {
        [p.normal, -p.normal].map(|normal| SurfacePoint {
            position: p.position,
            normal,
        })
    });
    trainer.set_surface(&sides.collect::<Vec<_>>(), 2.0 * area);
    Ok(trainer)
}

/// *Trains* on what camera paths taught.
pub(super) fn train(trainer: &mut Trainer, lessons: &[Lessons]) {
    let parts: Vec<_> = lessons.iter().map(|l| &l.samples[..]).collect();
    trainer.train_paths_in_parts(&parts);
}

/// Traces camera paths, in waves side by side; the lessons of each, in order. Path `i` of a film of
/// n pixels looks through a pixel of its own, so that a long enough run covers the film evenly.
pub(super) fn lessons(view: &View, guide: Option<&Guide>, range: Range<u64>) -> Vec<Lessons> {
    let starts: Vec<u64> = range.clone().step_by(WAVE_PATHS as usize).collect();
    let walk = Walk {
        guide: guide.map(Into::into),
        ..view.walk()
    };
    starts
        .par_iter()
        .map_init(<(Wave, Records)>::default, |(wave, records), &from| {
            wave.clear();
            for i in from..(from + WAVE_PATHS).min(range.end) {
                let (ray, sampler) = training_ray(view, i);
                wave.push(ray, sampler);
            }
            let mut lessons = Lessons::default();
            let outcomes = wave.trace(&walk, records);
            records.conclude(outcomes, &mut lessons);
            lessons
        })
        .collect()
}

/// Camera ray `i` of training and the numbers of its path.
fn training_ray(view: &View, i: u64) -> (CameraRay, PathSampler) {
    let (w, h) = (u64::from(view.film.width), u64::from(view.film.height));
    // Steps of the golden ratio visit all pixels in turn and neighbours far apart.
    let pixel = ((i as f64 * 0.618_033_988_749_894_9).fract() * (w * h) as f64) as u64 % (w * h);
    let mut sampler = PathSampler::independent(view.settings.seed ^ TRAINING, pixel, i);
    let u = sampler.next4();
    let at = Vec2::new((pixel % w) as f32 + u[0], (pixel / w) as f32 + u[1]);
    let ray = view.camera.ray(at, Vec2::new(u[2], u[3]));
    (ray, sampler)
}

/// Sets the numbers of training paths apart from the image's.
const TRAINING: u64 = 0x5851_f42d_4c95_7f2d;

/// Traces a batch, in waves side by side whose landings are joined in photon order.
pub(super) fn trace_batch(
    scene: &Scene,
    settings: &LearnSettings,
    range: Range<u64>,
) -> (Vec<Photon>, PhotonCounts) {
    let starts: Vec<u64> = range.clone().step_by(WAVE_PHOTONS as usize).collect();
    let waves: Vec<_> = starts
        .par_iter()
        .map_init(PhotonWave::default, |wave, &from| {
            let mut landed = Vec::new();
            let to = (from + WAVE_PHOTONS).min(range.end);
            let counts = wave.trace(scene, &settings.photon, from..to, &mut |l: Landing| {
                // What comes straight from an emitter is found by next-event estimation.
                if l.bounces > 0 {
                    landed.push(Photon {
                        position: l.position,
                        direction: l.direction,
                        power: l.power,
                        distance: l.distance,
                        normal: l.normal,
                    });
                }
            });
            (landed, counts)
        })
        .collect();
    let mut photons = Vec::with_capacity(waves.iter().map(|w| w.0.len()).sum());
    let mut counts = PhotonCounts::default();
    for (landed, wave) in waves {
        photons.extend(landed);
        counts += wave;
    }
    (photons, counts)
}

/// A field of noise over the scene's bounds: for tests that show that no field can change the mean.
pub fn garbage(scene: &Scene, model: ModelKind, seed: u64) -> Guide {
    let bounds = scene.rays.bounds();
    let field = Field::random(bounds.min, bounds.max, model, seed);
    Guide {
        fractions: Fractions::random(&field, seed),
        aiming: None,
        field,
    }
}
