//! Adding a batch of records to their links: fluxes, tables and models, link by link.

use super::{LocalModel, Region};
use crate::guide::links::Link;
use crate::guide::record::{Deposit, Origin};
use crate::guide::tally::{Tally, add_to_table};
use crate::math::equal_area::CODE_LEVELS;
use crate::math::sum::SumUnit;

/// Where a chunk of sorted records goes: consecutive links from number `first` on.
pub(super) struct Slots<'a, S> {
    pub first: u32,
    pub tallies: &'a mut [Tally],
    pub table: &'a mut [u32],
    pub stats: &'a mut [S],
}

/// What every chunk reads.
pub(crate) struct Batch<'a> {
    pub deposits: &'a [Deposit],
    pub links: &'a [Link],
    pub regions: &'a (dyn Fn(&Link) -> Region + Sync),
    pub octant: &'a (dyn Fn(&Link, u64) -> u32 + Sync),
    pub unit: SumUnit,
    pub origin: Origin,
    pub look: Look,
}

/// What records are shown for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Look {
    /// They are new: they are counted, and fill tables and models.
    First,
    /// They have been counted before, but new links have not: they only fill tables.
    Tables,
    /// Another iteration of fitting: they only train models.
    Models,
}

/// Adds the records `order` (link number in the upper half, record in the lower; sorted) to their
/// links. Chunks are cut between links, so each link is added to by one task in record order: no
/// locks, and no dependence on threads even for sums that were not associative.
pub(super) fn accumulate<M: LocalModel>(batch: &Batch, order: &[u64], slots: Slots<M::Stats>) {
    const CHUNK: usize = 8192;
    let middle_link = order.get(order.len() / 2).map_or(0, |o| (o >> 32) as u32);
    if order.len() > CHUNK && middle_link > slots.first {
        let cut = order.partition_point(|o| ((o >> 32) as u32) < middle_link);
        let at = (middle_link - slots.first) as usize;
        let stride = slots.table.len() / slots.tallies.len();
        let (ta, tb) = slots.tallies.split_at_mut(at);
        let (ba, bb) = slots.table.split_at_mut(at * stride);
        let (sa, sb) = slots.stats.split_at_mut(at);
        let low = Slots {
            first: slots.first,
            tallies: ta,
            table: ba,
            stats: sa,
        };
        let high = Slots {
            first: middle_link,
            tallies: tb,
            table: bb,
            stats: sb,
        };
        rayon::join(
            || accumulate::<M>(batch, &order[..cut], low),
            || accumulate::<M>(batch, &order[cut..], high),
        );
        return;
    }
    accumulate_chunk::<M>(batch, order, slots);
}

fn accumulate_chunk<M: LocalModel>(batch: &Batch, order: &[u64], slots: Slots<M::Stats>) {
    let fine = 1usize << (2 * M::TABLE_LEVELS);
    // One table a link, or two where photons and paths are told apart.
    let stride = slots.table.len() / slots.tallies.len();
    let half = (stride - 8 * fine) * batch.origin as usize;
    for run in order.chunk_by(|a, b| a >> 32 == b >> 32) {
        let number = (run[0] >> 32) as usize;
        let link = &batch.links[number];
        let region = (batch.regions)(link);
        let i = number - slots.first as usize;
        let tally = &mut slots.tallies[i];
        let at = i * stride + half;
        let table = &mut slots.table[at..at + 8 * fine];
        let down = 2 * u32::from(CODE_LEVELS - link.q.level() - M::TABLE_LEVELS);
        for o in run {
            let d = &batch.deposits[*o as u32 as usize];
            if batch.look != Look::Tables {
                M::train(&mut slots.stats[i], &region, d, batch.origin);
            }
            if batch.look == Look::Models {
                continue;
            }
            let cell = (batch.octant)(link, d.key) as usize * fine
                + ((d.code >> down) as usize & (fine - 1));
            add_to_table(tally, table, cell, batch.origin, d);
            if batch.look == Look::Tables {
                continue;
            }
            match batch.origin {
                Origin::Photon => tally.photons.add(batch.unit, d.value),
                Origin::Path => tally.paths.add(batch.unit, d.value),
            }
            tally.count[batch.origin as usize] += 1;
        }
    }
}
