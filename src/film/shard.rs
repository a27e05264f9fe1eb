//! Shares of a film for several machines.
//!
//! A film is shared out by tiles, not by samples. Sums of floating-point numbers depend on the
//! order of their terms: two machines that took half of the samples each would have to hand over
//! every sample, or the merged image would differ in its last bits from one rendered in one piece,
//! and differ again with another number of machines. All samples of a tile belong to one shard
//! instead, which adds them in their order as a whole render does; merging moves tiles and adds
//! nothing. The same bits then come out of any number of shards, merged in any order.
//!
//! The price of tiles is that some are dearer than others. They are dealt like cards after a
//! shuffle that everybody knows, so that every shard gets its share of the sky and of the glass
//! alike.

use serde::{Deserialize, Serialize};

/// One of `count` shares of a film, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which, below `count`.
    pub index: u32,
    /// Of how many.
    pub count: u32,
}

impl Shard {
    /// The whole film.
    pub const ALL: Shard = Shard { index: 0, count: 1 };

    /// The tiles of this shard in a film of `tiles`, in film order.
    pub fn tiles(self, tiles: usize) -> impl Iterator<Item = usize> {
        let deal = Deal::new(tiles, self.count);
        (0..tiles).filter(move |&tile| deal.owner(tile) == self.index)
    }
}

impl std::fmt::Display for Shard {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

/// Who gets which tile.
#[derive(Clone, Copy, Debug)]
pub struct Deal {
    tiles: u64,
    step: u64,
    shards: u64,
}

impl Deal {
    /// Deals `tiles` to `shards`; the shares differ by one tile at most.
    pub fn new(tiles: usize, shards: u32) -> Self {
        let tiles = tiles.max(1) as u64;
        // Multiples of a step near the golden section of the number of tiles land evenly
        // everywhere. A step without common divisors visits every place once, which makes it a
        // shuffle.
        let golden = (tiles as f64 * 0.618_033_988_749_895) as u64;
        let coprime = |step: &u64| divisor(*step, tiles) == 1;
        let step = (golden.max(1)..tiles).find(coprime).unwrap_or(1);
        let shards = u64::from(shards.max(1));
        Self {
            tiles,
            step,
            shards,
        }
    }

    /// The shard that tile number `tile` belongs to.
    pub fn owner(&self, tile: usize) -> u32 {
        // Below 2^27 tiles (a film of 2^17 pixels a side) the product stays far from 2^64.
        let place = tile as u64 * self.step % self.tiles;
        (place % self.shards) as u32
    }
}

/// The greatest common divisor.
fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_is_dealt_once_and_shares_are_even() {
        for tiles in [1, 2, 3, 4, 7, 64, 100, 8160, 32400] {
            for count in [1u32, 2, 3, 4, 7, 120] {
                let mut seen = vec![0; tiles];
                let mut shares = Vec::new();
                for index in 0..count {
                    let share: Vec<usize> = Shard { index, count }.tiles(tiles).collect();
                    share.iter().for_each(|&tile| seen[tile] += 1);
                    shares.push(share.len());
                }
                assert!(seen.iter().all(|&n| n == 1), "{tiles} {count}");
                let (least, most) = (shares.iter().min(), shares.iter().max());
                assert!(most.unwrap() - least.unwrap() <= 1, "{tiles} {count}");
            }
        }
    }

    /// A quarter of the picture that is dear must not fall to one shard: every shard has a share of
    /// every quarter that is even to a tenth.
    #[test]
    fn shares_are_spread_over_the_picture() {
        let (across, down) = (120, 68);
        for count in [2, 4, 5, 8, 15] {
            for index in 0..count {
                let mut quarters = [0; 4];
                for tile in (Shard { index, count }).tiles(across * down) {
                    let (x, y) = (tile % across, tile / across);
                    quarters[2 * (y * 2 / down) + x * 2 / across] += 1;
                }
                let even = (across * down) as f64 / 4.0 / f64::from(count);
                for quarter in quarters {
                    let share = f64::from(quarter) / even;
                    assert!((0.9..1.1).contains(&share), "{index}/{count}: {quarters:?}");
                }
            }
        }
    }
}
