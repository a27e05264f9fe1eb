//! Several rounds of refining over one batch.
//!
//! A split's children know their share of the flux but not how it is spread inside them, so a round
//! can only go one level deeper. The trainer therefore keeps the records of the last batch, each
//! with its place in P. After a round, those whose link was divided go on down from there and fill
//! the tables of the new links, counting nothing twice, and the next round can look at these links.
//! At last mixtures are fitted to the batch as the links have come to divide it.

use super::links::{ProductPosition, step};
use super::model::Look;
use super::recent::Recent;
use super::record::{Deposit, Origin};
use super::refine::Refined;
use super::train::Trainer;
use rayon::prelude::*;

/// How many records a batch should have at most, well below what is kept: mixtures then learn from
/// all of them. (When batches of photons doubled without end, RMSE over that of cached mixtures,
/// nine million photons, door, was 1.09 instead of 1.05. With batches of this size, relMSE after 60
/// s in veach-ajar 0.0161 instead of 0.0188, in a kitchen 0.0268 instead of 0.0298.)
pub const BATCH: u64 = 3 << 20;

/// Iterations of fitting after the last new lobe.
const UNDISTURBED: u32 = 2;

/// A batch with less than this share of the records before it is looked at once: what lobes its
/// records belong to hardly changes from one look to the next.
const SMALL: f64 = 0.2;

impl Trainer {
    /// *Refine* in up to `rounds` rounds over the batch that was trained last. Its records are not
    /// counted again; they only tell new links how their share is spread. Then they are forgotten.
    /// A batch of records that do not decide about splits (see [`super::Source`]) gets one round.
    pub fn refine_rounds(&mut self, rounds: u32) -> Refined {
        let forgotten = Recent::of(self.recent.most);
        let mut recent = std::mem::replace(&mut self.recent, forgotten);
        let Some(origin) = recent.origin.filter(|o| self.origins().contains(o)) else {
            return self.refine();
        };
        self.intakes.rounds += 1;
        self.refit();
        let mut sum = self.divide(None);
        let mut last = sum;
        for round in 1..=rounds {
            if last.space + last.direction == 0 {
                break;
            }
            let fresh = self.show_again(&mut recent, origin);
            // What was made last starts with filled tables, too.
            if round == rounds || last.refused > 0 {
                break;
            }
            last = self.divide(Some(&fresh));
            sum.space += last.space;
            sum.direction += last.direction;
            sum.refused = last.refused;
            sum.gain += last.gain;
        }
        self.iterate(&mut recent, origin);
        self.stats.settle();
        sum
    }

    /// Fits models to the batch on the links as they are now: from the parameters as they were,
    /// each time it is found anew which record belongs to what, and the best parameters for that
    /// are taken.
    fn iterate(&mut self, recent: &mut Recent, origin: Origin) {
        let (iterations, Some(unit)) = (self.looks(recent, origin), self.unit(origin)) else {
            return;
        };
        if iterations == 0 {
            return;
        }
        let mut order = self.descend(&recent.deposits, &mut recent.places, true);
        // Records of a link side by side: they are read several times.
        arrange(&mut recent.deposits, &mut order);
        for i in 1..=iterations {
            self.stats.clear();
            self.add_up(&recent.deposits, &order, (unit, origin), Look::Models);
            self.refit();
            if i + UNDISTURBED <= iterations {
                self.stats.reseed();
            }
        }
    }

    /// How often models are fitted to the batch.
    fn looks(&self, recent: &Recent, origin: Origin) -> u32 {
        let before = recent.before as f64;
        let batch = self.intakes.of(origin) as f64 - before;
        if batch < SMALL * before {
            return self.traits.iterations.min(1);
        }
        self.traits.iterations
    }

    /// Fills the tables of links made since, and returns these links.
    fn show_again(&mut self, recent: &mut Recent, origin: Origin) -> Vec<u32> {
        for v in &mut recent.vertices {
            if self.space.nodes[v.leaf as usize].first == 0 {
                continue;
            }
            let (leaf, octant) = self.space.leaf_below(v.leaf, v.key);
            v.leaf = leaf;
            // Known before the cell was made, now also by octant.
            let node = &mut self.space.nodes[leaf as usize];
            if node.visits_before > 0 {
                node.visits_before -= 1;
                node.visits[octant as usize] += 1;
            }
        }
        let Some(unit) = self.unit(origin) else {
            return Vec::new();
        };
        let order = self.descend(&recent.deposits, &mut recent.places, false);
        self.add_up(&recent.deposits, &order, (unit, origin), Look::Tables);
        let links = order.chunk_by(|a, b| a >> 32 == b >> 32);
        links.map(|run| (run[0] >> 32) as u32).collect()
    }

    /// Brings records down from their places to the leaves of P. Returns all of them, or those that
    /// moved: link number in the upper half, record in the lower, sorted.
    pub(crate) fn descend(
        &self,
        deposits: &[Deposit],
        places: &mut [ProductPosition],
        all: bool,
    ) -> Vec<u64> {
        let (nodes, grid) = (&self.product.nodes, &self.space.grid);
        let mut order: Vec<u64> = places
            .par_iter_mut()
            .zip(deposits)
            .enumerate()
            .filter_map(|(i, (place, d))| {
                let before = place.node;
                while let Some(next) = step(nodes, grid, d.key, d.code, *place) {
                    *place = next;
                }
                let link = u64::from(nodes[place.node as usize].first);
                (all || place.node != before).then_some(link << 32 | i as u64)
            })
            .collect();
        order.par_sort_unstable();
        order
    }
}

/// Brings records into the order whose lower halves number them, where they lie: a copy of all
/// would be as large again. The order is then that of their new numbers.
fn arrange<T: Copy>(records: &mut [T], order: &mut [u64]) {
    for start in 0..order.len() {
        let first = records[start];
        let mut at = start;
        // Once around the cycle that begins here, if it was not gone around before.
        loop {
            let from = order[at] as u32 as usize;
            order[at] = order[at] >> 32 << 32 | at as u64;
            if from == start || from == at {
                break;
            }
            records[at] = records[from];
            at = from;
        }
        if at != start {
            records[at] = first;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{ModelKind, Photon, Settings};
    use super::*;
    use crate::math::{Pcg32, Rgb, Vec3};

    #[test]
    fn records_are_arranged_where_they_lie() {
        let mut rng = Pcg32::new(3, 4);
        for count in [0u64, 1, 2, 3, 1000] {
            let records: Vec<u64> = (0..count).map(|i| 7 * i + 1).collect();
            let mut order: Vec<u64> = (0..count)
                .map(|i| u64::from(rng.next_u32() % 16) << 32 | i)
                .collect();
            order.sort_unstable();
            let expected: Vec<u64> = order.iter().map(|o| records[*o as u32 as usize]).collect();
            let links: Vec<u64> = order.iter().map(|o| o >> 32).collect();
            let mut arranged = records.clone();
            arrange(&mut arranged, &mut order);
            assert_eq!(arranged, expected);
            for (i, o) in order.iter().enumerate() {
                assert_eq!((o >> 32, *o as u32 as usize), (links[i], i));
            }
        }
    }

    #[test]
    fn only_a_batch_beside_which_much_is_known_is_looked_at_once() {
        let settings = Settings {
            model: ModelKind::Gauss,
            ..Settings::new(Vec3::ZERO, Vec3::ONE)
        };
        let mut trainer = Trainer::build(settings).unwrap();
        let mut rng = Pcg32::new(5, 6);
        let mut looks = |count: u32| {
            let photon = |_| Photon {
                position: Vec3::new(rng.next_f32(), rng.next_f32(), 0.0),
                direction: Vec3::Z,
                power: Rgb::ONE,
                distance: 1.0,
                normal: Vec3::Z,
            };
            let photons: Vec<Photon> = (0..count).map(photon).collect();
            trainer.train(&photons, u64::from(count));
            let looks = trainer.looks(&trainer.recent, Origin::Photon);
            trainer.refine_rounds(1);
            looks
        };
        let many = looks(100);
        assert!(many > 1);
        for count in [100, 200, 400] {
            assert_eq!(looks(count), many);
        }
        assert_eq!((looks(160), looks(150)), (many, 1));
    }
}
