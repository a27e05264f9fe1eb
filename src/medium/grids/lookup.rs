//! How values are made of the voxels around a point.

/// What lies between the centres of voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    /// Linear interpolation along three axes.
    #[default]
    Trilinear,
    /// The value of the voxel that the point lies in.
    Nearest,
}

/// What lies beyond the grid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// The value at the border.
    #[default]
    Clamp,
    /// The grid again.
    Repeat,
    /// The grid again, every other one mirrored.
    Mirror,
    /// Nothing: 0. Towards the border, beyond the outermost centres, values fall to half (pbrt).
    Zero,
}

/// How values between and beyond the centres of voxels are made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lookup {
    /// Between them.
    pub filter: Filter,
    /// Beyond them.
    pub wrap: Wrap,
}

impl Wrap {
    /// The voxel of `count` that stands for number `i`; none where there is nothing.
    #[inline]
    pub(super) fn voxel(self, i: i64, count: u32) -> Option<usize> {
        let n = i64::from(count);
        let inside = match self {
            _ if (0..n).contains(&i) => i,
            Self::Clamp => i.clamp(0, n - 1),
            Self::Repeat => i.rem_euclid(n),
            Self::Mirror => {
                let twice = i.rem_euclid(2 * n);
                twice.min(2 * n - 1 - twice)
            }
            Self::Zero => return None,
        };
        Some(inside as usize)
    }
}
