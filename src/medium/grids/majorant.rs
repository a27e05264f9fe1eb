//! Bounds of a grid's values, cell by cell of a coarser grid, along rays.
//!
//! Delta tracking draws tentative collisions from upper bounds, majorants (Szirmay-Kalos, Toth and
//! Magdics, "Free Path Sampling in High Resolution Inhomogeneous Participating Media", 2011): the
//! closer they are, the fewer of them come to nothing. Lower bounds are what decomposition and
//! residual tracking set apart.

use super::grid::Grid;
use super::lookup::Filter;
use super::walk::{Lattice, Span, Walk};
use crate::math::DVec3;
use rayon::prelude::*;

/// Voxels along the side of a cell, where no limit makes it more.
const VOXELS: u32 = 4;
/// The most cells along an axis.
const MAX_CELLS: u32 = 64;
/// Points that rounding puts into the next cell are covered, too; in voxels.
const MARGIN: f64 = 1e-6;

/// The least and the largest value of a grid in each cell of a coarse one over the unit cube.
#[derive(Clone)]
pub(super) struct Majorants {
    cells: [u32; 3],
    values: Vec<[f32; 2]>,
}

/// A stretch of a ray below one bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounded {
    /// No value is less, in the unit of the grid's values, in any channel.
    pub minorant: f64,
    /// None is more.
    pub majorant: f64,
    /// Length along the span where the stretch begins.
    pub from: f64,
    /// Length where it ends.
    pub to: f64,
}

impl Majorants {
    /// The bounds of `grid`, in cells of four voxels a side, or in 64 cells where there are more
    /// than 256 voxels.
    pub fn new(grid: &Grid) -> Self {
        let cells = grid.resolution().map(|n| n.div_ceil(VOXELS).min(MAX_CELLS));
        let supports: [Vec<Vec<Option<usize>>>; 3] = std::array::from_fn(|axis| {
            let of_cell = |cell| support(grid, axis, cell, cells[axis]);
            (0..cells[axis]).map(of_cell).collect()
        });
        let [width, height, depth] = cells.map(|n| n as usize);
        let values = (0..width * height * depth).into_par_iter().map(|i| {
            let [x, y, z] = [i % width, i / width % height, i / width / height];
            least_and_largest(grid, [&supports[0][x], &supports[1][y], &supports[2][z]])
        });
        Self {
            cells,
            values: values.collect(),
        }
    }

    /// The bounds along a span, from its beginning to its end, without gaps.
    pub fn along<'a>(&'a self, span: &Span) -> impl Iterator<Item = Bounded> + use<'a> {
        let lattice = Lattice {
            cells: self.cells,
            scale: DVec3::from_array(self.cells.map(f64::from)),
            offset: 0.0,
        };
        Walk::new(span, &lattice, 0.0, span.length).map(|step| {
            let [minorant, majorant] = self.of(step.cell);
            Bounded {
                minorant,
                majorant,
                from: step.from,
                to: step.to,
            }
        })
    }

    /// The bounds in a cell.
    #[inline]
    fn of(&self, cell: [i64; 3]) -> [f64; 2] {
        let [x, y, z] = cell.map(|i| i as usize);
        let [width, height, _] = self.cells.map(|n| n as usize);
        self.values[(z * height + y) * width + x].map(f64::from)
    }
}

impl std::fmt::Debug for Majorants {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Majorants")
            .field("cells", &self.cells)
            .finish_non_exhaustive()
    }
}

/// The voxels along an axis that values in cell `cell` of `cells` are made of; none of them where
/// there is nothing.
fn support(grid: &Grid, axis: usize, cell: u32, cells: u32) -> Vec<Option<usize>> {
    let voxels_per_cell = f64::from(grid.resolution()[axis]) / f64::from(cells);
    let low = f64::from(cell) * voxels_per_cell - MARGIN;
    let high = f64::from(cell + 1) * voxels_per_cell + MARGIN;
    let (first, last) = match grid.lookup().filter {
        Filter::Nearest => (low.floor(), high.floor()),
        // The centres on both sides.
        Filter::Trilinear => ((low - 0.5).floor(), (high - 0.5).floor() + 1.0),
    };
    let mut voxels: Vec<Option<usize>> = (first as i64..=last as i64)
        .map(|i| grid.wrapped(axis, i))
        .collect();
    voxels.sort_unstable();
    voxels.dedup();
    voxels
}

/// The least and the largest value over all channels of the voxels at the crossings of three lists.
fn least_and_largest(grid: &Grid, [xs, ys, zs]: [&[Option<usize>]; 3]) -> [f32; 2] {
    let channels = grid.channels() as usize;
    let mut bounds = [f32::INFINITY, 0.0];
    for z in zs {
        for y in ys {
            for x in xs {
                let first = grid.at([*x, *y, *z]) * channels;
                let values = grid.values().get(first..first + channels);
                bounds = values
                    .unwrap_or(&[0.0])
                    .iter()
                    .fold(bounds, |[least, most], &v| [least.min(v), most.max(v)]);
            }
        }
    }
    bounds
}
