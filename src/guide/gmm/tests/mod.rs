//! Tests of cached mixtures.

mod hostile;
mod learning;
mod sampling;

use super::Sample;
use super::em::Learning;
use crate::guide::gaussian::{LOBES, Lobe};

/// Fits a mixture to photons in steps of `step`: what a record does. Photons whose place or weight
/// is not finite, or that weigh nothing, are left out; without any there is no mixture.
fn fit(samples: &[Sample], step: usize, rate: f64, seed: u64) -> Option<[Lobe; LOBES]> {
    let sound: Vec<Sample> = samples.iter().copied().filter(Sample::is_sound).collect();
    let first = sound.len().min(step.max(1));
    if first == 0 {
        return None;
    }
    let mut learning = Learning::start(&sound[..first], seed);
    for samples in sound[first..].chunks(step.max(1)) {
        learning.step(samples, rate);
    }
    Some(*learning.lobes())
}
