//! Path splitting.
//!
//! Where a path is worth more than its pixel was expected to come to, it is split: it goes on in
//! several directions, each of which carries its share of the throughput (see [`super::roulette`]).
//! Every branch has an accumulator of its own in the wave, so that its light can be
//! told from that of its siblings: training samples need that. At the end all accumulators are
//! added to those of the paths that they were split off from.

use super::guided_path::GuidedPath;
use super::path::Arrival;
use crate::accel::Ray;
use crate::math::Rgb;

/// The accumulators of a wave beyond its samples, and the branches that wait for the next bounce.
#[derive(Default)]
pub struct SplitPaths {
    samples: u32,
    /// For each further accumulator, which one it belongs to: an earlier one, or itself if it is
    /// detached.
    parents: Vec<u32>,
    waiting: Vec<(GuidedPath, Ray)>,
}

impl SplitPaths {
    /// Forgets all branches. The accumulators of `samples` samples come first.
    pub fn start(&mut self, samples: usize) {
        self.samples = samples as u32;
        self.parents.clear();
        self.waiting.clear();
    }

    /// A new account for a way that splits off a path whose accumulator is `parent`.
    #[inline]
    pub fn open(&mut self, parent: u32) -> u32 {
        self.parents.push(parent);
        self.samples + self.parents.len() as u32 - 1
    }

    /// The sample that an accumulator belongs to in the end, which must not be detached.
    #[inline]
    pub fn sample_of(&self, mut account: u32) -> u32 {
        while account >= self.samples {
            account = self.parents[(account - self.samples) as usize];
        }
        account
    }

    /// An accumulator that [`SplitPaths::reduce`] is not to add to the one that it belongs to.
    #[inline]
    pub fn detach(&mut self, account: u32) {
        self.parents[(account - self.samples) as usize] = account;
    }

    /// How many accumulators there are, the samples' included.
    #[inline]
    pub fn accumulators(&self) -> usize {
        self.samples as usize + self.parents.len()
    }

    /// A way that splits off a path, with an accumulator of its own and numbers of its own.
    #[inline]
    pub fn branch(&mut self, path: &GuidedPath, way: u32) -> GuidedPath {
        let mut branch = *path;
        branch.base.accumulator = self.open(path.base.accumulator);
        branch.base.sampler = path.base.sampler.fork(way);
        branch
    }

    /// Lets a path that arrived so `go` on in one way, or in several, each with its share of the
    /// throughput. Then the path itself takes the first, with an accumulator of its own like the
    /// others.
    pub fn split(
        &mut self,
        factor: u32,
        path: &mut GuidedPath,
        arrival: &Arrival,
        mut go: impl FnMut(&mut GuidedPath, &Arrival) -> Option<Ray>,
    ) -> Option<Ray> {
        if factor == 1 {
            return go(path, arrival);
        }
        path.base.throughput /= factor as f32;
        path.split_factor *= factor;
        let arrival = Arrival {
            throughput: path.base.throughput,
            radiance: Rgb::ZERO,
        };
        for i in 1..factor {
            let mut way = self.branch(path, i);
            if let Some(ray) = go(&mut way, &arrival) {
                self.push(way, ray);
            }
        }
        path.base.accumulator = self.open(path.base.accumulator);
        go(path, &arrival)
    }

    /// Keeps a way for the next bounce.
    #[inline]
    pub fn push(&mut self, path: GuidedPath, ray: Ray) {
        self.waiting.push((path, ray));
    }

    /// The ways that wait, in the order in which they came.
    #[inline]
    pub fn take(&mut self) -> impl Iterator<Item = (GuidedPath, Ray)> + '_ {
        self.waiting.drain(..)
    }

    /// Which accumulator is to be added to which, the last first: an accumulator is complete before
    /// it is passed on.
    pub fn passes(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let numbered = self.parents.iter().enumerate().rev();
        let pass = |(i, &parent): (usize, &u32)| (self.samples as usize + i, parent as usize);
        numbered.map(pass).filter(|(from, to)| from != to)
    }

    /// Adds every accumulator to the one that it belongs to.
    pub fn reduce(&self, radiances: &mut [Rgb]) {
        for (from, to) in self.passes() {
            radiances[to] += radiances[from];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_came_along_ways_of_ways_reaches_the_sample() {
        let mut split_paths = SplitPaths::default();
        split_paths.start(2);
        let (a, b) = (split_paths.open(1), split_paths.open(1));
        let c = split_paths.open(a);
        assert_eq!((a, b, c, split_paths.accumulators()), (2, 3, 4, 5));
        let mut radiances: Vec<Rgb> = (0..5).map(|i| Rgb::splat(10f32.powi(i))).collect();
        split_paths.reduce(&mut radiances);
        let sums = radiances.iter().map(|radiance| radiance.x);
        assert_eq!(
            sums.collect::<Vec<_>>(),
            [1.0, 11110.0, 10100.0, 1000.0, 10000.0]
        );
        split_paths.start(1);
        assert_eq!(split_paths.accumulators(), 1);
    }
}
