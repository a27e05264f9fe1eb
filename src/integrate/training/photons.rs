//! The photons that teach a field: how many, in what parts, and what they cost.
//!
//! Where a render learns on the way and may find that guiding does not pay, photons come in two
//! helpings: a small one before the trial, and the others once it is known that they are worth
//! their while.

use super::count::{add_traced, expect_photons};
use super::effort::{self, Effort};
use super::settings::LearnSettings;
use crate::guide::{BATCH, GuideError, Photon, Settings, Source, SurfacePoint, Trainer};
use crate::integrate::progress::Stop;
use crate::photon::schedule::{Budget, Experience, Schedule, part};
use crate::photon::wave::PhotonWave;
use crate::photon::{Landing, PhotonCounts};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::time::Instant;

/// Rounds of refining after a batch.
pub(super) const ROUNDS: u32 = 4;
/// Points that measure what lies inside cells, at most; at least a sixty-fourth of that.
const AREA_POINTS: usize = 1 << 20;
/// A small image has one for so many of its samples: its field has few cells.
const SAMPLES_A_POINT: u64 = 16;
/// Photons in a wave: one task.
const WAVE_PHOTONS: u64 = 8192;
/// Bytes of a landing: it waits to be learned from, or as it was learned from.
const LANDING_BYTES: u64 = 100;

/// Of the memory one part in so many is kept for records, whatever the trees take.
const LEAST_ROOM: u64 = 2;

/// How far photons go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Portion {
    /// As far as is worth it before anybody knows whether guiding pays.
    First,
    /// As far as is worth it.
    All,
}

/// What teaches from photons, batch by batch.
#[derive(Clone, Debug)]
pub(super) struct PhotonTraining {
    schedule: Schedule,
    effort: Effort,
    landings: u64,
    /// What became of them so far.
    pub counts: PhotonCounts,
    /// Most bytes that learning from them held at a time.
    pub peak: u64,
}

impl PhotonTraining {
    /// None yet.
    pub fn new(settings: &LearnSettings, effort: Effort) -> Self {
        Self {
            schedule: Schedule::new(settings.photons),
            effort,
            landings: 0,
            counts: PhotonCounts::default(),
            peak: 0,
        }
    }

    /// Teaches, until photons are no longer worth what they cost, or nobody wants more: what is
    /// being traced then is lost. `begun` is when learning began.
    pub fn teach(
        &mut self,
        (scene, settings): (&Scene, &LearnSettings),
        trainer: &mut Trainer,
        helping: Portion,
        begun: Instant,
        stop: Stop,
    ) {
        let share = effort::PHOTONS[usize::from(helping == Portion::All)];
        self.schedule.open(share);
        expect_photons(self.schedule.expected().unwrap_or(0));
        while let Some(mut photons) = self.schedule.next_batch() {
            let (before, landed_before, mut gain) = (self.landings, self.counts.emitted, 0.0);
            while !photons.is_empty() {
                let room = room(settings, trainer.bytes()) / LANDING_BYTES;
                let part = part(&mut photons, self.landings, room.min(BATCH));
                let Some(landed) = trace_batch((scene, settings), part.clone(), stop) else {
                    return;
                };
                gain += self.learn_from(landed, part.end - part.start, trainer);
            }
            let landings = self.landings - before;
            let cost = effort::photons(self.counts.emitted - landed_before, landings);
            self.schedule.learned(Experience {
                landings,
                gain,
                work: self.effort.in_samples(cost),
                elapsed: begun.elapsed(),
            });
            expect_photons(self.schedule.expected().unwrap_or(0));
        }
    }

    /// Learns from a part of a batch, of so many photons; what refining gained by it.
    fn learn_from(&mut self, part: Landed, emitted: u64, trainer: &mut Trainer) -> f64 {
        let (landed, batch) = part;
        self.counts += batch;
        let count = landed.iter().map(|l| l.len() as u64).sum::<u64>();
        self.landings += count;
        trainer.train_on_photons(landed, emitted);
        self.peak = self.peak.max(trainer.bytes() + count * LANDING_BYTES);
        trainer.refine_rounds(ROUNDS).gain
    }
}

/// Bytes that records may take beside trees that take so many.
pub(super) fn room(settings: &LearnSettings, trees: u64) -> u64 {
    let least = settings.memory / LEAST_ROOM;
    settings.memory.saturating_sub(trees).max(least)
}

/// Bytes that trees may take: the rest is for the records.
pub(super) fn trees_memory(settings: &LearnSettings) -> u64 {
    settings.memory - settings.memory / LEAST_ROOM
}

/// Points for a field that is learned from so many photons.
fn area_points(photons: Budget) -> usize {
    let Budget::AsNeeded { samples, .. } = photons else {
        return AREA_POINTS;
    };
    let points = usize::try_from(samples / SAMPLES_A_POINT).unwrap_or(AREA_POINTS);
    points.clamp(AREA_POINTS / 64, AREA_POINTS)
}

/// A trainer that knows the scene's bounds and how much surface and medium lies where.
pub(super) fn prepare(scene: &Scene, settings: &LearnSettings) -> Result<Trainer, GuideError> {
    let bounds = scene.rays.bounds();
    let mut guide_settings = Settings::new(bounds.min, bounds.max);
    guide_settings.memory = trees_memory(settings);
    guide_settings.seed = settings.photon.seed;
    guide_settings.model = settings.model;
    guide_settings.source = match (settings.photons.is_none(), settings.paths) {
        (true, _) => Source::Paths,
        (_, 0) => Source::Photons,
        _ => Source::Both,
    };
    // Thin walls, lit from one side, are everywhere in real scenes.
    guide_settings.normal_split = true;
    guide_settings.media = scene.media.scatter();
    let mut trainer = Trainer::build(guide_settings)?;
    if settings.photons.is_none() {
        return Ok(trainer);
    }
    let count = area_points(settings.photons);
    let (points, area) = scene.area_points(count, settings.photon.seed);
    // Light lands on either side of a surface.
    let sides = points.iter().flat_map(|p| {
        [p.normal, -p.normal].map(|normal| SurfacePoint {
            position: p.position,
            normal,
        })
    });
    trainer.set_surface(&sides.collect::<Vec<_>>(), 2.0 * area);
    if scene.media.scatter() {
        let (points, cross_section) = scene.medium_points(count, settings.photon.seed);
        trainer.set_media(&points, cross_section);
    }
    Ok(trainer)
}

/// The landings of photons, wave by wave, and what became of all of them.
pub(super) type Landed = (Vec<Vec<Photon>>, PhotonCounts);

/// Traces a batch, in waves side by side; the landings of each, in photon order. `None` if it was
/// stopped.
pub(super) fn trace_batch(
    (scene, settings): (&Scene, &LearnSettings),
    range: Range<u64>,
    stop: Stop,
) -> Option<Landed> {
    let starts: Vec<u64> = range.clone().step_by(WAVE_PHOTONS as usize).collect();
    let waves: Option<Vec<_>> = starts
        .par_iter()
        .map_init(PhotonWave::default, |wave, &from| {
            if stop() {
                return None;
            }
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
            landed.shrink_to_fit();
            add_traced(to - from);
            Some((landed, counts))
        })
        .collect();
    let (landed, counts): (Vec<_>, Vec<_>) = waves?.into_iter().unzip();
    let mut sum = PhotonCounts::default();
    counts.into_iter().for_each(|wave| sum += wave);
    Some((landed, sum))
}
