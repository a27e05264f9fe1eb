//! Adding fields that were trained on disjoint records over one structure.

use super::links::Split;
use super::settings::GuideError;
use super::train::Trainer;
use crate::math::sum::SumUnit;

fn refuse<T>(why: &str) -> Result<T, GuideError> {
    Err(GuideError::Merge(why.to_owned()))
}

impl Trainer {
    /// A copy with the same structure, models and units, and no records: what a shard starts from.
    /// `base`, plus shards that trained copies of `base.emptied()`, is `base` trained on
    /// everything, to the bit.
    pub fn emptied(&self) -> Self {
        let mut copy = self.clone();
        copy.intakes = Default::default();
        copy.tallies.fill(Default::default());
        copy.table.fill(0);
        copy.stats.clear();
        for n in &mut copy.space.nodes {
            n.visits_before = 0;
            n.visits = [0; 8];
        }
        copy
    }

    /// Adds the sums of another field of the same structure. All sums are integers, so shards may
    /// be added in any order.
    ///
    /// # Errors
    /// When the fields differ in settings, structure, units or fitted models; nothing is changed
    /// then.
    pub fn merge(&mut self, other: &Self) -> Result<(), GuideError> {
        if self.settings.scene_hash != other.settings.scene_hash {
            return refuse("they belong to different scenes");
        }
        if self.settings != other.settings {
            return refuse("they were made with different settings");
        }
        let (mine, theirs) = (self.product.preorder(), other.product.preorder());
        if mine.len() != theirs.len() || mine.iter().zip(&theirs).any(|(a, b)| a.1 != b.1) {
            return refuse("they were refined differently");
        }
        let photon_unit = common(self.photon_unit, other.photon_unit)?;
        let path_unit = common(self.path_unit, other.path_unit)?;
        let mut stats = self.stats.clone();
        let pairs: Vec<(u32, u32)> = mine
            .iter()
            .zip(&theirs)
            .filter(|(a, _)| a.1 == Split::Leaf)
            .map(|(a, b)| {
                let number = |t: &Self, i: u32| t.product.nodes[i as usize].first;
                (number(self, a.0), number(other, b.0))
            })
            .collect();
        if !pairs.iter().all(|&(a, b)| stats.merge(a, &other.stats, b)) {
            return refuse("their models were refitted apart");
        }
        self.stats = stats;
        self.photon_unit = photon_unit;
        self.path_unit = path_unit;
        for (a, b) in pairs {
            self.add_link(a, other, b);
        }
        self.add_visits(other);
        self.add_intakes(other);
        Ok(())
    }

    fn add_link(&mut self, link: u32, other: &Self, theirs: u32) {
        let (a, b) = (
            &mut self.tallies[link as usize],
            &other.tallies[theirs as usize],
        );
        a.photons.merge(&b.photons);
        a.paths.merge(&b.paths);
        for origin in 0..2 {
            a.count[origin] = a.count[origin].saturating_add(b.count[origin]);
            a.squares[origin] = a.squares[origin].saturating_add(b.squares[origin]);
        }
        let stride = self.table_stride();
        let from = &other.table[theirs as usize * stride..(theirs as usize + 1) * stride];
        let to = &mut self.table[link as usize * stride..(link as usize + 1) * stride];
        for (x, y) in to.iter_mut().zip(from) {
            *x = x.saturating_add(*y);
        }
    }

    fn add_visits(&mut self, other: &Self) {
        let (mine, theirs) = (self.space.preorder(), other.space.preorder());
        for (a, b) in mine.into_iter().zip(theirs) {
            let b = &other.space.nodes[b as usize];
            let a = &mut self.space.nodes[a as usize];
            a.visits_before += b.visits_before;
            for (x, y) in a.visits.iter_mut().zip(b.visits) {
                *x += y;
            }
        }
    }

    fn add_intakes(&mut self, other: &Self) {
        let (a, b) = (&mut self.intakes, &other.intakes);
        a.emitted = a.emitted.saturating_add(b.emitted);
        a.photons = a.photons.saturating_add(b.photons);
        a.paths = a.paths.saturating_add(b.paths);
        a.batches = a.batches.saturating_add(b.batches);
        a.rounds = a.rounds.saturating_add(b.rounds);
        a.dropped_non_finite = a.dropped_non_finite.saturating_add(b.dropped_non_finite);
        a.dropped_direction = a.dropped_direction.saturating_add(b.dropped_direction);
    }
}

fn common(a: Option<SumUnit>, b: Option<SumUnit>) -> Result<Option<SumUnit>, GuideError> {
    match (a, b) {
        (Some(x), Some(y)) if x != y => {
            refuse("their sums have different units (shards must start from `emptied`)")
        }
        _ => Ok(a.or(b)),
    }
}
