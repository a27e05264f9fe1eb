//! What fields have in common that divide space into cells.

use crate::math::Vec3;

/// A field over numbered cells of space: what is learned beside it is kept by cell.
pub trait Cells: Sync {
    /// The number of the cell that holds a point on a surface with this normal.
    fn cell(&self, position: Vec3, normal: Vec3) -> u32;
    /// Cells there are.
    fn cell_count(&self) -> u32;
    /// For each cell, the cell of a field that this one refines of which it was part.
    fn parts_of(&self, coarser: &Self) -> Vec<u32>;
    /// Bytes held.
    fn bytes(&self) -> u64;
}
