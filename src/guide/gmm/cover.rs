//! Which records' spheres hold a point: hashed grids, one for each size of sphere.

use crate::math::Vec3;
use rustc_hash::FxHashMap;

/// Spheres by the cells that they touch. A sphere is entered in the grid whose cells are one to two
/// times as wide as itself, so in at most eight of them.
#[derive(Clone, Debug)]
pub(super) struct Cover {
    min: Vec3,
    /// Width of the smallest cells; each level's are twice as wide as those of the level below.
    width: f32,
    /// Levels in use, one bit each.
    levels: u32,
    cells: FxHashMap<u64, Vec<u32>>,
}

/// Bits of a cell's coordinate along each axis.
const BITS: u32 = 20;
/// Levels that fit beside three coordinates.
const LEVELS: u32 = 16;

impl Cover {
    /// No spheres yet, in a scene whose lower corner is `min`, none with a radius below `least`.
    pub fn new(min: Vec3, least: f32) -> Self {
        Self {
            min,
            width: 2.0 * least,
            levels: 0,
            cells: FxHashMap::default(),
        }
    }

    fn coordinates(&self, x: Vec3, level: u32) -> [u64; 3] {
        let scale = 1.0 / (self.width * (1u32 << level) as f32);
        // Saturates: whatever lies outside shares the cells at the rim.
        let along = |v: f32| u64::from(((v * scale) as u32).min((1 << BITS) - 1));
        ((x - self.min).max(Vec3::ZERO)).to_array().map(along)
    }

    fn key([x, y, z]: [u64; 3], level: u32) -> u64 {
        u64::from(level) << (3 * BITS) | x << (2 * BITS) | y << BITS | z
    }

    /// Adds a sphere under a number.
    pub fn add(&mut self, number: u32, centre: Vec3, radius: f32) {
        let size = (2.0 * radius / self.width).max(1.0);
        let level = (size.log2().ceil() as u32).min(LEVELS - 1);
        self.levels |= 1 << level;
        let low = self.coordinates(centre - radius, level);
        let high = self.coordinates(centre + radius, level);
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let cell = self.cells.entry(Self::key([x, y, z], level));
                    cell.or_default().push(number);
                }
            }
        }
    }

    /// Calls `found` with the numbers of all spheres that may hold `x`, smaller ones first, until
    /// it says that it has seen enough by `true`.
    #[inline]
    pub fn near(&self, x: Vec3, mut found: impl FnMut(u32) -> bool) {
        let mut levels = self.levels;
        while levels != 0 {
            let level = levels.trailing_zeros();
            levels &= levels - 1;
            let cell = self
                .cells
                .get(&Self::key(self.coordinates(x, level), level));
            for &number in cell.into_iter().flatten() {
                if found(number) {
                    return;
                }
            }
        }
    }
}
