//! The frozen field: *sample* and its density.
//!
//! [`Field::at`] finds the cell of R that holds a point. Where P divides space alone, as with
//! mixtures, a cell is one link over all directions: its flux and its model stand at the cell's
//! number. Where P divides directions, too, the cell's flux is kept by base direction cell, and its
//! links are found through [`Lists`].

use super::cells::Cells;
use super::link_index::{GROUPS, Lists};
use super::model::FrozenSet;
use super::settings::Product;
use super::space::Grid;
use crate::math::Vec3;

/// An immutable learned field. Cheap to share between threads; made by
/// [`Trainer::freeze`](super::Trainer::freeze).
#[derive(Clone, Debug)]
pub struct Field {
    pub(crate) grid: Grid,
    pub(crate) scale: f64,
    pub(crate) defensive: f32,
    pub(crate) product: Product,
    /// Per node of R: first child, or the marked number of a cell.
    pub(crate) space: Vec<u32>,
    pub(crate) cell_key: Vec<u64>,
    /// Per cell: all groups' red, then green, then blue.
    pub(crate) cell_flux: Vec<f32>,
    /// The links, where a cell has several.
    pub(crate) lists: Option<Lists>,
    /// The links' models; of the cells, where each is one link.
    pub(crate) models: FrozenSet,
}

/// In [`Field::space`], a leaf; the rest is the cell's number.
pub(crate) const LEAF: u32 = 1 << 31;

impl Field {
    #[inline]
    pub(crate) fn cell_of_key(&self, key: u64) -> u32 {
        let mut n = self.space[0];
        let mut level = 0;
        while n & LEAF == 0 {
            n = self.space[(n + self.grid.octant(key, level)) as usize];
            level += 1;
        }
        n & !LEAF
    }

    /// The number of the cell of R that holds a point, below [`Field::cell_count`]. The normal only
    /// matters for fields split by normals.
    #[inline]
    pub fn cell(&self, position: Vec3, normal: Vec3) -> u32 {
        self.cell_of_key(self.grid.key(position, normal))
    }

    /// Cells of R (its leaves).
    pub fn cell_count(&self) -> u32 {
        self.cell_key.len() as u32
    }

    /// The flux of a cell, in units of the field's scale: all groups' red, green, blue.
    #[inline]
    pub(crate) fn flux(&self, cell: u32) -> [&[f32]; 3] {
        let groups = if self.lists.is_some() { GROUPS } else { 1 };
        let flux = &self.cell_flux[cell as usize * 3 * groups..][..3 * groups];
        let (r, rest) = flux.split_at(groups);
        let (g, b) = rest.split_at(groups);
        [r, g, b]
    }

    /// Bytes of the frozen field.
    pub fn bytes(&self) -> u64 {
        let bytes = size_of_val(&self.space[..])
            + size_of_val(&self.cell_key[..])
            + size_of_val(&self.cell_flux[..])
            + self.lists.as_ref().map_or(0, Lists::bytes)
            + self.models.bytes();
        bytes as u64
    }
}

impl Cells for Field {
    fn cell(&self, position: Vec3, normal: Vec3) -> u32 {
        self.cell(position, normal)
    }

    fn cell_count(&self) -> u32 {
        self.cell_count()
    }

    fn parts_of(&self, coarser: &Self) -> Vec<u32> {
        let part_of = |&key: &u64| coarser.cell_of_key(key);
        self.cell_key.iter().map(part_of).collect()
    }

    fn bytes(&self) -> u64 {
        self.bytes()
    }
}
