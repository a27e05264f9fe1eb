//! Which records a field has learned from.
//!
//! Photon `i` of a seed is the same photon wherever it is traced, and so is camera path `i`. A
//! field is therefore a sum over two sets of numbers, and two fields over one structure may be
//! added if their sets are disjoint. The ledger knows the sets: it refuses what would count twice,
//! and names what is missing.

use serde::{Deserialize, Serialize};
use std::ops::Range;

/// Numbers of records: those that a field has learned from, and those that it is meant to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Numbers {
    /// Learned from: sorted, disjoint, not touching, none empty.
    taken: Vec<Range<u64>>,
    /// The smallest range around everything that belongs together, other shards' part included.
    planned: Range<u64>,
}

impl Numbers {
    /// The numbers `taken` out of `planned`, which is widened if need be.
    pub fn new(taken: Range<u64>, planned: Range<u64>) -> Self {
        let mut numbers = Self {
            taken: Vec::new(),
            planned,
        };
        if !taken.is_empty() {
            numbers.planned = hull(&numbers.planned, &taken);
            numbers.taken.push(taken);
        }
        numbers
    }

    /// How many records were taken.
    pub fn count(&self) -> u64 {
        self.taken.iter().map(|r| r.end - r.start).sum()
    }

    /// The ranges taken, in order.
    pub fn taken(&self) -> &[Range<u64>] {
        &self.taken
    }

    /// The first number that nobody has planned for: where further records begin.
    pub fn next(&self) -> u64 {
        self.planned.end
    }

    /// What is planned but was not taken, in order.
    pub fn missing(&self) -> Vec<Range<u64>> {
        let mut gaps = Vec::new();
        let mut at = self.planned.start;
        for r in &self.taken {
            if r.start > at {
                gaps.push(at..r.start);
            }
            at = at.max(r.end);
        }
        if at < self.planned.end {
            gaps.push(at..self.planned.end);
        }
        gaps
    }

    /// The first range that both have taken.
    pub fn overlap(&self, other: &Self) -> Option<Range<u64>> {
        let mut common = self.taken.iter().flat_map(|a| {
            let cut = |b: &Range<u64>| a.start.max(b.start)..a.end.min(b.end);
            other.taken.iter().map(cut).filter(|r| !r.is_empty())
        });
        common.next()
    }

    /// Adds what another has taken and planned.
    pub fn join(&mut self, other: &Self) {
        self.planned = hull(&self.planned, &other.planned);
        let mut all = std::mem::take(&mut self.taken);
        all.extend(other.taken.iter().cloned());
        all.sort_unstable_by_key(|r| r.start);
        for r in all {
            match self.taken.last_mut() {
                Some(last) if last.end >= r.start => last.end = last.end.max(r.end),
                _ => self.taken.push(r),
            }
        }
    }

    /// Whether the invariants hold: of numbers from a file they may not.
    fn is_sound(&self) -> bool {
        let within = |r: &Range<u64>| {
            !r.is_empty() && r.start >= self.planned.start && r.end <= self.planned.end
        };
        self.planned.start <= self.planned.end
            && self.taken.iter().all(within)
            && self.taken.windows(2).all(|w| w[0].end < w[1].start)
    }
}

/// The smallest range around two; an empty one counts for nothing.
fn hull(a: &Range<u64>, b: &Range<u64>) -> Range<u64> {
    match (a.is_empty(), b.is_empty()) {
        (true, false) => b.clone(),
        (_, true) => a.clone(),
        _ => a.start.min(b.start)..a.end.max(b.end),
    }
}

/// The history of a field.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SampleRanges {
    /// How records were made, in the words of whoever made them. Only records made alike may be
    /// added.
    pub recipe: String,
    /// Numbers of photons.
    pub photons: Numbers,
    /// Numbers of camera paths.
    pub paths: Numbers,
    /// Records came in after the last refinement: models take them in when the field is frozen.
    pub unrefined: bool,
}

impl SampleRanges {
    /// Why two fields must not be added, if they must not.
    pub(crate) fn conflict(&self, other: &Self) -> Option<String> {
        if self.recipe != other.recipe {
            return Some(format!(
                "their records were made differently ({} and {})",
                self.recipe, other.recipe
            ));
        }
        for (what, mine, theirs) in [
            ("photons", &self.photons, &other.photons),
            ("paths", &self.paths, &other.paths),
        ] {
            if let Some(r) = mine.overlap(theirs) {
                return Some(format!("both contain the {what} {}", in_words(&r)));
            }
        }
        None
    }

    /// Adds another's records.
    pub(crate) fn join(&mut self, other: &Self) {
        self.photons.join(&other.photons);
        self.paths.join(&other.paths);
        self.unrefined |= other.unrefined;
    }

    /// What is planned but missing, in words; `None` if nothing is.
    pub fn missing(&self) -> Option<String> {
        let mut gaps = Vec::new();
        for (what, numbers) in [("photons", &self.photons), ("paths", &self.paths)] {
            let missing = numbers.missing();
            if !missing.is_empty() {
                let list: Vec<String> = missing.iter().map(in_words).collect();
                gaps.push(format!("{what} {}", list.join(", ")));
            }
        }
        (!gaps.is_empty()).then(|| gaps.join("; "))
    }

    pub(crate) fn is_sound(&self) -> bool {
        self.photons.is_sound() && self.paths.is_sound()
    }
}

/// First and last number of a range that is not empty.
fn in_words(r: &Range<u64>) -> String {
    format!("{} to {}", r.start, r.end.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(ranges: &[Range<u64>], planned: Range<u64>) -> Numbers {
        let mut sum = Numbers::new(0..0, planned.clone());
        for r in ranges {
            sum.join(&Numbers::new(r.clone(), planned.clone()));
        }
        sum
    }

    #[test]
    fn ranges_join_in_any_order() {
        let want = Numbers::new(0..9, 0..9);
        for order in [[0, 1, 2], [2, 0, 1], [1, 2, 0], [2, 1, 0]] {
            let parts = [0..3, 3..4, 4..9];
            let got = of(&order.map(|i: usize| parts[i].clone()), 0..9);
            assert_eq!(got, want);
            assert_eq!(got.taken(), std::slice::from_ref(&(0..9)));
            assert!(got.is_sound() && got.missing().is_empty() && got.count() == 9);
        }
    }

    #[test]
    fn gaps_and_overlaps_are_named() {
        let some = of(&[12..15, 20..30], 10..40);
        assert_eq!(some.missing(), [10..12, 15..20, 30..40]);
        assert_eq!(some.overlap(&of(&[0..12, 15..20], 0..50)), None);
        assert_eq!(some.overlap(&Numbers::new(13..25, 0..50)), Some(13..15));
        assert_eq!(some.next(), 40);
        let sample_ranges = SampleRanges {
            paths: some,
            ..SampleRanges::default()
        };
        let missing = sample_ranges.missing().unwrap();
        assert_eq!(missing, "paths 10 to 11, 15 to 19, 30 to 39");
        let conflict = sample_ranges.conflict(&sample_ranges).unwrap();
        assert!(conflict.contains("paths 12 to 14"), "{conflict}");
    }

    #[test]
    fn nothing_is_planned_around_nothing() {
        let base = Numbers::new(0..100, 0..100);
        let mut sum = Numbers::new(0..0, 0..0);
        sum.join(&base);
        assert_eq!(sum, base);
        sum.join(&Numbers::new(0..0, 0..0));
        assert_eq!(sum, base);
    }

    #[test]
    fn unsound_numbers_are_told() {
        for text in [
            r#"{"taken":[{"start":3,"end":2}],"planned":{"start":0,"end":9}}"#,
            r#"{"taken":[{"start":0,"end":4},{"start":3,"end":5}],"planned":{"start":0,"end":9}}"#,
            r#"{"taken":[{"start":0,"end":10}],"planned":{"start":0,"end":9}}"#,
            r#"{"taken":[],"planned":{"start":9,"end":0}}"#,
        ] {
            let numbers: Numbers = serde_json::from_str(text).unwrap();
            assert!(!numbers.is_sound(), "{text}");
        }
    }
}
