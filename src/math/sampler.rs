//! The numbers that drive one path: independent, or Owen-scrambled Sobol points.
//!
//! A path draws its numbers in blocks of four. Block 0 is the camera's (place on the film, place on
//! the lens); each vertex then takes two. Which number means what never depends on what happened
//! before at other vertices of the same path, so Sobol dimensions keep their meaning from sample to
//! sample.

use super::rng::{Pcg32, hash_all};
use super::sobol;

/// Sobol blocks that there are; later vertices fall back to independent numbers.
const SOBOL_BLOCKS: u32 = sobol::BLOCKS;
/// Sobol points before they repeat; a new scramble starts then.
const SOBOL_POINTS: u64 = 1 << 16;

/// The stream of numbers of one sample of one pixel.
///
/// The same `(seed, pixel, sample)` gives the same numbers on any thread, in any order.
#[derive(Clone, Copy, Debug)]
pub struct PathSampler {
    rng: Pcg32,
    index: u32,
    /// The same shuffled, for [`sobol::block`].
    shuffled: u32,
    scramble: u32,
    /// Next Sobol block; `u32::MAX` draws independent numbers.
    block: u32,
}

impl PathSampler {
    /// Independent numbers.
    #[inline]
    pub fn independent(seed: u64, pixel: u64, sample: u64) -> Self {
        let stream = hash_all([seed, pixel]);
        Self {
            rng: Pcg32::new(hash_all([stream, sample]), stream),
            index: 0,
            shuffled: 0,
            scramble: 0,
            block: u32::MAX,
        }
    }

    /// Owen-scrambled Sobol points (Burley 2020), scrambled differently in every pixel and
    /// sequence.
    ///
    /// `begin` is the first sample of the sequence, at most `sample`. Points of one sequence avoid
    /// each other, so they are not independent. Where the values of some samples decide how many
    /// others are taken, or how, the others must be of another sequence: otherwise the mean is
    /// biased.
    #[inline]
    pub fn sobol(seed: u64, pixel: u64, begin: u64, sample: u64) -> Self {
        let index = sample - begin;
        let scramble = hash_all([seed, pixel, begin, index / SOBOL_POINTS]);
        let index = (index % SOBOL_POINTS) as u32;
        Self {
            rng: Pcg32::new(hash_all([scramble, sample]), pixel),
            index,
            shuffled: sobol::shuffle(index, scramble as u32),
            scramble: scramble as u32,
            block: 0,
        }
    }

    /// The numbers of a way that splits off here, one of several told apart by `number`:
    /// independent ones.
    #[inline]
    pub fn fork(&self, number: u32) -> Self {
        let mut rng = self.rng;
        let here = u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32());
        let stream = hash_all([here, u64::from(self.index), u64::from(self.block)]);
        Self {
            rng: Pcg32::new(hash_all([stream, u64::from(number)]), stream),
            block: u32::MAX,
            ..*self
        }
    }

    /// The next four numbers, each in `[0, 1)`.
    // Inlined: plain path tracing of a Cornell box takes 1.04 times as long when it is called.
    #[inline(always)]
    pub fn next4(&mut self) -> [f32; 4] {
        if self.block < SOBOL_BLOCKS {
            let block = self.block;
            self.block += 1;
            return sobol::block(self.shuffled, block, self.scramble);
        }
        std::array::from_fn(|_| self.rng.next_f32())
    }
}

/// The numbers of a path one by one, where nobody knows how many it will take.
#[derive(Clone, Copy, Debug)]
pub struct NumberStream {
    sampler: PathSampler,
    block: [f32; 4],
    taken: usize,
}

impl NumberStream {
    /// Four numbers, and then those of a sampler.
    #[inline]
    pub fn new(block: [f32; 4], sampler: PathSampler) -> Self {
        Self {
            sampler,
            block,
            taken: 0,
        }
    }

    /// The next, in `[0, 1)`.
    #[inline]
    pub fn draw(&mut self) -> f32 {
        if self.taken == self.block.len() {
            self.refill();
        }
        self.taken += 1;
        self.block[self.taken - 1]
    }

    #[inline(never)]
    fn refill(&mut self) {
        self.block = self.sampler.next4();
        self.taken = 0;
    }
}

impl From<PathSampler> for NumberStream {
    fn from(mut sampler: PathSampler) -> Self {
        Self::new(sampler.next4(), sampler)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn streams_of_neighbouring_pixels_and_samples_are_uncorrelated() {
        // 2^16 pairs: the correlation of independent numbers has a standard error of 2^-8.
        let first = |s: &mut PathSampler| s.next4()[0] - 0.5;
        for shift in [(0, 1), (1, 0), (1, 1)] {
            let mut sum = 0.0;
            for pixel in 0..256u64 {
                for sample in 0..256u64 {
                    let a = first(&mut PathSampler::independent(7, pixel, sample));
                    let b = first(&mut PathSampler::independent(
                        7,
                        pixel + shift.0,
                        sample + shift.1,
                    ));
                    sum += f64::from(a * b) * 12.0;
                }
            }
            assert!((sum / 65536.0).abs() < 4.0 / 256.0, "{shift:?} {sum}");
        }
    }

    #[test]
    fn forks_have_numbers_of_their_own_at_every_vertex() {
        for mut s in [
            PathSampler::independent(1, 2, 3),
            PathSampler::sobol(1, 2, 0, 3),
        ] {
            let mut drawn = Vec::new();
            for _ in 0..3 {
                for number in 1..4 {
                    drawn.extend(s.fork(number).next4());
                }
                drawn.extend(s.next4());
            }
            drawn.sort_unstable_by(f32::total_cmp);
            drawn.dedup();
            assert_eq!(drawn.len(), 48);
        }
    }

    /// The second halves of sequences of 16, given that the first half has put a point into the
    /// lowest sixteenth: never one there in the same sequence, as often as anywhere in another.
    #[test]
    fn points_of_another_sequence_do_not_avoid_those_of_the_first() {
        let in_lowest = |pixel, begin, sample| {
            PathSampler::sobol(1, pixel, begin, sample).next4()[0] < 1.0 / 16.0
        };
        let (mut given, mut same, mut other) = (0, 0, 0);
        for pixel in 0..4096 {
            if (0..8).any(|i| in_lowest(pixel, 0, i)) {
                given += 1;
                same += (8..16).filter(|&i| in_lowest(pixel, 0, i)).count();
                other += (8..16).filter(|&i| in_lowest(pixel, 8, i)).count();
            }
        }
        assert_eq!(same, 0);
        // Half of the sequences have their one point of sixteen among the first eight; of the
        // others' eight points each is there with a chance of 1/16.
        let expected = given as f64 / 2.0;
        assert!((given as f64 - 2048.0).abs() < 4.0 * 32.0, "{given}");
        assert!(
            (other as f64 - expected).abs() < 4.0 * expected.sqrt(),
            "{other}"
        );
    }

    #[test]
    fn sobol_blocks_are_stratified_and_end_in_independent_numbers() {
        let mut counts = [0u32; 64];
        for sample in 0..64 {
            let x = PathSampler::sobol(1, 2, 0, sample).next4();
            counts[(x[0] * 8.0) as usize * 8 + (x[1] * 8.0) as usize] += 1;
        }
        assert!(
            counts.iter().all(|&c| c == 1),
            "a (0,2)-net puts one point in each cell"
        );
        let mut s = PathSampler::sobol(1, 2, 0, 3);
        for _ in 0..1000 {
            assert!(s.next4().iter().all(|x| (0.0..1.0).contains(x)));
        }
    }
}
