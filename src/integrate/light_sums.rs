//! The radiance of a wave's accumulators, taken into the parts that the film asks for.
//!
//! All that is done with accumulators is done with their parts, too: branches are added to the
//! samples that they were split off from, and what was found behind a prefix is shared with the
//! same weights. So the parts of a sample come to its radiance, but for rounding.

use super::splitting::SplitPaths;
use crate::film::Extras;
use crate::light::{LightSource, Lights};
use crate::math::Rgb;
use std::sync::Arc;

/// Radiance by accumulator and part.
#[derive(Clone, Debug)]
pub struct LightSums {
    extras: Arc<Extras>,
    /// Parts of an accumulator.
    count: usize,
    /// Groups of emitters, by their numbers.
    groups: Vec<usize>,
    sums: Vec<Rgb>,
}

impl LightSums {
    /// For the parts of these extras; `None` if there are none.
    pub fn new(extras: &Arc<Extras>) -> Option<Self> {
        let count = extras.light.count();
        (count > 0).then(|| Self {
            extras: extras.clone(),
            count,
            groups: extras.light.groups_of_emitters(),
            sums: Vec::new(),
        })
    }

    /// Whether they are for these extras.
    pub fn are_for(&self, extras: &Arc<Extras>) -> bool {
        Arc::ptr_eq(&self.extras, extras)
    }

    /// Forgets all light.
    pub fn clear(&mut self) {
        self.sums.clear();
    }

    /// Adds light that was scattered so often.
    pub fn add(
        &mut self,
        lights: &Lights,
        accumulator: u32,
        bounces: u32,
        light: Rgb,
        from: LightSource,
    ) {
        if light == Rgb::ZERO {
            return;
        }
        match from {
            LightSource::Emitter(emitter) => self.put(accumulator, bounces, light, emitter),
            LightSource::Sky(_) if self.groups.is_empty() => {
                self.put(accumulator, bounces, light, 0);
            }
            LightSource::Sky(dir) => {
                // Several emitters may shine from there: each has its share of the light.
                let whole = lights.environment(dir);
                let share = |part: Rgb| {
                    let channel = |c: usize| match whole[c] > 0.0 {
                        true => light[c] * (part[c] / whole[c]),
                        false => 0.0,
                    };
                    Rgb::new(channel(0), channel(1), channel(2))
                };
                for (emitter, part) in lights.environment_by_emitter(dir) {
                    self.put(accumulator, bounces, share(part), emitter);
                }
            }
        }
    }

    fn put(&mut self, accumulator: u32, bounces: u32, light: Rgb, emitter: u32) {
        let begin = accumulator as usize * self.count;
        if self.sums.len() < begin + self.count {
            self.sums.resize(begin + self.count, Rgb::ZERO);
        }
        let group = self.groups.get(emitter as usize);
        let group = group.copied().unwrap_or(usize::MAX);
        for part in self.extras.light.of(group, bounces) {
            self.sums[begin + part] += light;
        }
    }

    /// The parts of an accumulator's radiance.
    pub fn of(&self, accumulator: usize) -> &[Rgb] {
        let begin = accumulator * self.count;
        self.sums.get(begin..begin + self.count).unwrap_or(&[])
    }

    /// Adds every accumulator to the one that it belongs to.
    pub fn reduce(&mut self, split_paths: &SplitPaths) {
        let accumulators = split_paths.accumulators();
        self.sums.resize(accumulators * self.count, Rgb::ZERO);
        for (from, to) in split_paths.passes() {
            self.pass(from, to, Rgb::ONE);
        }
    }

    /// Adds what is in an accumulator to another, with a weight.
    pub fn pass(&mut self, from: usize, to: usize, weight: Rgb) {
        for part in 0..self.count {
            let light = self.sums[from * self.count + part];
            self.sums[to * self.count + part] += weight * light;
        }
    }
}
