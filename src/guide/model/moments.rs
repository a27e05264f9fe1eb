//! What a mixture of Gaussians has met: moments of its lobes, exact while records come in.

use crate::guide::bytes::{Reader, Writer};
use crate::guide::gaussian::{LOBES, Statistics};
use crate::math::Vec2;

/// Quanta a unit of weight: the smallest variance is told from zero by five digits.
const QUANTA: f64 = (1u64 << 40) as f64;
/// Quanta a squared unit of weight: light a million times dimmer than a typical record still
/// counts.
const SQUARE_QUANTA: f64 = (1u64 << 60) as f64;
/// No sum of a file may be larger: what is added later must have room.
const MAX_SUM: u128 = 1 << 120;
/// A lobe that a record belongs to by less than this learns nothing from it.
const LEAST_SHARE: f32 = 1e-6;
/// How much of what is remembered counts beside new records.
const MEMORY: f64 = 0.5;
/// New records fewer than this share of those remembered do not make them fade: what was remembered
/// when lobes were new fades once or twice, then batches of equal size add up. (With 0.5 it would
/// be two batches' worth at most. 60 s, relMSE: veach-ajar 0.0161 instead of 0.0170, a kitchen
/// 0.0268 instead of 0.0272.)
const FEW: f64 = 0.75;

/// The moments of records of one origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Moments {
    remembered: Statistics,
    /// Sum of squared weights.
    remembered_square: f64,
    fresh: [[i128; 6]; LOBES],
    fresh_square: i128,
}

/// What [`Moments`] come to.
pub(super) struct Known {
    pub statistics: Statistics,
    /// Sum of weights.
    pub weight: f64,
    square: f64,
}

/// The same number; most are small, which is ten times as fast.
#[inline]
fn to_f64(q: i128) -> f64 {
    i64::try_from(q).map_or_else(|_| q as f64, |q| q as f64)
}

impl Known {
    fn new(statistics: Statistics, square: f64) -> Self {
        Self {
            weight: statistics.iter().map(|s| s[0]).sum(),
            statistics,
            square,
        }
    }

    /// How many records of equal weight would tell as much.
    pub fn effective_count(&self) -> f64 {
        if self.square > 0.0 && self.weight > 0.0 {
            self.weight * self.weight / self.square
        } else {
            0.0
        }
    }
}

impl Moments {
    /// Adds a record of weight `units` (at most 2^16) at a place in the unit square, which belongs
    /// to the lobes by `shares`.
    #[inline]
    pub fn add(&mut self, place: Vec2, units: f32, shares: &[f32; LOBES]) {
        let (x, y) = (f64::from(place.x), f64::from(place.y));
        let moments = [1.0, x, y, x * x, x * y, y * y];
        let units = f64::from(units);
        for (sums, &share) in self.fresh.iter_mut().zip(shares) {
            if share < LEAST_SHARE {
                continue;
            }
            let g = f64::from(share) * units * QUANTA;
            for (sum, m) in sums.iter_mut().zip(moments) {
                // Below 2^57.
                *sum += i128::from((g * m) as i64);
            }
        }
        // Never nothing: whether there are records is told by it.
        self.fresh_square += ((units * units * SQUARE_QUANTA) as i128).max(1);
    }

    /// What is remembered and what was added since.
    pub fn known(&self) -> Known {
        let mut fresh = Statistics::default();
        for (out, sums) in fresh.iter_mut().flatten().zip(self.fresh.iter().flatten()) {
            *out = to_f64(*sums) / QUANTA;
        }
        let fresh = Known::new(fresh, self.fresh_square as f64 / SQUARE_QUANTA);
        let old = Known::new(self.remembered, self.remembered_square);
        let few = fresh.effective_count() < FEW * old.effective_count();
        let keep = if few { 1.0 } else { MEMORY };
        let mut sum = fresh.statistics;
        for (s, o) in sum
            .iter_mut()
            .flatten()
            .zip(old.statistics.iter().flatten())
        {
            *s += keep * o;
        }
        Known::new(sum, fresh.square + keep * old.square)
    }

    /// Whether nothing was added since it was settled.
    pub fn is_settled(&self) -> bool {
        self.fresh_square == 0
    }

    /// Remembers what was added.
    pub fn settle(&mut self) {
        if self.is_settled() {
            return;
        }
        let known = self.known();
        *self = Self {
            remembered: known.statistics,
            remembered_square: known.square,
            ..Self::default()
        };
    }

    /// Forgets what was added.
    pub fn clear(&mut self) {
        if self.is_settled() {
            return;
        }
        self.fresh = Default::default();
        self.fresh_square = 0;
    }

    /// What a part of `1/parts` of the region remembers.
    pub fn of_part(&self, parts: f64) -> Self {
        let mut part = Self {
            remembered: self.remembered,
            remembered_square: self.remembered_square / parts,
            ..Self::default()
        };
        for s in part.remembered.iter_mut().flatten() {
            *s /= parts;
        }
        part
    }

    /// Adds what was added to others that remember the same; false if they do not.
    pub fn merge(&mut self, other: &Self) -> bool {
        let alike = self.remembered == other.remembered
            && self.remembered_square == other.remembered_square;
        if alike {
            let theirs = other.fresh.iter().flatten();
            for (a, b) in self.fresh.iter_mut().flatten().zip(theirs) {
                *a = a.saturating_add(*b);
            }
            self.fresh_square = self.fresh_square.saturating_add(other.fresh_square);
        }
        alike
    }

    /// Appends them to a file.
    pub fn write(&self, out: &mut Writer) {
        for v in self.remembered.iter().flatten() {
            out.f64(*v);
        }
        out.f64(self.remembered_square);
        for q in self.fresh.iter().flatten().chain([&self.fresh_square]) {
            out.u64(*q as u64);
            out.u64((*q >> 64) as u64);
        }
    }

    /// Reads what `write` wrote.
    pub fn read(input: &mut Reader) -> Option<Self> {
        let mut new = Self::default();
        for v in new.remembered.iter_mut().flatten() {
            *v = input.f64().filter(|v| v.is_finite() && v.abs() < 1e100)?;
        }
        new.remembered_square = input.f64().filter(|v| v.is_finite() && *v >= 0.0)?;
        let mut integer = || {
            let q = i128::from(input.u64()?) | i128::from(input.u64()? as i64) << 64;
            (q.unsigned_abs() <= MAX_SUM).then_some(q)
        };
        for q in new.fresh.iter_mut().flatten() {
            *q = integer()?;
        }
        new.fresh_square = integer()?;
        Some(new)
    }
}
