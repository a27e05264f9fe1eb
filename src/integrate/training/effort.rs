//! What rendering and learning cost, counted instead of timed.
//!
//! What is decided by cost has to be the same on every machine and for any number of threads, so no
//! clock is read. Rays, vertices, photons and records are counted, and each stands for the
//! processor time that it took on average where that was measured: the ten places of
//! `tests/bench/rooms.py`, one thread. Only the ratios matter.

use super::importance::Look;
use crate::photon::schedule::Budget;

/// Nanoseconds of an unguided path, besides its rays: its camera ray and its place in the film.
const PATH: f64 = 100.0;
/// Of a ray of an unguided path, with what is done where it lands.
const RAY: f64 = 330.0;
/// Of a ray of a guided path: the field is asked. (Over an unguided one, 0.9 where there are many
/// lamps, 1.0 under a sky that takes long to draw from, 1.3 in a bathroom, 1.6 in a corridor and in
/// a furnace, 1.7 in a pool.)
const GUIDED_RAY: f64 = 400.0;
/// Of a photon, besides its landings.
const PHOTON: f64 = 250.0;
/// Of a landing: its ray, and learning from it.
const LANDING: f64 = 900.0;
/// Of a vertex of a path that teaches a double hierarchy, beyond what the path costs in any case.
pub const LESSON: f64 = 900.0;
/// The same of an SD-tree, about. (veach-ajar, one thread: learning takes 0.7 s instead of the
/// 0.3 s that it takes where a lesson counts four times as much.)
pub const SD_TREE_LESSON: f64 = 0.25 * LESSON;

/// Rays of an unguided path for each rough vertex: one goes on, one looks for light.
const RAYS_A_VERTEX: f64 = 2.0;

/// What photons may take of the work to come before it is known whether guiding pays, and in all.
/// More of them are not better: they divide the field's cells further than camera paths can fill
/// them (measured: `EXPERIMENTS.md`).
pub const PHOTONS: [f64; 2] = [0.005, 0.03];
/// What learning from the samples of one pass may take of it, before that and after.
pub const LESSONS: [f64; 2] = [0.007, 0.05];
/// What all learning after a verdict takes of it, about.
const STILL_TO_LEARN: f64 = 0.15;
/// What each of a trial's two ways may take of the image's samples, and paths that it has in any
/// case: fewer are too few to meet what is rare.
pub const TRIAL: f64 = 0.012;
const LEAST_TRIAL: u64 = 1 << 12;

/// Cost of a path with so many rays.
pub fn path(rays: f64) -> f64 {
    PATH + RAY * rays
}

/// The same where a field guides, which is still learning: where an unguided path would have
/// `unguided` rays.
pub fn guided_path(rays: f64, unguided: f64) -> f64 {
    PATH + GUIDED_RAY * rays + STILL_TO_LEARN * path(unguided)
}

/// Cost of so many photons, of which so many landings teach.
pub fn photons(emitted: u64, landings: u64) -> f64 {
    PHOTON * emitted as f64 + LANDING * landings as f64
}

/// The work that is to come, as far as it is known before it begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// Samples of the image, if they are limited.
    samples: Option<u64>,
    /// Cost of one without guiding.
    sample: f64,
    /// Rough vertices of a path.
    vertices: f64,
}

impl Effort {
    /// The effort of a render of this budget, whose paths a look has met.
    pub fn new(budget: Budget, look: &Look) -> Self {
        let samples = match budget {
            Budget::AsNeeded { samples, .. } => Some(samples).filter(|s| *s < u64::MAX),
            Budget::Exactly { .. } => None,
        };
        let vertices = look.vertices_a_path();
        Self {
            samples,
            sample: path(1.0 + RAYS_A_VERTEX * vertices),
            vertices,
        }
    }

    /// Samples of the image, if they are limited.
    pub fn samples(&self) -> Option<u64> {
        self.samples
    }

    /// What so much work is worth in samples of the image.
    pub fn in_samples(&self, cost: f64) -> f64 {
        cost / self.sample
    }

    /// How many paths of a pass may teach: what is learned from them takes its share of the work to
    /// come. `sure`: it is known that guiding pays. `lesson`: what a vertex costs.
    pub fn training_paths(&self, sure: bool, lesson: f64) -> u64 {
        let Some(samples) = self.samples else {
            return u64::MAX;
        };
        let each = lesson * self.vertices.max(1.0);
        (LESSONS[usize::from(sure)] * samples as f64 * self.sample / each) as u64
    }

    /// Paths of each of a trial's two ways.
    pub fn trial(&self) -> u64 {
        let share = |samples| ((TRIAL * samples as f64) as u64).max(LEAST_TRIAL);
        self.samples.map_or(u64::MAX, share)
    }
}
