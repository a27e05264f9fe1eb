//! How a medium takes light out of a ray: the same everywhere, or by place.

use super::grids::Heterogeneous;
use super::{ChannelWeights, Flight, Homogeneous, Segment};
use crate::math::{Rgb, Vec3};
use std::sync::Arc;

/// Extinction and albedo of a medium.
#[derive(Clone, Debug)]
pub enum Extinction {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// By place.
    Heterogeneous(Arc<Heterogeneous>),
}

impl Extinction {
    /// Draws a collision on the segment, or none. What only absorbs has none: its transmittance is
    /// exact.
    #[inline]
    pub fn sample(
        &self,
        segment: &Segment,
        weights: &mut ChannelWeights,
        u: &mut impl FnMut() -> f32,
    ) -> Flight {
        let (origin, direction, length) = segment.parts();
        match self {
            Self::Homogeneous(medium) => medium.sample(segment, weights, u),
            Self::Heterogeneous(medium) if medium.absorbs_alone() => Flight {
                factor: medium.exact_transmittance(origin, direction, length),
                collision: None,
            },
            Self::Heterogeneous(medium) => {
                medium.sample(origin, direction, length, &mut weights.0, u)
            }
        }
    }

    /// The share of light that comes through the segment: exact, or an unbiased estimate.
    #[inline]
    pub fn transmittance(&self, segment: &Segment, u: &mut impl FnMut() -> f32) -> Rgb {
        let (origin, direction, length) = segment.parts();
        match self {
            Self::Homogeneous(medium) => medium.transmittance(length),
            Self::Heterogeneous(medium) => medium.transmittance(origin, direction, length, u),
        }
    }

    /// The same without noise, which on grids takes as many steps as there are voxels in the way.
    #[inline]
    pub fn exact_transmittance(&self, segment: &Segment) -> Rgb {
        let (origin, direction, length) = segment.parts();
        match self {
            Self::Homogeneous(medium) => medium.transmittance(length),
            Self::Heterogeneous(medium) => medium.exact_transmittance(origin, direction, length),
        }
    }

    /// The coefficient by which light weakens at least on long ways, per unit length; 0 for grids,
    /// whose parts may be empty.
    pub fn least(&self) -> f32 {
        match self {
            Self::Homogeneous(medium) => medium.extinction.min_element(),
            Self::Heterogeneous(_) => 0.0,
        }
    }

    /// The extinction coefficient at a place, per unit length.
    pub fn sigma_t(&self, p: Vec3) -> Rgb {
        match self {
            Self::Homogeneous(medium) => medium.extinction,
            Self::Heterogeneous(medium) => medium.sigma_t(p),
        }
    }

    /// Whether there are collisions: what only absorbs has none.
    pub fn scatters(&self) -> bool {
        match self {
            Self::Homogeneous(medium) => medium.albedo != Rgb::ZERO,
            Self::Heterogeneous(medium) => !medium.absorbs_alone(),
        }
    }

    /// The share of a collision's light that is scattered at a place.
    pub fn albedo(&self, p: Vec3) -> Rgb {
        match self {
            Self::Homogeneous(medium) => medium.albedo,
            Self::Heterogeneous(medium) => medium.albedo(p),
        }
    }
}

impl From<Homogeneous> for Extinction {
    fn from(medium: Homogeneous) -> Self {
        Self::Homogeneous(medium)
    }
}

impl From<Heterogeneous> for Extinction {
    fn from(medium: Heterogeneous) -> Self {
        Self::Heterogeneous(Arc::new(medium))
    }
}
