//! The frozen field: *sample* and its density.
//!
//! Memory layout. Each node of R that has leaf links owns a *list*: its links sorted by direction,
//! in up to 16 buckets (one a base direction cell), each bucket with running RGB sums of F. Lists are
//! chained upwards, so a cell of R knows every link of its path. Beside that a cell keeps, per base
//! direction cell, the RGB sum over its whole path and the node of P to enter at; both are what makes
//! a query fast:
//!
//! * [`Field::at`] finds the cell (one descent of R) and weights 16 base cells by throughput and
//!   normal;
//! * sampling picks a base cell, then a list of the path, then a link by binary search in running
//!   sums, then a direction from the link's model;
//! * the density descends P from the entry: typically 2 to 5 steps.
//!
//! Sums are kept for each colour channel and combined with the path's throughput at the query, so
//! the probability of a link is exactly the difference of two combined running sums, the same
//! numbers in `sample` and in `pdf`: rounding cannot make them disagree.

use super::model::FrozenSet;
use super::query::LocalField;
use super::settings::{Product, Settings};
use super::space::Grid;
use super::train::Trainer;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use crate::math::{Rgb, Vec3};

/// No list, no parent.
pub(crate) const NONE: u32 = u32::MAX;
/// Base direction cells of the finest base level.
pub(crate) const GROUPS: usize = 16;
/// Bytes of one cell's look-up tables: 16 RGB sums, 16 entries, list and key.
pub(crate) const CELL_BYTES: usize = GROUPS * (12 + size_of::<Entry>()) + 16;

/// Where a cell and base direction enter P.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Entry {
    pub node: Node,
    pub space_level: u8,
    pub direction_level: u8,
}

/// A node of P in 4 bytes: first child (or slot of the link), and how it divides in the low 2 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Node(pub u32);

impl Node {
    pub fn new(first: u32, split: u32) -> Self {
        Self(first << 2 | split)
    }
}

/// An immutable learned field. Cheap to share between threads; made by [`Trainer::freeze`].
#[derive(Clone, Debug)]
pub struct Field {
    pub(crate) grid: Grid,
    pub(crate) groups: usize,
    pub(crate) scale: f64,
    pub(crate) defensive: f32,
    pub(crate) product: Product,
    /// Per node of R: first child, or the marked number of a cell.
    pub(crate) space: Vec<u32>,
    pub(crate) cell_list: Vec<u32>,
    pub(crate) cell_key: Vec<u64>,
    /// Per cell: all groups' red, then green, then blue.
    pub(crate) cell_flux: Vec<f32>,
    pub(crate) cell_entry: Vec<Entry>,
    /// Per list: the next list up the path, where each group's bucket starts, the end: in one place,
    /// because a query needs both at once.
    pub(crate) lists: Vec<u32>,
    /// Running sums before each slot's link.
    pub(crate) prefix: Vec<Vec3>,
    /// Each slot's direction cell: start code above, level in the low bits.
    cells_q: Vec<u32>,
    pub(crate) model_of: Vec<u32>,
    pub(crate) models: FrozenSet,
    pub(crate) nodes: Vec<Node>,
    pub(crate) caps: Caps,
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
    fn new(groups: usize) -> Self {
        let level = (groups.ilog2() / 2) as u8;
        let mut caps = Self {
            x: [0.0; GROUPS],
            y: [0.0; GROUPS],
            z: [0.0; GROUPS],
            radius: [2.0; GROUPS],
        };
        for g in 0..groups {
            let code = ((g as u64) << (2 * u32::from(CODE_LEVELS - level))) as u32;
            let (c, r) = DirectionCell::containing(code, level).cap();
            (caps.x[g], caps.y[g], caps.z[g], caps.radius[g]) = (c.x, c.y, c.z, r);
        }
        caps
    }

    /// Per base cell a factor for the normal `n`, positive wherever any direction of the cell lies
    /// above the horizon: n.w lies within `radius` of n.centre, and is taken to be uniform there.
    pub fn factors(&self, n: Vec3, product: Product) -> [f32; GROUPS] {
        std::array::from_fn(|g| {
            let t = n.x * self.x[g] + n.y * self.y[g] + n.z * self.z[g];
            let r = self.radius[g];
            let above = (t + r).clamp(0.0, 2.0 * r);
            match product {
                Product::None => 1.0,
                Product::Horizon => (above / r).min(1.0),
                Product::Cosine => above * above / (4.0 * r) + (t - r).max(0.0),
            }
        })
    }
}

impl Field {
    pub(crate) fn empty(trainer: &Trainer, groups: usize, scale: f64) -> Self {
        let settings: &Settings = &trainer.settings;
        Self {
            grid: trainer.space.grid,
            groups,
            scale,
            defensive: settings.defensive,
            product: settings.product,
            space: Vec::with_capacity(trainer.space.nodes.len()),
            cell_list: Vec::new(),
            cell_key: Vec::new(),
            cell_flux: Vec::new(),
            cell_entry: Vec::new(),
            lists: Vec::new(),
            prefix: Vec::new(),
            cells_q: Vec::new(),
            model_of: Vec::new(),
            models: FrozenSet::Constant(Vec::new()),
            nodes: Vec::new(),
            caps: Caps::new(groups),
        }
    }

    pub(crate) fn push_slot(&mut self, prefix: Vec3, q: DirectionCell, model: u32) {
        self.prefix.push(prefix);
        self.cells_q.push(q.start() | u32::from(q.level()));
        self.model_of.push(model);
    }

    pub(crate) fn set_slot(&mut self, slot: u32, q: DirectionCell, model: u32) {
        // Levels up to 10 leave the 12 lowest bits of a start code free.
        self.cells_q[slot as usize] = q.start() | u32::from(q.level());
        self.model_of[slot as usize] = model;
    }

    pub(crate) fn leaf_mark(cell: usize) -> u32 {
        cell as u32 | 0x8000_0000
    }

    #[inline]
    pub(crate) fn bucket(&self, list: u32, group: usize) -> std::ops::Range<usize> {
        let at = list as usize * (self.groups + 2) + 1 + group;
        let ends = &self.lists[at..at + 2];
        ends[0] as usize..ends[1] as usize
    }

    /// The next list up the path.
    #[inline]
    pub(crate) fn next(&self, list: u32) -> u32 {
        self.lists[list as usize * (self.groups + 2)]
    }

    pub(crate) fn chain(&mut self, list: u32, next: u32) {
        self.lists[list as usize * (self.groups + 2)] = next;
    }

    pub(crate) fn bucket_total(&self, range: &std::ops::Range<usize>) -> Vec3 {
        if range.is_empty() {
            return Vec3::ZERO;
        }
        self.prefix[range.end - 1]
    }

    #[inline]
    pub(crate) fn cell_of_key(&self, key: u64) -> u32 {
        let mut n = self.space[0];
        let mut level = 0;
        while n & 0x8000_0000 == 0 {
            n = self.space[(n + self.grid.octant(key, level)) as usize];
            level += 1;
        }
        n & 0x7fff_ffff
    }

    /// The number of the cell of R that holds a point, below [`Field::cell_count`]. The normal only
    /// matters for fields split by normals.
    #[inline]
    pub fn cell(&self, position: Vec3, normal: Vec3) -> u32 {
        self.cell_of_key(self.grid.key(position, normal))
    }

    /// Cells of R (its leaves).
    pub fn cell_count(&self) -> u32 {
        self.cell_list.len() as u32
    }

    /// The distribution of light at a point.
    ///
    /// `normal` (unit), where given, keeps samples above its horizon as [`Settings::product`] says.
    /// A field split by normals needs it to find the right cell.
    /// `throughput` weights the colours: light that the path's throughput would absorb is not looked
    /// for; pass white when unsure. Neither changes which directions are possible, only how likely.
    #[inline]
    pub fn at(&self, position: Vec3, normal: Option<Vec3>, throughput: Rgb) -> LocalField<'_> {
        let side = normal.unwrap_or(Vec3::Z);
        LocalField::new(self, position, side, normal, throughput)
    }

    /// The same for a surface whose side `side` is known while light may reach it from beyond its
    /// `horizon`, too (a leaf, frosted glass): then pass no horizon.
    #[inline]
    pub fn at_side(
        &self,
        position: Vec3,
        side: Vec3,
        horizon: Option<Vec3>,
        throughput: Rgb,
    ) -> LocalField<'_> {
        LocalField::new(self, position, side, horizon, throughput)
    }

    /// Bytes of the frozen field.
    pub fn bytes(&self) -> u64 {
        let of = |n: usize, size: usize| (n * size) as u64;
        of(self.space.len(), 4)
            + of(self.cell_list.len(), 12)
            + of(self.cell_flux.len(), 4)
            + of(self.cell_entry.len(), size_of::<Entry>())
            + of(self.lists.len() + self.model_of.len(), 4)
            + of(self.prefix.len(), 16)
            + of(self.nodes.len(), 4)
            + self.models.bytes() as u64
    }
}

impl Field {
    #[inline]
    pub(crate) fn slot(&self, slot: usize) -> (DirectionCell, u32) {
        let packed = self.cells_q[slot];
        let q = DirectionCell::containing(packed & !0xf, (packed & 0xf) as u8);
        (q, self.model(slot))
    }

    #[inline]
    pub(crate) fn model(&self, slot: usize) -> u32 {
        if self.model_of.is_empty() {
            return 0;
        }
        self.model_of[slot]
    }
}
