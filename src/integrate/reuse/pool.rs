//! The stems and suffixes of a wave.

use super::exchange::Exchange;
use super::stem::{Stem, Suffix};
use super::{Origin, Stage};
use crate::bsdf::Bsdf;
use crate::integrate::forks::Forks;
use crate::integrate::vertex::{Vertex, Walk};
use crate::integrate::wave::{Outcome, Path};
use crate::math::Vec3;
use crate::math::rng::hash_all;
use crate::texture::SurfacePoint;

/// What the paths of a wave have to share.
pub struct Pool<'s> {
    /// Most stems in a group.
    most: usize,
    stems: Vec<Stem<'s>>,
}

/// How a pool takes a path that arrives at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// What it finds is its own.
    Alone,
    /// What it finds from here on is shared.
    Shares,
}

impl<'s> Pool<'s> {
    /// A pool for groups of up to `most` stems of a wave of so many samples; with 1 it collects
    /// nothing.
    pub fn new(most: u32, samples: usize) -> Self {
        let stems = if most > 1 { samples } else { 0 };
        Self {
            most: most as usize,
            // Stems are large: they are not to be moved as they become more.
            stems: Vec::with_capacity(stems),
        }
    }

    /// Whether anything is shared.
    #[inline]
    pub fn is_open(&self) -> bool {
        self.most > 1
    }

    /// Keeps the stem of a path that is about to leave its first rough vertex, which a field
    /// guides. Returns its number.
    pub(in crate::integrate) fn add_stem(
        &mut self,
        vertex: &Vertex<'_, 's>,
        path: &Path,
        forks: &Forks,
    ) -> Option<u32> {
        let sample = forks.sample_of(path.slot);
        self.stems.push(Stem::new(vertex, path, sample)?);
        Some(self.stems.len() as u32 - 1)
    }

    /// A path arrives at a vertex. If what is found there can be shared, it gets an account of its
    /// own.
    #[inline]
    pub fn arrive(
        &mut self,
        path: &mut Path,
        point: &SurfacePoint,
        bsdf: &Bsdf,
        wo: Vec3,
        forks: &mut Forks,
    ) -> Admission {
        let Stage::Left(stem) = path.stage else {
            return Admission::Alone;
        };
        path.stage = Stage::Past;
        let suffix = bsdf.view().and_then(|v| Suffix::new(point, wo, path, v));
        let Some(mut suffix) = suffix else {
            return Admission::Alone;
        };
        path.slot = forks.open(path.slot);
        suffix.slot = path.slot;
        self.stems[stem as usize].suffix = Some(suffix);
        Admission::Shares
    }

    /// Settles the accounts of a wave so that what was found behind stems goes to all that could
    /// have found it. Returns how many rays that took.
    pub fn settle(
        &self,
        walk: &Walk,
        origins: &[Origin],
        forks: &mut Forks,
        outcomes: &mut [Outcome],
    ) -> u64 {
        let mut exchange = Exchange::new(walk, &self.stems);
        let suffixes = self.stems.iter().filter_map(|stem| stem.suffix.as_ref());
        suffixes.for_each(|suffix| forks.detach(suffix.slot));
        forks.settle(outcomes);
        for group in self.groups(walk.settings.seed, origins) {
            exchange.meet(&group, outcomes);
        }
        for gift in &exchange.gifts {
            gift.pay(outcomes);
        }
        exchange.rays_traced
    }

    /// Stems of like samples in groups, all pixels mixed, so that what they have in common is
    /// spread.
    fn groups(&self, seed: u64, origins: &[Origin]) -> Vec<Vec<u32>> {
        let lots = self.stems.iter().zip(0..).map(|(stem, number)| {
            let Origin { pixel, round } = origins[stem.sample as usize];
            Lot {
                // A path may be cut off at a depth: only stems of one depth stand for the same
                // suffixes.
                kind: (round, stem.depth),
                lot: hash_all([seed, round, u64::from(pixel)]),
                number,
            }
        });
        grouped(lots.collect(), self.most)
    }
}

/// A stem that waits for its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Lot {
    /// Only stems of one kind meet.
    kind: (u64, u32),
    lot: u64,
    number: u32,
}

/// Groups of up to `most` stems by their lots, as equal in size as can be.
fn grouped(mut lots: Vec<Lot>, most: usize) -> Vec<Vec<u32>> {
    lots.sort_unstable();
    let mut groups = Vec::with_capacity(lots.len() / most + 1);
    for alike in lots.chunk_by(|a, b| a.kind == b.kind) {
        let count = alike.len().div_ceil(most);
        let begin = |group| group * alike.len() / count;
        groups.extend((0..count).map(|group| {
            let members = &alike[begin(group)..begin(group + 1)];
            members.iter().map(|lot| lot.number).collect()
        }));
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn like_stems_meet_in_groups_of_like_size() {
        let lots: Vec<Lot> = (0..100)
            .map(|number| Lot {
                kind: (u64::from(number % 3), u32::from(number == 99)),
                lot: hash_all([u64::from(number)]),
                number,
            })
            .collect();
        let groups = grouped(lots.clone(), 8);
        let mut all = groups.concat();
        all.sort_unstable();
        assert!(all.iter().copied().eq(0..100), "each stem has one group");
        for group in &groups {
            let kind = lots[group[0] as usize].kind;
            assert!(group.iter().all(|&i| lots[i as usize].kind == kind));
            // 33 stems of each kind but for one: five groups.
            let sizes = if kind.1 == 1 { 1..=1 } else { 6..=7 };
            assert!(sizes.contains(&group.len()), "{group:?}");
        }
        // Drawn by lot, not in the order in which they came.
        assert!(groups[0].windows(2).any(|pair| pair[0] > pair[1]));
    }
}
