//! Participating media whose density varies in space: values on a grid, free flights and
//! transmittance through it.
//!
//! [`vol`] reads the grids of Mitsuba's `.vol` files, [`vdb`] those of OpenVDB, [`grid`] gives the values between voxels, and
//! [`heterogeneous`] draws collisions and estimates transmittance. Below them `majorant` bounds the
//! values from above, `walk` leads a ray from cell to cell, `stretch` has exact integrals between
//! voxels, `tracking` follows rays with both, and `balance` decides for three channels at once.
//! Nothing here knows scenes, phase functions or surfaces.

mod balance;
mod draw;
pub mod grid;
pub mod heterogeneous;
mod lookup;
mod majorant;
mod stretch;
mod tracking;
mod values;
pub mod vdb;
pub mod vol;
mod walk;

pub use grid::{Grid, GridError};
pub use heterogeneous::{Albedo, Heterogeneous, MediumError};
pub use lookup::{Filter, Lookup, Wrap};
pub use values::{BadValues, Fault};
pub use vdb::{Vdb, VdbError, VdbProblem};
pub use vol::{Vol, VolError, VolProblem};

#[cfg(test)]
mod tests;
