//! A point whose intensity follows an image over directions, as photometers measure lamps (pbrt's
//! `goniometric`).

use super::cluster::Cluster;
use super::incident::DeltaIncident;
use super::latlong::LatLong;
use super::point::incident_from;
use crate::math::rgb::selection_weight;
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::PI;

/// A point light with an image around it.
#[derive(Debug)]
pub(super) struct Goniometric {
    pub position: Vec3,
    /// Power per solid angle by the direction in which the light leaves.
    pub intensity: LatLong,
}

impl Goniometric {
    /// Power in all directions together.
    pub fn power(&self) -> Rgb {
        self.intensity.integral()
    }

    /// A direction in which light leaves, by importance, and the power it stands for.
    pub fn sample(&self, u: Vec2) -> Option<(Vec3, Rgb)> {
        let (dir, patch, pdf) = self.intensity.sample(Vec3::ZERO, u)?;
        Some((dir, self.intensity.radiance_of(&patch) / pdf))
    }

    pub fn cluster(&self) -> Cluster {
        let strength = selection_weight(self.power()) / (4.0 * PI);
        Cluster::ball(self.position, 0.0, strength)
    }

    #[inline]
    pub fn incident(&self, p: Vec3) -> Option<DeltaIncident> {
        let away = (p - self.position).normalize_or_zero();
        let intensity = self.intensity.radiance(away);
        if intensity == Rgb::ZERO {
            return None;
        }
        incident_from(self.position, p, intensity)
    }
}
