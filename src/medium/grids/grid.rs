//! A grid of voxels in space, and the values between them.
//!
//! Conventions of Mitsuba 3's `gridvolume` (`src/volumes/grid.cpp`, and `dr::Texture` of Dr.Jit):
//! the grid fills the unit cube of its own space, which `to_world` places in the scene. Voxel i of
//! n has its centre at (i + 1/2)/n, between centres values are interpolated, and beyond the
//! outermost ones the wrap mode says what comes.

use super::lookup::{Filter, Lookup};
use super::values::{self, BadValues};
use super::vdb::Vdb;
use super::vol::{MAX_RESOLUTION, Vol};
use crate::math::{Affine3A, DAffine3, DVec3, Rgb, Vec3};
use std::sync::Arc;

/// Voxel coordinates are kept below this, so that they fit into integers.
const FAR: f64 = 1e12;

/// Why a grid cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// No voxels along an axis, or too many.
    #[error(
        "a resolution of {} x {} x {}: each must be 1 to {MAX_RESOLUTION}", .0[0], .0[1], .0[2]
    )]
    Resolution([u32; 3]),
    /// Neither grey nor a colour.
    #[error("{0} channels: a density or an albedo has 1 or 3")]
    Channels(u32),
    /// As many values as voxels and channels ask for are not there.
    #[error("{has} values where {needs} are needed")]
    Count {
        /// Values that there are.
        has: usize,
        /// Values that it takes.
        needs: usize,
    },
    /// Values that are no densities.
    #[error("{0}")]
    Values(BadValues),
    /// A grid without volume, or nowhere.
    #[error(
        "its to_world transform cannot be inverted: it has a scale of 0, or a value that is not \
         finite"
    )]
    Transform,
}

/// Values of one or three channels on a grid of voxels.
///
/// A clone shares the values. `Debug` leaves them out: what tells grids apart must look at
/// [`values`](Self::values), too.
#[derive(Clone)]
pub struct Grid {
    resolution: [u32; 3],
    channels: u32,
    values: Arc<Vec<f32>>,
    to_world: Affine3A,
    to_grid: DAffine3,
    lookup: Lookup,
}

impl Grid {
    /// A grid of `resolution` voxels along x, y and z, each 1 to [`MAX_RESOLUTION`], with 1 or 3
    /// `channels`.
    ///
    /// The value of a channel lies at
    /// `((z * resolution y + y) * resolution x + x) * channels + channel`; all are finite and not
    /// negative. `to_world` takes the unit cube to where the grid lies in the scene.
    ///
    /// # Errors
    /// When one of these does not hold, or `to_world` has no inverse.
    pub fn new(
        resolution: [u32; 3],
        channels: u32,
        values: Arc<Vec<f32>>,
        to_world: Affine3A,
        lookup: Lookup,
    ) -> Result<Self, GridError> {
        if !resolution.iter().all(|n| (1..=MAX_RESOLUTION).contains(n)) {
            return Err(GridError::Resolution(resolution));
        }
        if !matches!(channels, 1 | 3) {
            return Err(GridError::Channels(channels));
        }
        let has = values.len();
        let needs = values::count(resolution, channels).unwrap_or(usize::MAX);
        if has != needs {
            return Err(GridError::Count { has, needs });
        }
        values::check(&values, resolution, channels).map_err(GridError::Values)?;
        let wide = DAffine3::from_cols_array(&to_world.to_cols_array().map(f64::from));
        let has_volume = wide.is_finite() && wide.matrix3.determinant() != 0.0;
        let to_grid = has_volume.then(|| wide.inverse());
        Ok(Self {
            resolution,
            channels,
            values,
            to_world,
            to_grid: to_grid
                .filter(DAffine3::is_finite)
                .ok_or(GridError::Transform)?,
            lookup,
        })
    }

    /// The grid of a file. Where the scene says `use_grid_bbox`, `to_world` is the scene's times
    /// [`Vol::bbox_transform`].
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn from_vol(vol: Vol, to_world: Affine3A, lookup: Lookup) -> Result<Self, GridError> {
        let values = Arc::new(vol.values);
        Self::new(vol.resolution, vol.channels, values, to_world, lookup)
    }

    /// The grid of an OpenVDB file. Where the scene says `use_grid_bbox`, `to_world` is the scene's
    /// times [`Vdb::bbox_transform`].
    ///
    /// # Errors
    /// As [`Grid::new`].
    pub fn from_vdb(vdb: Vdb, to_world: Affine3A, lookup: Lookup) -> Result<Self, GridError> {
        let values = Arc::new(vdb.values);
        Self::new(vdb.resolution, vdb.channels, values, to_world, lookup)
    }

    /// Voxels along x, y and z.
    pub fn resolution(&self) -> [u32; 3] {
        self.resolution
    }

    /// 1 or 3.
    pub fn channels(&self) -> u32 {
        self.channels
    }

    /// All values, in the order of [`Grid::new`].
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// From the unit cube to the scene.
    pub fn to_world(&self) -> Affine3A {
        self.to_world
    }

    /// How values between and beyond the centres of voxels are made.
    pub fn lookup(&self) -> Lookup {
        self.lookup
    }

    /// From the scene to the unit cube.
    pub(super) fn to_grid(&self) -> &DAffine3 {
        &self.to_grid
    }

    /// The value at a point of the scene, in the unit of the grid's values; one channel counts for
    /// all three. Beyond the unit cube the wrap mode says what it is.
    pub fn eval(&self, p: Vec3) -> Rgb {
        self.eval_precise(p.as_dvec3()).as_vec3()
    }

    /// The same in double precision.
    pub(super) fn eval_precise(&self, p: DVec3) -> DVec3 {
        self.eval_local(self.to_grid.transform_point3(p))
    }

    /// The value at a point of the grid's own space.
    #[inline]
    pub(super) fn eval_local(&self, p: DVec3) -> DVec3 {
        let size = self.size();
        match self.lookup.filter {
            Filter::Nearest => {
                let voxel = integers((p * size).floor());
                self.voxel(self.index(voxel))
            }
            Filter::Trilinear => {
                let q = (p * size + 0.5).clamp(DVec3::splat(-FAR), DVec3::splat(FAR));
                let floor = q.floor();
                let corners = self.corners(integers(floor));
                self.each_channel(|c| self.between(&corners, c, q - floor))
            }
        }
    }

    /// The voxels whose centres surround cell `cell` of the lattice of centres: cell i lies between
    /// the centres of voxels i - 1 and i. Corner x + 2y + 4z is the upper one along the axes whose
    /// bit is set.
    #[inline]
    pub(super) fn corners(&self, cell: [i64; 3]) -> [usize; 8] {
        let pair = |axis: usize| [cell[axis] - 1, cell[axis]].map(|i| self.wrapped(axis, i));
        let [x, y, z] = [pair(0), pair(1), pair(2)];
        std::array::from_fn(|c| self.at([x[c & 1], y[c >> 1 & 1], z[c >> 2]]))
    }

    /// The index of the voxel with these numbers along the axes; one beyond all values where there
    /// is none.
    #[inline]
    pub(super) fn at(&self, voxel: [Option<usize>; 3]) -> usize {
        let [width, height, _] = self.resolution.map(|n| n as usize);
        match voxel {
            [Some(x), Some(y), Some(z)] => (z * height + y) * width + x,
            _ => self.values.len(),
        }
    }

    /// The index of a voxel, which may lie beyond the grid.
    #[inline]
    pub(super) fn index(&self, voxel: [i64; 3]) -> usize {
        self.at([0, 1, 2].map(|axis| self.wrapped(axis, voxel[axis])))
    }

    /// A voxel's value in one channel; 0 where there is none.
    #[inline]
    pub(super) fn value(&self, voxel: usize, channel: usize) -> f64 {
        let value = self.values.get(voxel * self.channels as usize + channel);
        value.map_or(0.0, |value| f64::from(*value))
    }

    /// A voxel's value in all channels.
    #[inline]
    pub(super) fn voxel(&self, voxel: usize) -> DVec3 {
        self.each_channel(|c| self.value(voxel, c))
    }

    /// What `of` gives for each channel; once for all three where there is only one.
    #[inline]
    pub(super) fn each_channel(&self, of: impl Fn(usize) -> f64) -> DVec3 {
        match self.channels {
            1 => DVec3::splat(of(0)),
            _ => DVec3::new(of(0), of(1), of(2)),
        }
    }

    /// Voxels along the axes, as numbers.
    pub(super) fn size(&self) -> DVec3 {
        DVec3::from_array(self.resolution.map(f64::from))
    }

    /// The voxel along an axis that stands for number `i`; none where there is nothing.
    #[inline]
    pub(super) fn wrapped(&self, axis: usize, i: i64) -> Option<usize> {
        self.lookup.wrap.voxel(i, self.resolution[axis])
    }

    /// The value at the share `t` of the way between the corners.
    #[inline]
    fn between(&self, corners: &[usize; 8], channel: usize, t: DVec3) -> f64 {
        let lerp = |a: f64, b: f64, t: f64| a + (b - a) * t;
        let v = corners.map(|voxel| self.value(voxel, channel));
        let row = |i: usize| lerp(v[i], v[i + 1], t.x);
        let plane = |i: usize| lerp(row(i), row(i + 2), t.y);
        lerp(plane(0), plane(4), t.z)
    }
}

impl std::fmt::Debug for Grid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Grid")
            .field("resolution", &self.resolution)
            .field("channels", &self.channels)
            .field("to_world", &self.to_world)
            .field("lookup", &self.lookup)
            .finish_non_exhaustive()
    }
}

/// Whole numbers as integers; what is not a number counts as 0.
fn integers(q: DVec3) -> [i64; 3] {
    q.to_array().map(|x| x.clamp(-FAR, FAR) as i64)
}
