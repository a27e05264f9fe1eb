//! Where the image looks: cells of R that no camera path can meet are not refined.
//!
//! Camera paths are a sample. A cell that no path of the sample met may be met by the next one, if
//! it is small or lies at the edge of what is seen. So a sample speaks for cells of one size: the
//! smallest at which an occupied cell still holds a number of points on average. Those cells and
//! their neighbours are seen, down to any depth.

use super::record::SurfacePoint;
use super::space::{AXIS_BITS, Grid, spread, squeeze};
use super::train::Trainer;

impl Trainer {
    /// Gives a sample of the positions that camera paths meet: cells without one are not refined
    /// any further. Cells that hold `per_cell` of them on average are told apart, and their
    /// neighbours count as seen, too. An empty slice lifts the restriction.
    pub fn set_importance(&mut self, points: &[SurfacePoint], per_cell: usize) {
        let keys = self.space.keys(points);
        let grid = &self.space.grid;
        let level = resolved_level(grid, &keys, per_cell);
        self.space.seen = with_neighbours(grid, &keys, level);
        self.space.seen_level = level;
    }
}

/// The deepest level at which occupied cells hold `per_cell` of the sorted keys on average.
fn resolved_level(grid: &Grid, keys: &[u64], per_cell: usize) -> u8 {
    let occupied = |level: u8| {
        let shift = grid.shift(level - 1);
        keys.chunk_by(|a, b| a >> shift == b >> shift).count()
    };
    let levels = 1..=grid.max_level;
    let resolved = levels.take_while(|&l| occupied(l) * per_cell <= keys.len());
    resolved.last().unwrap_or(0)
}

/// The smallest keys of all cells of a level that hold a key or touch one that does, on the same
/// side of surfaces where the grid tells sides apart; sorted.
fn with_neighbours(grid: &Grid, keys: &[u64], level: u8) -> Vec<u64> {
    if level == 0 {
        return Vec::new();
    }
    let shift = grid.shift(level - 1);
    let spatial = u32::from(level - grid.side_levels());
    let mut cells = Vec::new();
    for run in keys.chunk_by(|a, b| a >> shift == b >> shift) {
        let side = run[0] >> (3 * AXIS_BITS) << (3 * AXIS_BITS);
        let at = [0, 1, 2].map(|axis| squeeze(run[0] >> axis) >> (AXIS_BITS - spatial));
        for i in 0..27u64 {
            let moved = [i % 3, i / 3 % 3, i / 9];
            let place = [0, 1, 2].map(|axis| (at[axis] + moved[axis]).checked_sub(1));
            let [Some(x), Some(y), Some(z)] = place else {
                continue;
            };
            if x.max(y).max(z) >> spatial == 0 {
                let axis = |v: u64| spread(v << (AXIS_BITS - spatial));
                cells.push(side | axis(x) | axis(y) << 1 | axis(z) << 2);
            }
        }
    }
    cells.sort_unstable();
    cells.dedup();
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::guide::Settings;
    use crate::math::{Pcg32, Vec3};

    /// Points all over the left quarter of a floor.
    fn sample(n: usize) -> Vec<SurfacePoint> {
        let mut rng = Pcg32::new(3, 4);
        (0..n)
            .map(|_| SurfacePoint {
                position: Vec3::new(0.25 * rng.next_f32(), rng.next_f32(), 0.0),
                normal: Vec3::Z,
            })
            .collect()
    }

    fn seen(t: &mut Trainer, x: Vec3, normal: Vec3, depth: u8) -> bool {
        let key = t.space.grid.key(x, normal);
        let mut node = 0;
        for level in 0..depth {
            node = t.space.split(node) + t.space.grid.octant(key, level);
        }
        t.space.is_seen(node)
    }

    #[test]
    fn cells_of_any_depth_are_seen_where_the_sample_is_dense_and_one_cell_beyond() {
        for normal_split in [false, true] {
            let settings = Settings {
                normal_split,
                ..Settings::new(Vec3::ZERO, Vec3::ONE)
            };
            let mut t = Trainer::build(settings).unwrap();
            t.set_importance(&sample(4000), 16);
            // 4000 points, 16 a cell: 250 cells of a quarter of a floor, side 1/32 would be 256.
            assert_eq!(t.space.seen_level, 4 + u8::from(normal_split));
            for depth in [6, 12] {
                let mut at = |x: f32| seen(&mut t, Vec3::new(x, 0.51, 0.001), Vec3::Z, depth);
                assert!(at(0.01) && at(0.24), "inside");
                assert!(at(0.26), "a neighbour");
                assert!(!at(0.33), "beyond");
            }
            let below = seen(&mut t, Vec3::new(0.1, 0.5, 0.0), -Vec3::Z, 9);
            assert_eq!(below, !normal_split, "the other side");
        }
    }

    #[test]
    fn a_sample_too_small_to_tell_restricts_nothing() {
        let mut t = Trainer::build(Settings::new(Vec3::ZERO, Vec3::ONE)).unwrap();
        t.set_importance(&sample(10), 16);
        assert!(seen(&mut t, Vec3::splat(0.9), Vec3::Z, 7));
        t.set_importance(&[], 16);
        assert!(seen(&mut t, Vec3::splat(0.9), Vec3::Z, 7));
    }
}
