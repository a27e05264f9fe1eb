//! Ways that split off paths.
//!
//! Where a path is worth more than its sample was expected to come to, it is split: it goes on in several
//! directions, each of which carries its share of the throughput (see [`super::roulette`]). Every way has an
//! account of its own among a wave's outcomes, so that what came along it can be told from what came along
//! its siblings: that is what lessons are made of. At the end all accounts are paid into those of the paths
//! that they split off from.

use super::record::Arrival;
use super::wave::{Outcome, Path};
use crate::accel::Ray;
use crate::math::Rgb;

/// The accounts of a wave beyond its samples, and the ways that wait for the next bounce.
#[derive(Default)]
pub struct Forks {
    samples: u32,
    /// For each further account, which one it belongs to: an earlier one, or itself if it is detached.
    parents: Vec<u32>,
    waiting: Vec<(Path, Ray)>,
}

impl Forks {
    /// Forgets all ways. The accounts of `samples` samples come first.
    pub fn start(&mut self, samples: usize) {
        self.samples = samples as u32;
        self.parents.clear();
        self.waiting.clear();
    }

    /// A new account for a way that splits off a path whose account is `parent`.
    #[inline]
    pub fn open(&mut self, parent: u32) -> u32 {
        self.parents.push(parent);
        self.samples + self.parents.len() as u32 - 1
    }

    /// The sample that an account belongs to in the end, which must not be detached.
    #[inline]
    pub fn sample_of(&self, mut account: u32) -> u32 {
        while account >= self.samples {
            account = self.parents[(account - self.samples) as usize];
        }
        account
    }

    /// An account that [`Forks::settle`] is not to add to the one that it belongs to.
    #[inline]
    pub fn detach(&mut self, account: u32) {
        self.parents[(account - self.samples) as usize] = account;
    }

    /// How many accounts there are, the samples' included.
    #[inline]
    pub fn accounts(&self) -> usize {
        self.samples as usize + self.parents.len()
    }

    /// A way that splits off a path, with an account of its own and numbers of its own.
    #[inline]
    pub fn branch(&mut self, path: &Path, way: u32) -> Path {
        Path {
            slot: self.open(path.slot),
            sampler: path.sampler.fork(way),
            ..*path
        }
    }

    /// Lets a path `go` on in several ways, each with its share of the throughput. The path itself takes the
    /// first, with an account of its own like the others.
    pub fn split(
        &mut self,
        ways: u32,
        path: &mut Path,
        mut go: impl FnMut(&mut Path, &Arrival) -> Option<Ray>,
    ) -> Option<Ray> {
        path.throughput /= ways as f32;
        path.ways *= ways;
        let arrival = Arrival {
            throughput: path.throughput,
            radiance: Rgb::ZERO,
        };
        for i in 1..ways {
            let mut way = self.branch(path, i);
            if let Some(ray) = go(&mut way, &arrival) {
                self.push(way, ray);
            }
        }
        path.slot = self.open(path.slot);
        go(path, &arrival)
    }

    /// Keeps a way for the next bounce.
    #[inline]
    pub fn push(&mut self, path: Path, ray: Ray) {
        self.waiting.push((path, ray));
    }

    /// The ways that wait, in the order in which they came.
    #[inline]
    pub fn take(&mut self) -> impl Iterator<Item = (Path, Ray)> + '_ {
        self.waiting.drain(..)
    }

    /// Adds every account to the one that it belongs to, the last first: an account is complete before it is
    /// passed on.
    pub fn settle(&self, outcomes: &mut [Outcome]) {
        for (i, &parent) in self.parents.iter().enumerate().rev() {
            let account = self.samples as usize + i;
            if parent as usize != account {
                let radiance = outcomes[account].radiance;
                outcomes[parent as usize].radiance += radiance;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_came_along_ways_of_ways_reaches_the_sample() {
        let mut forks = Forks::default();
        forks.start(2);
        let (a, b) = (forks.open(1), forks.open(1));
        let c = forks.open(a);
        assert_eq!((a, b, c, forks.accounts()), (2, 3, 4, 5));
        let mut outcomes: Vec<Outcome> = (0..5)
            .map(|i| Outcome {
                radiance: Rgb::splat(10f32.powi(i)),
                ..Outcome::default()
            })
            .collect();
        forks.settle(&mut outcomes);
        let sums = outcomes.iter().map(|o| o.radiance.x);
        assert_eq!(
            sums.collect::<Vec<_>>(),
            [1.0, 11110.0, 10100.0, 1000.0, 10000.0]
        );
        forks.start(1);
        assert_eq!(forks.accounts(), 1);
    }
}
