//! Choosing one of many by weight, with the exact probability of each choice.
//!
//! Cumulative weights are fixed-point numbers of 32 bits, not floats: their resolution is the same
//! everywhere (a float close to 1 keeps no more than 24 bits, which a sky beside a sun needs), and
//! the probability that is reported is the difference of two of them, so it is the one that is
//! drawn with. Everything of positive weight keeps a positive probability. A guide table of one
//! entry for every few choices makes the search short.
//!
//! Inversion keeps stratified random numbers stratified; an alias table would not.

use super::rng::{BELOW_ONE, hash64};

/// The whole of the cumulative weights: one less than 2^32, so that an end that must never be
/// reached fits 32 bits.
const WHOLE: u64 = u32::MAX as u64;
/// One part of the whole.
const UNIT: f32 = 1.0 / WHOLE as f32;
/// Choices for each entry of a guide table.
const PER_GUIDE: usize = 4;

/// A number in `[0, 1)` with 64 bits, in units of 2^-64, from one with 24 and a hash: choosing
/// among millions, and using what is left of the number for a place inside the choice, needs more
/// bits than an `f32` brings.
#[inline]
pub fn widen(u: f32, salt: u64) -> u64 {
    let upper = u64::from(((u.clamp(0.0, 1.0) * 16_777_216.0) as u32).min(0x00ff_ffff)) << 40;
    upper | (hash64(salt ^ upper) >> 24)
}

/// What a draw chose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Which.
    pub index: usize,
    /// With what probability.
    pub probability: f32,
    /// What is left of the random number, uniform in `[0, 1)`.
    pub rest: f32,
}

/// Fills `starts` with the cumulative weights before each entry. `false` if nothing has weight.
fn accumulate(weights: impl Iterator<Item = f64> + Clone, starts: &mut [u32]) -> bool {
    let total: f64 = weights.clone().sum();
    if total.is_nan() || total <= 0.0 || total.is_infinite() {
        return false;
    }
    let scale = WHOLE as f64 / total;
    let (mut sum, mut floor) = (0.0, 0u64);
    for (start, weight) in starts.iter_mut().zip(weights.clone()) {
        let at = ((sum * scale).round() as u64).max(floor).min(WHOLE);
        *start = at as u32;
        sum += weight;
        floor = at + u64::from(weight > 0.0);
    }
    // Rare weights pushed others past the end: push back, so that each keeps at least one unit.
    let positive: Vec<bool> = weights.map(|w| w > 0.0).collect();
    let mut ceiling = WHOLE;
    for (start, positive) in starts.iter_mut().zip(positive).rev() {
        let most = ceiling.saturating_sub(u64::from(positive));
        if u64::from(*start) <= most {
            break;
        }
        *start = most as u32;
        ceiling = most;
    }
    true
}

/// Entries of the guide table of `n` choices.
fn guide_len(n: usize) -> usize {
    n.div_ceil(PER_GUIDE).next_power_of_two()
}

/// Fills a guide table: for each equal part of the whole, the choice its beginning falls into.
fn fill_guide(starts: &[u32], guide: &mut [u32]) {
    let shift = 32 - guide.len().trailing_zeros();
    let mut index = 0;
    for (part, entry) in guide.iter_mut().enumerate() {
        let begin = (part as u64) << shift;
        while index + 1 < starts.len() && u64::from(starts[index + 1]) <= begin {
            index += 1;
        }
        *entry = index as u32;
    }
}

/// Finds the choice `u` falls into. Returns it with its probability and the rest of `u`.
#[inline]
fn choose(starts: &[u32], guide: &[u32], u: u64) -> Choice {
    let place = ((u128::from(u) * u128::from(WHOLE)) >> 32) as u64;
    let at = (place >> 32) as u32;
    let part = (u64::from(at) >> (32 - guide.len().trailing_zeros())) as usize;
    let first = guide[part] as usize;
    let last = guide
        .get(part + 1)
        .map_or(starts.len() - 1, |&i| i as usize);
    // The last entry that starts at or before the place: entries of weight 0 are passed over,
    // because the next one starts where they do.
    let index = first + starts[first + 1..=last].partition_point(|&s| s <= at);
    let start = u64::from(starts[index]);
    let units = (end(starts, index) - start) as f32;
    // Not a bit is lost that an f32 has; signed numbers are converted sooner.
    let rest = ((place - (start << 32)) >> 8) as i64 as f32 * (1.0 / 16_777_216.0) / units;
    Choice {
        index,
        probability: units * UNIT,
        rest: rest.min(BELOW_ONE),
    }
}

#[inline]
fn end(starts: &[u32], index: usize) -> u64 {
    starts.get(index + 1).map_or(WHOLE, |&s| u64::from(s))
}

/// A choice of one of many.
#[derive(Clone, Debug)]
pub struct Discrete {
    starts: Vec<u32>,
    guide: Vec<u32>,
}

impl Discrete {
    /// Weights that are finite and not negative. `None` if all are 0.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let mut starts = vec![0; weights.len()];
        if !accumulate(weights.iter().copied(), &mut starts) {
            return None;
        }
        let mut guide = vec![0; guide_len(weights.len())];
        fill_guide(&starts, &mut guide);
        Some(Self { starts, guide })
    }

    /// The choice that `u` (all 64-bit numbers equally likely) makes.
    #[inline]
    pub fn sample(&self, u: u64) -> Choice {
        choose(&self.starts, &self.guide, u)
    }

    /// Probability of a choice.
    #[inline]
    pub fn probability(&self, index: usize) -> f32 {
        (end(&self.starts, index) - u64::from(self.starts[index])) as f32 * UNIT
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        (self.starts.len() + self.guide.len()) * 4
    }
}

/// A number in `[0, 1)` with density `2 lerp(a, b, x) / (a + b)`, for `a`, `b` not negative and not
/// both 0.
#[inline]
pub fn sample_linear(a: f32, b: f32, u: f32) -> f32 {
    // Relative to their sum, so that the squares of tiny weights do not vanish.
    let a = a / (a + b);
    let b = 1.0 - a;
    let root = (a * a + u * (b * b - a * a)).max(0.0).sqrt();
    (u / (a + root).max(f32::MIN_POSITIVE)).min(BELOW_ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    fn wide(rng: &mut Pcg32) -> u64 {
        u64::from(rng.next_u32()) << 32 | u64::from(rng.next_u32())
    }

    #[test]
    fn choices_come_as_often_as_their_probability_says() {
        let weights = [0.0, 3.0, 0.0, 0.0, 1.0, 1e-12, 6.0, 0.0];
        let d = Discrete::new(&weights).unwrap();
        let total: f32 = (0..8).map(|i| d.probability(i)).sum();
        assert!((total - 1.0).abs() < 1e-6);
        let mut rng = Pcg32::new(3, 1);
        let (n, mut counts, mut rest) = (1_000_000, [0u32; 8], 0.0f64);
        for _ in 0..n {
            let c = d.sample(wide(&mut rng));
            assert_eq!(c.probability, d.probability(c.index));
            counts[c.index] += 1;
            rest += f64::from(c.rest);
        }
        assert!((rest / f64::from(n) - 0.5).abs() < 0.002);
        for (i, &w) in weights.iter().enumerate() {
            assert_eq!(w > 0.0, d.probability(i) > 0.0, "entry {i}");
            let expected = w / 10.0 * f64::from(n);
            assert!((f64::from(counts[i]) - expected).abs() <= 5.0 * expected.sqrt().max(0.2));
        }
    }

    #[test]
    fn every_unit_of_a_random_number_finds_an_entry_of_positive_weight() {
        let mut rng = Pcg32::new(5, 1);
        for n in [1usize, 2, 3, 7, 64, 1000] {
            let weights: Vec<f64> = (0..n)
                .map(|i| match rng.next_u32() % 3 {
                    0 if i != n / 2 => 0.0,
                    1 => 1e-9,
                    _ => f64::from(rng.next_f32()) + 0.1,
                })
                .collect();
            let d = Discrete::new(&weights).unwrap();
            for u in (0..4000).map(|_| wide(&mut rng)).chain([0, u64::MAX]) {
                let c = d.sample(u);
                assert!(weights[c.index] > 0.0 && c.probability > 0.0);
                assert!((0.0..1.0).contains(&c.rest));
            }
        }
        assert!(Discrete::new(&[0.0, 0.0]).is_none() && Discrete::new(&[]).is_none());
    }

    #[test]
    fn linear_samples_have_the_mean_of_their_density() {
        for (a, b) in [
            (1.0, 1.0),
            (0.0, 2.0),
            (5.0, 0.0),
            (1e-30, 3e-30),
            (1.0, 9.0),
        ] {
            let n = 10_000;
            let mean: f64 = (0..n)
                .map(|i| f64::from(sample_linear(a, b, (i as f32 + 0.5) / n as f32)))
                .sum::<f64>()
                / f64::from(n);
            let expected = f64::from((a + 2.0 * b) / (3.0 * (a + b)));
            assert!((mean - expected).abs() < 1e-4, "{a} {b}: {mean} {expected}");
        }
    }
}
