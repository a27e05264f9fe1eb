//! The prefixes and suffixes of a wave.

use super::prefix::{PathPrefix, Suffix};
use super::reconnection::Reconnector;
use crate::bsdf::Bsdf;
use crate::integrate::camera_sample::Origin;
use crate::integrate::context::PathContext;
use crate::integrate::guided_path::{GuidedPath, PrefixState};
use crate::integrate::light_sums::LightSums;
use crate::integrate::splitting::SplitPaths;
use crate::integrate::vertex::Vertex;
use crate::math::rng::hash_all;
use crate::math::{Rgb, Vec3};
use crate::texture::SurfacePoint;

/// What the paths of a wave have to share.
#[derive(Default)]
pub struct PrefixPool<'s> {
    /// Most prefixes in a group.
    most: usize,
    prefixes: Vec<PathPrefix<'s>>,
}

/// How a pool takes a path that arrives at a vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Admission {
    /// What it finds is its own.
    Alone,
    /// What it finds from here on is shared.
    Shares,
}

impl<'s> PrefixPool<'s> {
    /// A pool for groups of up to `most` prefixes of a wave of so many samples; with 1 it collects
    /// nothing.
    pub fn new(most: u32, samples: usize) -> Self {
        let prefixes = if most > 1 { samples } else { 0 };
        Self {
            most: most as usize,
            // Prefixes are large: they are not to be moved as they become more.
            prefixes: Vec::with_capacity(prefixes),
        }
    }

    /// Whether anything is shared.
    #[inline]
    pub fn is_open(&self) -> bool {
        self.most > 1
    }

    /// Keeps the prefix of a path that is about to leave its first rough vertex, which a field
    /// guides. Returns its number.
    pub(in crate::integrate) fn add_prefix(
        &mut self,
        vertex: &Vertex<'_, 's>,
        path: &GuidedPath,
        split_paths: &SplitPaths,
    ) -> Option<u32> {
        let sample = split_paths.sample_of(path.base.accumulator);
        self.prefixes
            .push(PathPrefix::new(vertex, &path.base, sample)?);
        Some(self.prefixes.len() as u32 - 1)
    }

    /// A path arrives at a vertex. If what is found there can be shared, it gets an accumulator of
    /// its own.
    #[inline]
    pub fn arrive(
        &mut self,
        path: &mut GuidedPath,
        point: &SurfacePoint,
        bsdf: &Bsdf,
        wo: Vec3,
        split_paths: &mut SplitPaths,
    ) -> Admission {
        let PrefixState::EndsHere(prefix) = path.prefix else {
            return Admission::Alone;
        };
        path.prefix = PrefixState::Past;
        let shared = bsdf
            .view()
            .filter(|v| Suffix::takes_part(wo, &path.base, v));
        let Some(view) = shared else {
            return Admission::Alone;
        };
        path.base.accumulator = split_paths.open(path.base.accumulator);
        let suffix = Suffix::new(point, wo, &path.base, view);
        self.prefixes[prefix as usize].suffix = Some(suffix);
        Admission::Shares
    }

    /// Settles the accumulators of a wave so that what was found behind prefixes goes to all that
    /// could have found it; the `parts` of their light, too, if it is taken apart. Returns how many
    /// rays that took.
    pub fn reduce(
        &self,
        context: &PathContext,
        origins: &[Origin],
        split_paths: &mut SplitPaths,
        radiances: &mut [Rgb],
        mut parts: Option<&mut LightSums>,
    ) -> u64 {
        let mut exchange = Reconnector::new(context, &self.prefixes);
        let suffixes = self
            .prefixes
            .iter()
            .filter_map(|prefix| prefix.suffix.as_ref());
        suffixes.for_each(|suffix| split_paths.detach(suffix.accumulator));
        split_paths.reduce(radiances);
        if let Some(parts) = &mut parts {
            parts.reduce(split_paths);
        }
        for group in self.groups(context.settings.seed, origins) {
            exchange.meet(&group, radiances);
        }
        for contribution in &exchange.contributions {
            contribution.pay(radiances, parts.as_deref_mut());
        }
        exchange.rays_traced
    }

    /// Prefixes of like samples in groups, all pixels mixed, so that what they have in common is
    /// spread.
    fn groups(&self, seed: u64, origins: &[Origin]) -> Vec<Vec<u32>> {
        let lots = self.prefixes.iter().zip(0..).map(|(prefix, number)| {
            let Origin { pixel, round } = origins[prefix.sample as usize];
            Lot {
                // A path may be cut off at a depth: only prefixes of one depth stand for the same
                // suffixes.
                kind: (round, prefix.depth),
                lot: hash_all([seed, round, u64::from(pixel)]),
                number,
            }
        });
        grouped(lots.collect(), self.most)
    }
}

/// A prefix that waits for its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Lot {
    /// Only prefixes of one kind meet.
    kind: (u64, u32),
    lot: u64,
    number: u32,
}

/// Groups of up to `most` prefixes by their lots, as equal in size as can be.
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
    fn like_prefixes_meet_in_groups_of_like_size() {
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
        assert!(all.iter().copied().eq(0..100), "each prefix has one group");
        for group in &groups {
            let kind = lots[group[0] as usize].kind;
            assert!(group.iter().all(|&i| lots[i as usize].kind == kind));
            // 33 prefixes of each kind but for one: five groups.
            let sizes = if kind.1 == 1 { 1..=1 } else { 6..=7 };
            assert!(sizes.contains(&group.len()), "{group:?}");
        }
        // Drawn by lot, not in the order in which they came.
        assert!(groups[0].windows(2).any(|pair| pair[0] > pair[1]));
    }
}
