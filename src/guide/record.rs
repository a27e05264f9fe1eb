//! The records a field learns from, as they come and as they are added up.

use crate::math::{Rgb, Vec3};

/// Light that landed on a surface, or collided in a medium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Photon {
    /// Where it landed.
    pub position: Vec3,
    /// Unit direction towards where the light came from.
    pub direction: Vec3,
    /// Its power in watts, not divided by the number of emitted photons.
    pub power: Rgb,
    /// Distance to where the light left a surface or emitter; infinite for environments.
    pub distance: f32,
    /// Unit shading normal where it landed (either orientation); zero in a medium.
    pub normal: Vec3,
}

/// An estimate of incident radiance at a vertex of a camera path. Vertices that saw no light must
/// be passed too, with radiance 0: they are part of the mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathSample {
    /// The vertex.
    pub position: Vec3,
    /// Unit direction that was sampled from it.
    pub direction: Vec3,
    /// Estimated incident radiance from that direction, W m^-2 sr^-1.
    pub radiance: Rgb,
    /// Solid-angle density with which the direction was sampled.
    pub pdf: f32,
    /// Distance to the next vertex along the direction.
    pub distance: f32,
    /// Unit shading normal at the vertex; zero in a medium.
    pub normal: Vec3,
}

/// A point on a surface: spread uniformly by area to measure A(r), or where a camera path met a
/// surface (or collided in a medium) to mark what the image needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfacePoint {
    /// The point.
    pub position: Vec3,
    /// Unit normal there, or zero in a medium; only used when R tells sides apart.
    pub normal: Vec3,
}

impl SurfacePoint {
    /// A point that is on none.
    pub fn in_medium(position: Vec3) -> Self {
        Self {
            position,
            normal: Vec3::ZERO,
        }
    }
}

/// Where a record came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Origin {
    /// A photon: its flux counts per area.
    Photon = 0,
    /// A camera path: its estimate counts per vertex.
    Path = 1,
}

/// Quanta a unit in the table of sub-fluxes.
pub(crate) const TABLE_QUANTA: f32 = 16.0;

/// A record ready to be added up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Deposit {
    pub position: Vec3,
    pub direction: Vec3,
    pub distance: f32,
    pub key: u64,
    pub code: u32,
    /// The target quantity, clamped, in its own unit.
    pub value: Rgb,
    /// Selection weight in units, at most 2^16.
    pub units: f32,
    /// The same in quanta of the sub-flux table, dithered so that light records are not lost.
    pub table: u32,
}

/// The scalar that decides about splits: the mean of the channels, as errors are measured on RGB.
#[inline]
pub(crate) fn weight(c: Rgb) -> f32 {
    (c.x + c.y + c.z) * (1.0 / 3.0)
}
