//! Learning cached mixtures: the same photons as [`super::learn`] takes, in batches of one size.
//!
//! Records stand where camera paths scatter; a look through the camera says where that is. Photons
//! alone teach, as in the paper.

use super::importance;
use super::photons::trace_batch;
use super::settings::LearnSettings;
use crate::guide::GuideError;
use crate::guide::gmm::{GmmTrainer, Mixtures, Settings};
use crate::integrate::context::View;
use crate::math::Vec3;
use crate::photon::PhotonCounts;
use crate::photon::schedule::Budget;
use crate::scene::Scene;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Photons of the paper.
pub const PHOTONS: u64 = 9_000_000;
/// Batches of the paper.
const BATCHES: u32 = 30;

/// Camera paths of the look: what they do not meet is not served.
const PATHS: u64 = 1 << 16;

/// What learning came to.
#[derive(Debug)]
pub struct LearnedMixtures {
    /// The field.
    pub mixtures: Mixtures,
    /// What became of the photons.
    pub counts: PhotonCounts,
    /// Bytes that the records took while they learned.
    pub training_bytes: u64,
    /// Wall-clock time.
    pub elapsed: Duration,
}

/// Learns mixtures from photons in equal batches (the paper's 30 of 300 000, if no number is
/// given), where the paths of `view` may come. Of the other settings only the memory and the
/// photons' own count.
///
/// # Errors
/// When the scene's bounds are empty or a setting is out of range.
pub fn learn_mixtures(
    view: &View,
    settings: &LearnSettings,
) -> Result<LearnedMixtures, GuideError> {
    let start = Instant::now();
    let bounds = view.scene.rays.bounds();
    let mut how = Settings::new(bounds.min, bounds.max);
    let (photons, count) = match settings.photons {
        Budget::Exactly { photons, batches } => (photons, batches),
        Budget::AsNeeded { .. } => (PHOTONS, BATCHES),
    };
    how.batches = count;
    how.memory = settings.memory;
    how.seed = settings.photon.seed;
    let mut trainer = GmmTrainer::new(how, &importance::met_by(view, PATHS))?;
    let mut counts = PhotonCounts::default();
    for numbers in batches(photons, count) {
        let emitted = numbers.end - numbers.start;
        let Some((landed, batch)) = trace_batch((view.scene, settings), numbers, &|| false) else {
            break;
        };
        counts += batch;
        let mut landed = landed.concat();
        landed.retain(|photon| photon.normal != Vec3::ZERO);
        trainer.train(&landed, emitted);
    }
    Ok(LearnedMixtures {
        mixtures: trainer.freeze(),
        counts,
        training_bytes: trainer.bytes(),
        elapsed: start.elapsed(),
    })
}

/// Cuts `records` into `count` ranges of one size, but for rounding; empty ones are left out.
fn batches(records: u64, count: u32) -> impl Iterator<Item = Range<u64>> {
    let count = u64::from(count.max(1));
    let end = move |i: u64| (u128::from(records) * u128::from(i) / u128::from(count)) as u64;
    let ranges = (0..count).map(move |i| end(i)..end(i + 1));
    ranges.filter(|r| !r.is_empty())
}

/// Mixtures of noise over the scene's bounds: for tests that show that no field can change the
/// mean.
pub fn garbage(scene: &Scene, seed: u64) -> Mixtures {
    let bounds = scene.rays.bounds();
    Mixtures::random(bounds.min, bounds.max, seed)
}
