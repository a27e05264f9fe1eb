//! What a leaf link accumulates: exact fluxes, and a small table of how its flux is spread over the
//! cells a split would make.

use super::record::{Deposit, Origin};
use crate::math::sum::SumUnit;
use crate::math::{DVec3, Rgb};

/// An RGB sum in quanta (see [`SumUnit`]): adding is exact, so order and threads do not matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Flux(pub [u128; 3]);

impl Flux {
    pub fn add(&mut self, unit: SumUnit, value: Rgb) {
        for (sum, v) in self.0.iter_mut().zip(value.to_array()) {
            *sum = sum.saturating_add(unit.quanta(v));
        }
    }

    pub fn merge(&mut self, other: &Self) {
        for (sum, v) in self.0.iter_mut().zip(other.0) {
            *sum = sum.saturating_add(v);
        }
    }

    pub fn rgb(&self, unit: SumUnit) -> DVec3 {
        DVec3::from_array(self.0.map(|q| unit.to_f64(q)))
    }
}

/// The sums of one leaf link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Tally {
    /// Photons' target quantity.
    pub photons: Flux,
    /// Path samples' target quantity.
    pub paths: Flux,
    /// Records by [`Origin`], including the share inherited when the link was made.
    pub count: [u64; 2],
    /// Sum of squares of the table's entries as they came, by origin, for the effective count.
    pub squares: [u64; 2],
}

/// What a leaf's table adds up to.
pub(crate) struct Table<'a> {
    /// Eight rows (space octants) of `len/8` direction cells.
    pub entries: &'a [u32],
}

impl Table<'_> {
    pub fn total(&self) -> f64 {
        self.entries.iter().map(|&e| f64::from(e)).sum()
    }

    pub fn directions(&self) -> usize {
        self.entries.len() / 8
    }

    /// Flux share by octant, in table quanta.
    pub fn octants(&self) -> [f64; 8] {
        let d = self.directions();
        std::array::from_fn(|o| {
            self.entries[o * d..(o + 1) * d]
                .iter()
                .map(|&e| f64::from(e))
                .sum()
        })
    }

    /// By fine direction cell, in the order of codes.
    pub fn by_direction(&self) -> Vec<f64> {
        let d = self.directions();
        (0..d)
            .map(|q| (0..8).map(|o| f64::from(self.entries[o * d + q])).sum())
            .collect()
    }

    /// By direction quadrant.
    pub fn quadrants(&self) -> [f64; 4] {
        let fine = self.by_direction();
        let each = fine.len() / 4;
        std::array::from_fn(|q| fine[q * each..(q + 1) * each].iter().sum())
    }
}

/// Adds a record to a leaf's table.
#[inline]
pub(crate) fn add_to_table(
    tally: &mut Tally,
    table: &mut [u32],
    cell: usize,
    origin: Origin,
    d: &Deposit,
) {
    let w = u64::from(d.table);
    let squares = &mut tally.squares[origin as usize];
    *squares = squares.saturating_add(w * w);
    if let Some(entry) = table.get_mut(cell) {
        *entry = entry.saturating_add(d.table);
    }
}

/// Divides an integer by weights so that the parts add up to it exactly; equal parts if all weights
/// are zero.
pub(crate) fn apportion<const N: usize>(total: u128, weights: &[f64; N]) -> [u128; N] {
    let sum: f64 = weights.iter().sum();
    let equal = [1.0; N];
    let weights = if sum > 0.0 && sum.is_finite() {
        weights
    } else {
        &equal
    };
    let mut left = total;
    let mut weight_left: f64 = weights.iter().sum();
    let mut last = 0;
    let mut parts = [0u128; N];
    for (i, &w) in weights.iter().enumerate() {
        if w <= 0.0 {
            continue;
        }
        let part = ((left as f64 * (w / weight_left).min(1.0)) as u128).min(left);
        parts[i] = part;
        left -= part;
        weight_left -= w;
        last = i;
    }
    parts[last] += left;
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_add_up_to_the_whole() {
        for total in [0u128, 1, 7, 1 << 90, u128::MAX >> 4] {
            for w in [[0.0; 4], [1.0, 0.0, 3.0, 0.5], [0.0, 0.0, 0.0, 2.0]] {
                let parts = apportion(total, &w);
                assert_eq!(parts.iter().sum::<u128>(), total);
                if w[0] == 1.0 {
                    assert_eq!(parts[1], 0);
                    let want = total as f64 * 3.0 / 4.5;
                    assert!((parts[2] as f64 - want).abs() <= want * 1e-12 + 1.0);
                }
            }
        }
    }
}
