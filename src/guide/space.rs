//! R: the octree over space.

use super::measure::Measure;
use super::record::SurfacePoint;
use super::settings::Settings;
use super::sides::{MEDIA, Sides};
use crate::math::{DVec3, Vec3};
use rayon::prelude::*;

/// Bits an axis in a position key.
pub(crate) const AXIS_BITS: u32 = 20;
/// The least key of a point inside of a medium, where sides tell media apart.
const FIRST_IN_MEDIA: u64 = MEDIA << (3 * AXIS_BITS);

/// Turns positions into keys: 20 bits an axis, interleaved, so that the cell of level `l` is named
/// by the upper `3 l` bits. Computed in `f64` from the corner, so that cells are exact far from the
/// origin; positions outside are clamped to the boundary. Where sides are told apart three more bits
/// on top hold the cell of the side, and level 0 divides sides instead of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    min: DVec3,
    extent: f64,
    inverse: f64,
    sides: Sides,
    /// Deepest level of R, including the one for sides.
    pub max_level: u8,
}

impl Grid {
    pub fn new(settings: &Settings) -> Self {
        let (min, max) = (settings.min.as_dvec3(), settings.max.as_dvec3());
        // A cube, so that cells do not degenerate; never empty, so that one point is a scene.
        let extent = (max - min).max_element().max(1e-30) * (1.0 + 1e-6);
        let largest = min.abs().max(max.abs()).max_element();
        // A cell of 64 ulp: below that, positions differ by rounding only.
        let ulp = largest * f64::from(f32::EPSILON);
        let usable = (extent / (64.0 * ulp).max(1e-300)).log2().floor();
        let levels = usable.clamp(0.0, f64::from(settings.max_space_level)) as u8;
        let sides = Sides::of(settings);
        Self {
            min,
            extent,
            inverse: 1.0 / extent,
            sides,
            max_level: levels + sides.levels(),
        }
    }

    #[inline]
    pub fn key(&self, p: Vec3, normal: Vec3) -> u64 {
        const SIDE: f64 = (1u64 << AXIS_BITS) as f64;
        let q = (p.as_dvec3() - self.min) * (self.inverse * SIDE);
        // The cast saturates below and maps NaN to 0.
        let axis = |v: f64| spread((v as u64).min((1 << AXIS_BITS) - 1));
        let key = axis(q.x) | (axis(q.y) << 1) | (axis(q.z) << 2);
        key | (self.sides.cell(normal) << (3 * AXIS_BITS))
    }

    /// The shift that brings the three bits of level `level` to the bottom.
    #[inline]
    pub fn shift(&self, level: u8) -> u32 {
        let top = 57 + 3 * u32::from(self.sides.levels());
        top - (3 * u32::from(level)).min(top)
    }

    /// Which child of a node of level `level` holds the key.
    #[inline]
    pub fn octant(&self, key: u64, level: u8) -> u32 {
        ((key >> self.shift(level)) & 7) as u32
    }

    /// Levels that divide sides.
    pub fn side_levels(&self) -> u8 {
        self.sides.levels()
    }

    /// Side length of a cell, in scene units.
    fn size(&self, level: u8) -> f64 {
        let spatial = level.saturating_sub(self.sides.levels());
        self.extent / (1u64 << spatial) as f64
    }

    fn centre(&self, node: &SpaceNode) -> Vec3 {
        let half = 0.5 * self.size(node.level);
        let unit = self.extent / f64::from(1u32 << AXIS_BITS);
        let axis = |k: u64| squeeze(k) as f64 * unit + half;
        let k = node.prefix;
        (self.min + DVec3::new(axis(k), axis(k >> 1), axis(k >> 2))).as_vec3()
    }
}

#[inline]
pub(crate) fn spread(mut x: u64) -> u64 {
    x = (x | (x << 32)) & 0x001f_0000_0000_ffff;
    x = (x | (x << 16)) & 0x001f_0000_ff00_00ff;
    x = (x | (x << 8)) & 0x100f_00f0_0f00_f00f;
    x = (x | (x << 4)) & 0x10c3_0c30_c30c_30c3;
    (x | (x << 2)) & 0x1249_2492_4924_9249
}

pub(crate) fn squeeze(mut x: u64) -> u64 {
    x &= 0x0249_2492_4924_9249;
    x = (x | (x >> 2)) & 0x10c3_0c30_c30c_30c3;
    x = (x | (x >> 4)) & 0x100f_00f0_0f00_f00f;
    x = (x | (x >> 8)) & 0x001f_0000_ff00_00ff;
    x = (x | (x >> 16)) & 0x001f_0000_0000_ffff;
    (x | (x >> 32)) & ((1 << AXIS_BITS) - 1)
}

/// A node of R.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SpaceNode {
    /// First of eight children; 0 for a leaf (the root is nobody's child).
    pub first: u32,
    pub level: u8,
    /// The node's smallest key.
    pub prefix: u64,
    /// Path vertices known to lie inside from before the node was made.
    pub visits_before: u64,
    /// Path vertices since, by octant. Only leaves count.
    pub visits: [u64; 8],
}

/// The octree with its measure of area.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Space {
    pub grid: Grid,
    pub nodes: Vec<SpaceNode>,
    /// How much surface and medium lies where.
    pub measure: Measure,
    /// Keys of positions that camera paths met, sorted; empty: everything matters.
    pub seen: Vec<u64>,
    /// They are cells of this level, and tell nothing of what lies deeper.
    pub seen_level: u8,
}

impl Space {
    pub fn new(grid: Grid) -> Self {
        Self {
            grid,
            nodes: vec![SpaceNode {
                first: 0,
                level: 0,
                prefix: 0,
                visits_before: 0,
                visits: [0; 8],
            }],
            measure: Measure::default(),
            seen: Vec::new(),
            seen_level: 0,
        }
    }

    /// Sorted keys of the finite points.
    pub fn keys(&self, points: &[SurfacePoint]) -> Vec<u64> {
        let mut keys: Vec<u64> = points
            .par_iter()
            .filter(|p| p.position.is_finite())
            .map(|p| self.grid.key(p.position, p.normal))
            .collect();
        keys.par_sort_unstable();
        keys
    }

    fn range(&self, node: u32, keys: &[u64]) -> std::ops::Range<usize> {
        let n = &self.nodes[node as usize];
        let span = match n.level {
            0 => u64::MAX,
            level => 1u64 << self.grid.shift(level - 1),
        };
        let end = n.prefix.saturating_add(span);
        keys.partition_point(|&k| k < n.prefix)..keys.partition_point(|&k| k < end)
    }

    pub fn point_count(&self, node: u32) -> usize {
        self.range(node, &self.measure.keys).len()
    }

    /// A(r): what lies inside the node (see [`super::measure`]). Without any points a cell counts as
    /// its face, size^2.
    pub fn area(&self, node: u32) -> f64 {
        let n = &self.nodes[node as usize];
        if self.measure.keys.is_empty() {
            let size = self.grid.size(n.level);
            return size * size;
        }
        let range = self.range(node, &self.measure.keys);
        let in_media = n.prefix >= FIRST_IN_MEDIA;
        self.measure.at_least_half(range, in_media)
    }

    /// The same of a node's octants, whether or not it has been split.
    pub fn octant_areas(&self, node: u32) -> [f64; 8] {
        if self.measure.keys.is_empty() {
            return [0.25 * self.area(node); 8];
        }
        let n = &self.nodes[node as usize];
        let range = self.range(node, &self.measure.keys);
        let keys = &self.measure.keys[range.clone()];
        let shift = self.grid.shift(n.level);
        let mut low = 0;
        std::array::from_fn(|i| {
            let end = n.prefix.saturating_add((i as u64 + 1) << shift);
            let high = keys.partition_point(|&k| k < end);
            let octant = range.start + low..range.start + high;
            low = high;
            self.measure.of(octant)
        })
    }

    /// Whether a camera path met the node, or nobody said what cameras see.
    pub fn is_seen(&self, node: u32) -> bool {
        let n = &self.nodes[node as usize];
        if self.seen.is_empty() || self.seen_level == 0 {
            return true;
        }
        if n.level <= self.seen_level {
            return !self.range(node, &self.seen).is_empty();
        }
        let shift = self.grid.shift(self.seen_level - 1);
        self.seen
            .binary_search(&(n.prefix >> shift << shift))
            .is_ok()
    }

    /// Path vertices in the node.
    pub fn visits(&self, node: u32) -> u64 {
        let n = &self.nodes[node as usize];
        if n.first != 0 {
            return (n.first..n.first + 8).map(|c| self.visits(c)).sum();
        }
        n.visits_before + n.visits.iter().sum::<u64>()
    }

    /// The leaf that holds the key, at or below a node that does, and the octant of the leaf.
    #[inline]
    pub fn leaf_below(&self, mut node: u32, key: u64) -> (u32, u32) {
        loop {
            let n = &self.nodes[node as usize];
            let octant = self.grid.octant(key, n.level);
            if n.first == 0 {
                return (node, octant);
            }
            node = n.first + octant;
        }
    }

    /// Nodes in preorder: an order that does not depend on the history of splits.
    pub fn preorder(&self) -> Vec<u32> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut stack = vec![0u32];
        while let Some(r) = stack.pop() {
            order.push(r);
            let first = self.nodes[r as usize].first;
            if first != 0 {
                stack.extend((first..first + 8).rev());
            }
        }
        order
    }

    /// How many leaves there are: a division makes seven more.
    pub fn leaf_count(&self) -> usize {
        1 + self.nodes.len() / 8 * 7
    }

    /// The direction that surfaces of a node face; z for the root, for media, and where sides are
    /// not told apart.
    pub fn side(&self, node: u32) -> Vec3 {
        let node = &self.nodes[node as usize];
        match node.level {
            0 => Vec3::Z,
            _ => self.grid.sides.middle(node.prefix >> (3 * AXIS_BITS)),
        }
    }

    pub fn centre(&self, node: u32) -> Vec3 {
        self.grid.centre(&self.nodes[node as usize])
    }

    /// The first of the node's eight children, made if need be.
    pub fn split(&mut self, node: u32) -> u32 {
        let n = self.nodes[node as usize].clone();
        if n.first != 0 {
            return n.first;
        }
        let first = self.nodes.len() as u32;
        let before =
            super::tally::apportion(u128::from(n.visits_before), &n.visits.map(|v| v as f64));
        for (i, inherited) in (0u64..8).zip(before) {
            self.nodes.push(SpaceNode {
                first: 0,
                level: n.level + 1,
                prefix: n.prefix | (i << self.grid.shift(n.level)),
                visits_before: inherited as u64 + n.visits[i as usize],
                visits: [0; 8],
            });
        }
        self.nodes[node as usize].first = first;
        first
    }
}
