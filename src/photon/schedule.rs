//! How many photons, and in which batches.
//!
//! Batches double: early ones are cheap and shape the trees coarsely, later ones fill them. How
//! many are worth their while depends on the scene and on the render that they serve. In a scene
//! whose light comes in through a window one photon in twenty lands at all, and eight million of
//! them take a second; in a closed room each lands five times, and a million do. A preview of a
//! second needs a coarse field, a render of an hour a fine one. So, unless a number is given,
//! batches go on until
//!
//! * the next one would cost more than its share of the render's work, or of the time that is
//!   allowed;
//! * or the last one has taught next to nothing: what refining gained by it is small beside what
//!   remains, and there were enough photons and landings to tell.
//!
//! Counted in photons and landings, the decision is the same on every machine and for any number of
//! threads; only a limit of time makes it differ, as it makes the render itself.

use std::ops::Range;
use std::time::Duration;

/// Photons of the first batch, where the number is not given.
const FIRST: u64 = 1 << 12;
/// A batch that lowers the divergence by less than this, in nats, ends learning from photons. (In
/// veach-ajar the batch that makes a million gains 0.027, in the Cornell box 0.04, in a kitchen lit
/// by a window the one that makes four million 0.21.)
const LITTLE: f64 = 0.02;
/// Fewer photons cannot tell that nothing is left to learn: of a caustic's they may have met none.
/// (A glass ball and a ring under a small lamp: 43 cells after the first batch.)
const TELLING: u64 = 63 * FIRST;
/// Nor can fewer landings: where one photon in a hundred lands, a batch fills no cell so far that
/// dividing it would gain anything. (A pool under a small sun, two of four seeds: 0.5 million
/// photons and 5000 landings instead of 2 million and 21 000; relMSE of 64 samples 0.24 and 0.21
/// instead of 0.09.)
const TELLING_LANDINGS: u64 = 1 << 15;
/// Photons after which all trees are large enough.
const MAX_PHOTONS: u64 = 1 << 25;

/// Photons that are traced together before any has landed.
const FIRST_PART: u64 = 1 << 18;
/// No part of a batch is smaller, however often photons land.
const LEAST_PART: u64 = 1 << 13;

/// What photons may cost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Budget {
    /// So many, in so many batches.
    Exactly {
        /// Photons in all; 0 for none.
        photons: u64,
        /// Batches, from 1 to 32.
        batches: u32,
    },
    /// As many as are worth their while in a render.
    AsNeeded {
        /// Samples of the whole image, at most.
        samples: u64,
        /// Time that the render may take.
        time: Option<Duration>,
    },
}

impl Budget {
    /// Whether there will be any photons.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::Exactly { photons: 0, .. })
    }
}

/// What a batch came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Experience {
    /// Landings that taught.
    pub landings: u64,
    /// Fall of the divergence by refining, nats.
    pub gain: f64,
    /// What it cost, in samples of the image.
    pub work: f64,
    /// Time since learning began.
    pub elapsed: Duration,
}

/// Batches, one after the other.
#[derive(Clone, Debug)]
pub struct Schedule {
    budget: Budget,
    next: u64,
    size: u64,
    landings: u64,
    /// What batches have cost, in samples of the image, and the share of the render's that they
    /// may.
    work: f64,
    share: f64,
    /// Nothing is left to learn.
    learned: bool,
    /// How long learning takes.
    elapsed: Duration,
    /// Ranges that are left, last first.
    fixed: Vec<Range<u64>>,
}

impl Schedule {
    /// The batches of a budget.
    pub fn new(budget: Budget) -> Self {
        let fixed = match budget {
            Budget::Exactly { photons, batches } => {
                let mut ranges = doubling(photons, batches);
                ranges.reverse();
                ranges
            }
            Budget::AsNeeded { .. } => Vec::new(),
        };
        Self {
            budget,
            next: 0,
            size: FIRST,
            landings: 0,
            work: 0.0,
            share: 1.0,
            learned: false,
            elapsed: Duration::ZERO,
            fixed,
        }
    }

    /// Numbers of the photons of the next batch, if there is to be one.
    pub fn next_batch(&mut self) -> Option<Range<u64>> {
        if matches!(self.budget, Budget::Exactly { .. }) {
            return self.fixed.pop();
        }
        if self.next > 0 && self.has_ended() {
            return None;
        }
        let batch = self.next..self.next + self.size;
        self.next = batch.end;
        self.size *= 2;
        Some(batch)
    }

    /// Photons in all, as things look: with batches that cost what those so far did, and teach
    /// something. `None` where none has told yet.
    pub fn expected(&self) -> Option<u64> {
        if let Budget::Exactly { photons, .. } = self.budget {
            return Some(photons);
        }
        let mut to_come = self.clone();
        while self.work > 0.0 && !to_come.has_ended() {
            to_come.next += to_come.size;
            to_come.size *= 2;
            to_come.work *= 2.0;
            to_come.elapsed *= 2;
        }
        (self.work > 0.0).then_some(to_come.next)
    }

    /// Lets batches take this share of the render, its work and its time, in all.
    pub fn open(&mut self, share: f64) {
        self.share = share;
    }

    /// Takes note of what the last batch came to.
    pub fn learned(&mut self, experience: Experience) {
        self.landings += experience.landings;
        self.work += experience.work;
        self.elapsed = experience.elapsed;
        let telling = self.next >= TELLING && self.landings >= TELLING_LANDINGS;
        self.learned = telling && experience.gain < LITTLE;
    }

    /// Whether another batch is not worth it.
    fn has_ended(&self) -> bool {
        let Budget::AsNeeded { samples, time } = self.budget else {
            return self.fixed.is_empty();
        };
        // The next batch is as large as all before it: it doubles what was spent.
        let too_much = 2.0 * self.work > self.share * samples as f64;
        let too_long =
            time.is_some_and(|t| 2.0 * self.elapsed.as_secs_f64() > self.share * t.as_secs_f64());
        too_much || too_long || self.learned || 2 * self.next > MAX_PHOTONS
    }
}

/// Takes from the photons of a batch as many as will land about `wanted` times, if they land as
/// often as all photons before them did, which landed `landings` times: a large batch is traced and
/// learned from in parts, so that few more landings than that are held.
pub fn part(batch: &mut Range<u64>, landings: u64, wanted: u64) -> Range<u64> {
    let traced = batch.start;
    let size = match landings {
        0 => FIRST_PART.max(traced),
        n => (u128::from(wanted) * u128::from(traced) / u128::from(n)) as u64,
    };
    let end = batch.start.saturating_add(size.max(LEAST_PART));
    let part = batch.start..end.min(batch.end);
    batch.start = part.end;
    part
}

/// Cuts `records` into `count` ranges, each twice as long as the one before; empty ones are left
/// out.
pub fn doubling(records: u64, count: u32) -> Vec<Range<u64>> {
    let count = count.clamp(1, 32);
    let shares = (1u64 << count) - 1;
    let end =
        |i: u32| (u128::from(records) * u128::from((1u64 << i) - 1) / u128::from(shares)) as u64;
    let ranges = (0..count).map(|i| end(i)..end(i + 1));
    ranges.filter(|r| !r.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_batch_are_the_batch_and_land_as_often_as_wanted() {
        let (mut batch, mut landings, mut parts) = (0..10_000_000, 0, Vec::new());
        while !batch.is_empty() {
            let part = part(&mut batch, landings, 1_000_000);
            landings += 5 * (part.end - part.start);
            parts.push(part);
        }
        assert_eq!(
            (parts[0].start, parts[parts.len() - 1].end),
            (0, 10_000_000)
        );
        assert!(parts.windows(2).all(|w| w[0].end == w[1].start));
        let sizes = parts[1..parts.len() - 1].iter().map(|p| p.end - p.start);
        assert!(sizes.clone().all(|s| s == 200_000) && sizes.count() > 40);
        // Where nothing lands, parts double; where landings never end, they go on.
        let mut dark = 1 << 20..u64::MAX;
        assert_eq!(part(&mut dark, 0, 1000), 1 << 20..1 << 21);
        assert_eq!(part(&mut (8..u64::MAX), u64::MAX, 1), 8..8 + LEAST_PART);
    }

    fn photons(budget: Budget, each: impl Fn(Range<u64>) -> Experience) -> u64 {
        let mut schedule = Schedule::new(budget);
        let mut end = 0;
        while let Some(batch) = schedule.next_batch() {
            assert_eq!(batch.start, end);
            end = batch.end;
            schedule.learned(each(batch));
        }
        end
    }

    fn lands(times: u64, gain: f64) -> impl Fn(Range<u64>) -> Experience {
        move |photons| Experience {
            landings: (photons.end - photons.start) * times,
            gain,
            work: ((photons.end - photons.start) * (1 + times)) as f64,
            elapsed: Duration::from_micros(photons.end * times),
        }
    }

    #[test]
    fn a_number_that_is_given_is_kept() {
        for (n, batches) in [(1000, 3), (7, 8), (0, 4), (1 << 20, 1)] {
            let budget = Budget::Exactly {
                photons: n,
                batches,
            };
            assert_eq!(photons(budget, lands(9, 0.0)), n);
            assert_eq!(budget.is_none(), n == 0);
        }
    }

    #[test]
    fn photons_are_as_many_as_the_image_is_worth() {
        let of = |samples, times, gain| {
            let time = None;
            photons(Budget::AsNeeded { samples, time }, lands(times, gain))
        };
        // A preview gets one batch; a large image more; less where each photon lands often.
        assert_eq!(of(1000, 5, 1.0), FIRST);
        assert_eq!(of(6 << 20, 5, 1.0), 255 * FIRST);
        assert_eq!(of(6 << 20, 0, 1.0), 1023 * FIRST);
        // Nothing left to learn, or no end of learning.
        assert_eq!(of(u64::MAX, 1, 0.001), TELLING);
        assert_eq!(of(u64::MAX, 0, 1.0), MAX_PHOTONS - FIRST);
        // Few landings do not tell that nothing is left.
        let budget = Budget::AsNeeded {
            samples: u64::MAX,
            time: None,
        };
        let seldom = photons(budget, |batch| Experience {
            landings: (batch.end - batch.start) / 64,
            ..lands(0, 0.001)(batch)
        });
        assert_eq!(seldom, 1023 * FIRST);
    }

    #[test]
    fn a_second_helping_goes_on_where_the_first_has_ended() {
        let samples = 1 << 24;
        let time = None;
        let mut schedule = Schedule::new(Budget::AsNeeded { samples, time });
        let mut ends = Vec::new();
        for share in [0.02, 0.02, 0.12] {
            schedule.open(share);
            while let Some(batch) = schedule.next_batch() {
                schedule.learned(lands(1, 1.0)(batch));
            }
            ends.push(schedule.next as f64 * 2.0 / samples as f64);
        }
        assert!(ends[0] <= 0.02 && 2.0 * ends[0] > 0.02, "{ends:?}");
        assert_eq!(ends[1], ends[0]);
        assert!(ends[2] <= 0.12 && 2.0 * ends[2] > 0.12, "{ends:?}");
    }

    /// From the first batch on, the number is foretold: to a batch, for each is as large as all
    /// before it.
    #[test]
    fn the_number_of_photons_is_foretold() {
        for samples in [1000, 1 << 20, 1 << 24, u64::MAX] {
            let budget = Budget::AsNeeded {
                samples,
                time: None,
            };
            let mut schedule = Schedule::new(budget);
            assert_eq!(schedule.expected(), None);
            let mut foretold = Vec::new();
            while let Some(batch) = schedule.next_batch() {
                schedule.learned(lands(2, 1.0)(batch));
                foretold.extend(schedule.expected());
            }
            let made = schedule.next as f64;
            let right = |n: &u64| (0.49..2.1).contains(&(*n as f64 / made));
            assert!(foretold.iter().all(right), "{made}: {foretold:?}");
            assert_eq!(schedule.expected(), Some(schedule.next));
        }
        let exactly = Schedule::new(Budget::Exactly {
            photons: 5000,
            batches: 4,
        });
        assert_eq!(exactly.expected(), Some(5000));
    }

    #[test]
    fn photons_take_a_share_of_the_time() {
        let time = Some(Duration::from_secs(2));
        let samples = u64::MAX;
        // A microsecond a photon, two seconds in all, and no batch is begun that would pass them.
        let n = photons(Budget::AsNeeded { samples, time }, lands(1, 1.0));
        assert!((1_000_000..=2_000_000).contains(&n), "{n}");
    }
}
