//! The links of a field whose P divides directions: many a cell, shared by the cells below them.
//!
//! Memory layout. Each node of R that has leaf links owns a *list*: its links sorted by direction,
//! in 16 buckets (one a base direction cell), each bucket with running RGB sums of F. Lists are
//! chained upwards, so a cell of R knows every link of its path. Beside that a cell keeps, per base
//! direction cell, the RGB sum over its whole path and the node of P to enter at; both are what
//! makes a query fast:
//!
//! * sampling picks a base cell, then a list of the path, then a link by binary search in running
//!   sums, then a direction from the link's model;
//! * the density descends P from the entry: typically 2 to 5 steps.
//!
//! Sums are kept for each colour channel and combined with the path's throughput at the query, so
//! the probability of a link is exactly the difference of two combined running sums, the same
//! numbers in `sample` and in `pdf`: rounding cannot make them disagree.

mod build;

use super::links::quadrant;
use super::model::Query;
use super::settings::Product;
use super::space::Grid;
use crate::math::Vec3;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};

/// No list, no parent.
const NONE: u32 = u32::MAX;
/// Base direction cells: those of level 2.
pub(crate) const GROUPS: usize = 16;
/// Longest path: levels 0 to 20 and the one for normals.
const PATH: usize = 24;
/// Bytes of one cell's look-up tables: 16 RGB sums, 16 entries, list and key.
pub(crate) const CELL_BYTES: usize = GROUPS * (12 + size_of::<Entry>()) + 16;

/// Where a cell and base direction enter P.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    node: PackedNode,
    space_level: u8,
    direction_level: u8,
}

/// A node of P in 4 bytes: first child (or slot of the link), and how it divides in the low 2 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PackedNode(u32);

impl PackedNode {
    fn new(first: u32, split: u32) -> Self {
        Self(first << 2 | split)
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub(crate) struct Lists {
    cell_list: Vec<u32>,
    cell_entry: Vec<Entry>,
    /// Per list: the next list up the path, where each group's bucket starts, the end: in one
    /// place, because a query needs both at once.
    lists: Vec<u32>,
    /// Running sums before each slot's link.
    prefix: Vec<Vec3>,
    /// Each slot's direction cell: start code above, level in the low bits.
    cells_q: Vec<u32>,
    /// Each slot's model; empty where models have no parameters.
    model_of: Vec<u32>,
    nodes: Vec<PackedNode>,
    caps: Caps,
}

/// A link as a query meets it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot {
    number: usize,
    pub group: usize,
    pub q: DirectionCell,
    pub model: u32,
}

/// Centres and chord radii of the base direction cells, by component.
#[derive(Clone, Debug)]
pub(crate) struct Caps {
    x: [f32; GROUPS],
    y: [f32; GROUPS],
    z: [f32; GROUPS],
    radius: [f32; GROUPS],
}

impl Caps {
    fn new() -> Self {
        let level = (GROUPS.ilog2() / 2) as u8;
        let mut caps = Self {
            x: [0.0; GROUPS],
            y: [0.0; GROUPS],
            z: [0.0; GROUPS],
            radius: [2.0; GROUPS],
        };
        for g in 0..GROUPS {
            let code = ((g as u64) << (2 * u32::from(CODE_LEVELS - level))) as u32;
            let (c, r) = DirectionCell::containing(code, level).cap();
            (caps.x[g], caps.y[g], caps.z[g], caps.radius[g]) = (c.x, c.y, c.z, r);
        }
        caps
    }

    /// A factor for a base cell and the normal `n`, positive wherever any direction of the cell
    /// lies above the horizon: n.w lies within `radius` of n.centre, and is taken to be uniform
    /// there.
    #[inline]
    fn factor(&self, group: usize, n: Vec3, product: Product) -> f32 {
        let t = n.x * self.x[group] + n.y * self.y[group] + n.z * self.z[group];
        let r = self.radius[group];
        let above = (t + r).clamp(0.0, 2.0 * r);
        match product {
            Product::None => 1.0,
            Product::Horizon => (above / r).min(1.0),
            Product::Cosine => above * above / (4.0 * r) + (t - r).max(0.0),
        }
    }
}

impl Lists {
    /// What the query's normal makes of a base cell, see [`super::Settings::product`].
    #[inline]
    pub fn factor(&self, group: usize, query: &Query) -> f32 {
        let factor = |n| self.caps.factor(group, n, query.product);
        query.normal.map_or(1.0, factor)
    }

    /// A cell's link in a base cell, for a uniform `y` and these weights of the channels: list of
    /// the path, then link of the list.
    #[inline]
    pub fn pick(&self, cell: u32, group: usize, channels: Vec3, y: f32) -> Option<Slot> {
        let mut buckets = [(0usize, 0usize, 0f32); PATH];
        let mut count = 0;
        let mut total = 0.0;
        let mut list = self.cell_list[cell as usize];
        while list != NONE && count < PATH {
            let range = self.bucket(list, group);
            if !range.is_empty() {
                let sum = channels.dot(self.prefix[range.end - 1]);
                total += sum;
                buckets[count] = (range.start, range.end, sum);
                count += 1;
            }
            list = self.next(list);
        }
        let mut t = y * total;
        let mut chosen = None;
        for &(start, end, sum) in &buckets[..count] {
            if sum <= 0.0 {
                continue;
            }
            chosen = Some((start, end, t.min(sum * (1.0 - f32::EPSILON))));
            if t < sum {
                break;
            }
            t -= sum;
        }
        let (start, end, t) = chosen?;
        // The first slot whose running sum after its link exceeds t: that link has mass.
        let after = &self.prefix[start + 1..end];
        let i = after.partition_point(|p| channels.dot(*p) <= t);
        Some(self.slot(start + i.min(after.len() - 1), group))
    }

    /// The link of a cell, of which `key` is a place, that holds a direction.
    #[inline]
    pub fn find(&self, grid: &Grid, cell: u32, key: u64, code: u32) -> Slot {
        let group = (code >> 28) as usize;
        let entry = self.cell_entry[cell as usize * GROUPS + group];
        let (mut space, mut direction) = (entry.space_level, entry.direction_level);
        let mut n = entry.node.0;
        loop {
            let first = n >> 2;
            match n & 3 {
                0 => {
                    let number = first as usize;
                    return Slot {
                        number,
                        group,
                        q: DirectionCell::containing(code, direction),
                        model: self.model(number),
                    };
                }
                1 => {
                    n = self.nodes[(first + grid.octant(key, space)) as usize].0;
                    space += 1;
                }
                _ => {
                    n = self.nodes[(first + quadrant(code, direction)) as usize].0;
                    direction += 1;
                }
            }
        }
    }

    /// F of a link, in units of the field's scale, summed over the channels with these weights.
    #[inline]
    pub fn mass(&self, slot: Slot, channels: Vec3) -> f32 {
        let p = &self.prefix[slot.number..slot.number + 2];
        channels.dot(p[1]) - channels.dot(p[0])
    }

    /// Every link of a cell's path: its direction cell and its F in units of the field's scale.
    pub fn links(&self, cell: u32) -> Vec<(DirectionCell, Vec3)> {
        let mut out = Vec::new();
        let mut list = self.cell_list[cell as usize];
        while list != NONE {
            for group in 0..GROUPS {
                let range = self.bucket(list, group);
                for slot in range.start..range.end.saturating_sub(1) {
                    let f = self.prefix[slot + 1] - self.prefix[slot];
                    out.push((self.slot(slot, group).q, f));
                }
            }
            list = self.next(list);
        }
        out
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.cell_list[..])
            + size_of_val(&self.cell_entry[..])
            + size_of_val(&self.lists[..])
            + size_of_val(&self.prefix[..])
            + size_of_val(&self.cells_q[..])
            + size_of_val(&self.model_of[..])
            + size_of_val(&self.nodes[..])
    }

    #[inline]
    fn bucket(&self, list: u32, group: usize) -> std::ops::Range<usize> {
        let at = list as usize * (GROUPS + 2) + 1 + group;
        let ends = &self.lists[at..at + 2];
        ends[0] as usize..ends[1] as usize
    }

    /// The next list up the path.
    #[inline]
    fn next(&self, list: u32) -> u32 {
        self.lists[list as usize * (GROUPS + 2)]
    }

    #[inline]
    fn slot(&self, number: usize, group: usize) -> Slot {
        let packed = self.cells_q[number];
        Slot {
            number,
            group,
            q: DirectionCell::containing(packed & !0xf, (packed & 0xf) as u8),
            model: self.model(number),
        }
    }

    #[inline]
    fn model(&self, slot: usize) -> u32 {
        self.model_of.get(slot).copied().unwrap_or(0)
    }
}
