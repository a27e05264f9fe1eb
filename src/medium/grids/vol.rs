//! Mitsuba's `.vol` files: a box of voxels with 1, 3 or 6 channels.
//!
//! "VOL", the version 3 in a byte, five `i32` (type, resolution along x, y and z, channels), six
//! `f32` (the lowest and the highest corner of the box), then `f32` values, x fastest, the channels
//! of a voxel together; all little-endian (Mitsuba 3, `src/render/volumegrid.cpp`).

use super::values::{self, BadValues};
use crate::math::{Affine3A, Vec3};
use std::io;
use std::path::{Path, PathBuf};

/// Bytes before the first value.
const HEADER: usize = 48;
/// The only version there is.
const VERSION: u8 = 3;
/// The type of values that Mitsuba writes and reads.
const FLOAT32: i32 = 1;
/// The most voxels along an axis. The steps of a ray are bounded by their number.
pub const MAX_RESOLUTION: u32 = 1 << 16;

/// The contents of a `.vol` file.
#[derive(Clone, Debug, PartialEq)]
pub struct Vol {
    /// Voxels along x, y and z, each 1 to [`MAX_RESOLUTION`].
    pub resolution: [u32; 3],
    /// Values per voxel: 1, 3 or 6.
    pub channels: u32,
    /// The lowest and the highest corner of the box that the file asks for, in its own unit of
    /// length.
    pub bbox: [Vec3; 2],
    /// Finite and not negative; the value of a channel lies at
    /// `((z * resolution y + y) * resolution x + x) * channels + channel`.
    pub values: Vec<f32>,
}

/// Why a `.vol` file is not read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct VolError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: VolProblem,
}

/// What is wrong with a `.vol` file.
#[derive(Debug, thiserror::Error)]
pub enum VolProblem {
    /// It cannot be opened, read or written.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// It is something else.
    #[error("this is no .vol file: it does not begin with \"VOL\"")]
    Magic,
    /// A version that nobody has defined.
    #[error("version {0} of .vol files is not read, only 3")]
    Version(u8),
    /// Values other than `f32`.
    #[error("type {0} is not read, only float32 (type 1)")]
    Type(i32),
    /// No voxels along an axis, or too many.
    #[error(
        "a resolution of {} x {} x {}: each must be 1 to {MAX_RESOLUTION}", .0[0], .0[1], .0[2]
    )]
    Resolution([i32; 3]),
    /// A number of channels that Mitsuba does not know.
    #[error("{0} channels are not read, only 1, 3 or 6")]
    Channels(i32),
    /// More values than can be addressed.
    #[error("{} x {} x {} voxels do not fit into memory", .0[0], .0[1], .0[2])]
    TooLarge([u32; 3]),
    /// Fewer bytes than the header promises, or than a header has.
    #[error("it is cut short: it has {has} bytes and needs {needs}")]
    Short {
        /// Bytes that there are.
        has: usize,
        /// Bytes that it takes.
        needs: usize,
    },
    /// Values that are no densities.
    #[error("{0}")]
    Values(BadValues),
    /// A box that cannot hold the grid.
    #[error("its box, {} to {}, is empty or not finite", .0[0], .0[1])]
    Bbox([Vec3; 2]),
    /// As many values as voxels and channels ask for are not there, on writing.
    #[error("{has} values to write where {needs} are needed")]
    Count {
        /// Values that there are.
        has: usize,
        /// Values that it takes.
        needs: usize,
    },
}

impl Vol {
    /// Reads a file as a whole. What follows the last value is ignored, as by Mitsuba.
    ///
    /// # Errors
    /// When it is no regular file, cannot be read, or does not hold what its header says.
    pub fn read(path: &Path) -> Result<Self, VolError> {
        read_regular(path)
            .map_err(VolProblem::from)
            .and_then(|bytes| Self::parse(&bytes))
            .map_err(|problem| VolError {
                path: path.to_owned(),
                problem,
            })
    }

    /// The grid in the bytes of a file. Allocates no more than they take.
    ///
    /// # Errors
    /// When they do not hold what their header says.
    pub fn parse(bytes: &[u8]) -> Result<Self, VolProblem> {
        let (resolution, channels) = read_header(bytes)?;
        let count = values::count(resolution, channels);
        let needs = count.and_then(|n| n.checked_mul(4)?.checked_add(HEADER));
        let needs = needs.ok_or(VolProblem::TooLarge(resolution))?;
        let has = bytes.len();
        let data = bytes.get(HEADER..needs);
        let data = data.ok_or(VolProblem::Short { has, needs })?;
        let values: Vec<f32> = floats(data).collect();
        values::check(&values, resolution, channels).map_err(VolProblem::Values)?;
        let corners: Vec<f32> = floats(&bytes[HEADER - 24..HEADER]).collect();
        Ok(Self {
            resolution,
            channels,
            bbox: [
                Vec3::from_slice(&corners[..3]),
                Vec3::from_slice(&corners[3..]),
            ],
            values,
        })
    }

    /// Writes a file.
    ///
    /// # Errors
    /// When the values are not as many as voxels and channels ask for, or writing fails.
    pub fn write(&self, path: &Path) -> Result<(), VolError> {
        self.bytes()
            .and_then(|bytes| Ok(std::fs::write(path, bytes)?))
            .map_err(|problem| VolError {
                path: path.to_owned(),
                problem,
            })
    }

    /// The bytes of a file.
    ///
    /// # Errors
    /// When the values are not as many as voxels and channels ask for.
    pub fn bytes(&self) -> Result<Vec<u8>, VolProblem> {
        let has = self.values.len();
        let needs = values::count(self.resolution, self.channels);
        let needs = needs.ok_or(VolProblem::TooLarge(self.resolution))?;
        if has != needs {
            return Err(VolProblem::Count { has, needs });
        }
        let mut bytes = Vec::with_capacity(HEADER + 4 * has);
        bytes.extend_from_slice(b"VOL");
        bytes.push(VERSION);
        bytes.extend(FLOAT32.to_le_bytes());
        let [x, y, z] = self.resolution;
        for n in [x, y, z, self.channels] {
            bytes.extend(n.to_le_bytes());
        }
        let corners = self.bbox.iter().flat_map(Vec3::to_array);
        for v in corners.chain(self.values.iter().copied()) {
            bytes.extend(v.to_le_bytes());
        }
        Ok(bytes)
    }

    /// From the unit cube to the file's box: what comes first where a scene says
    /// `use_grid_bbox`, before its own `to_world`.
    ///
    /// # Errors
    /// When the box is empty along an axis or not finite.
    pub fn bbox_transform(&self) -> Result<Affine3A, VolProblem> {
        let [low, high] = self.bbox;
        let size = high - low;
        if !(low.is_finite() && size.is_finite() && size.min_element() > 0.0) {
            return Err(VolProblem::Bbox(self.bbox));
        }
        Ok(Affine3A::from_translation(low) * Affine3A::from_scale(size))
    }
}

/// Resolution and channels.
fn read_header(bytes: &[u8]) -> Result<([u32; 3], u32), VolProblem> {
    if !bytes.starts_with(b"VOL") {
        return Err(VolProblem::Magic);
    }
    let short = VolProblem::Short {
        has: bytes.len(),
        needs: HEADER,
    };
    let header = bytes.get(..HEADER).ok_or(short)?;
    if header[3] != VERSION {
        return Err(VolProblem::Version(header[3]));
    }
    let int = |i: usize| i32::from_le_bytes(std::array::from_fn(|b| header[4 + 4 * i + b]));
    if int(0) != FLOAT32 {
        return Err(VolProblem::Type(int(0)));
    }
    let resolution = [int(1), int(2), int(3)];
    if !resolution
        .iter()
        .all(|n| (1..=MAX_RESOLUTION as i32).contains(n))
    {
        return Err(VolProblem::Resolution(resolution));
    }
    if !matches!(int(4), 1 | 3 | 6) {
        return Err(VolProblem::Channels(int(4)));
    }
    let channels = int(4).unsigned_abs();
    Ok((resolution.map(i32::unsigned_abs), channels))
}

fn floats(bytes: &[u8]) -> impl Iterator<Item = f32> + '_ {
    bytes
        .chunks_exact(4)
        .map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]]))
}

/// The bytes of a regular file; a pipe may never end.
fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    if !std::fs::metadata(path)?.is_file() {
        let message = "it is not a regular file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, message));
    }
    std::fs::read(path)
}
