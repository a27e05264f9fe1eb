//! Grids of OpenVDB files, as boxes of voxels.
//!
//! A [`Vdb`] has the voxels between the first and the last active one along each axis; inactive ones
//! among them have the value that the file gives them. OpenVDB itself reads the file: see `shim`. This
//! needs the feature `openvdb`.

#[cfg(feature = "openvdb")]
mod shim;

use super::values::BadValues;
use super::vol::MAX_RESOLUTION;
use crate::image::decoded::DecodeLimit;
use crate::math::DAffine3;
use std::io;
use std::path::{Path, PathBuf};

/// A grid of an OpenVDB file.
#[derive(Clone, Debug, PartialEq)]
pub struct Vdb {
    /// Voxels along x, y and z, each 1 to [`MAX_RESOLUTION`].
    pub resolution: [u32; 3],
    /// Values per voxel: 1, or 3 of a grid of vectors.
    pub channels: u32,
    /// Finite and not negative, in the order of [`Vol::values`](super::Vol::values).
    pub values: Vec<f32>,
    /// From the unit cube to the box of the voxels in the file's own world. A voxel reaches half a
    /// step around its centre, which is where OpenVDB's transform puts its whole coordinates. What
    /// comes first where a scene says `use_grid_bbox`, before its own `to_world`.
    pub bbox_transform: DAffine3,
}

/// Why an OpenVDB file is not read.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct VdbError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: VdbProblem,
}

/// What is wrong with an OpenVDB file.
#[derive(Debug, thiserror::Error)]
pub enum VdbProblem {
    /// The program was built without OpenVDB.
    #[error(
        "this twintree reads no OpenVDB files: install Debian's libopenvdb-dev and libboost-dev, \
         and build it with `cargo build --release --features openvdb`"
    )]
    Feature,
    /// It cannot be opened, or is no regular file.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The process that reads it does not start.
    #[error("the process that reads OpenVDB files does not start: {0}")]
    Start(io::Error),
    /// What OpenVDB, or the shim over it, says.
    #[error("{0}")]
    Refused(String),
    /// OpenVDB ended without an answer.
    #[error(
        "OpenVDB was ended while it read this ({0}): the file is damaged, or takes more time or \
         memory than it should"
    )]
    Ended(std::process::ExitStatus),
    /// Too many voxels along an axis.
    #[error(
        "its active voxels lie in a box of {} x {} x {}: each must be 1 to {MAX_RESOLUTION}",
        .0[0], .0[1], .0[2]
    )]
    Resolution([i64; 3]),
    /// Too many voxels for its size.
    #[error("{0}")]
    Limit(String),
    /// Values that are no densities.
    #[error("{0}")]
    Values(BadValues),
}

impl Vdb {
    /// Reads one grid of a file: the one of that name, or without a name the one called `density`,
    /// or else the only one. The memory that its box takes is held against `limit` before it is
    /// taken.
    ///
    /// # Errors
    /// When it is no regular file, is damaged, has no such grid, or one that is no density: a level
    /// set, values that are negative or not finite, a type that is neither float, half, double nor
    /// a vector of these. Or when it is too large, or the feature `openvdb` is off.
    pub fn read(path: &Path, grid: Option<&str>, limit: DecodeLimit) -> Result<Self, VdbError> {
        read(path, grid, limit).map_err(|problem| VdbError {
            path: path.to_owned(),
            problem,
        })
    }
}

#[cfg(feature = "openvdb")]
use shim::read;

#[cfg(not(feature = "openvdb"))]
fn read(_: &Path, _: Option<&str>, _: DecodeLimit) -> Result<Vdb, VdbProblem> {
    Err(VdbProblem::Feature)
}
