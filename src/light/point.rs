//! A point that shines the same in all directions.

use super::cluster::Cluster;
use super::incident::DeltaIncident;
use crate::math::rgb::selection_weight;
use crate::math::{Rgb, Vec3};

/// A point light.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointLight {
    pub position: Vec3,
    /// Power per solid angle.
    pub intensity: Rgb,
}

impl PointLight {
    pub fn cluster(&self) -> Cluster {
        Cluster::ball(self.position, 0.0, selection_weight(self.intensity))
    }

    #[inline]
    pub fn incident(&self, p: Vec3) -> Option<DeltaIncident> {
        incident_from(self.position, p, self.intensity)
    }
}

/// Light of `intensity` from `position`, at `p`. `None` where `p` is on the light.
#[inline]
pub(super) fn incident_from(position: Vec3, p: Vec3, intensity: Rgb) -> Option<DeltaIncident> {
    let to = position - p;
    let d2 = to.length_squared();
    let distance = d2.sqrt();
    let irradiance = intensity / d2;
    // What is too bright for a number is passed on: the sample is left out and counted.
    if distance < f32::MIN_POSITIVE {
        return None;
    }
    Some(DeltaIncident {
        dir: to / distance,
        distance,
        irradiance,
    })
}
