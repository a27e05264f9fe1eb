//! A point with a cone (Mitsuba 3's and pbrt's `spot`).

use super::cluster::Cluster;
use super::description::Falloff;
use super::incident::DeltaIncident;
use super::point::incident_from;
use crate::math::rgb::selection_weight;
use crate::math::special::smoothstep;
use crate::math::{Mat3, Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};

/// A spot light.
#[derive(Clone, Debug)]
pub(super) struct Spot {
    pub position: Vec3,
    /// Local to world; shines along local +z.
    pub to_world: Mat3,
    to_local: Mat3,
    intensity: Rgb,
    cutoff: f32,
    cos_cutoff: f32,
    cos_beam: f32,
    inv_transition: f32,
    tan_cutoff: f32,
    falloff: Falloff,
    texture: Option<Texture>,
}

impl Spot {
    /// Angles in degrees; the beam is at most as wide as the cutoff.
    pub fn new(
        to_world: crate::math::Affine3A,
        intensity: Rgb,
        [cutoff_degrees, beam_degrees]: [f32; 2],
        falloff: Falloff,
        texture: Option<Texture>,
    ) -> Self {
        let cutoff = cutoff_degrees.clamp(0.0, 180.0).to_radians();
        let beam = beam_degrees.to_radians().clamp(0.0, cutoff);
        let m = Mat3::from(to_world.matrix3);
        Self {
            position: to_world.translation.into(),
            to_world: m,
            to_local: m.inverse(),
            intensity,
            cutoff,
            cos_cutoff: cutoff.cos(),
            cos_beam: beam.cos(),
            // Infinite for equal angles: never used then, because nothing lies between them.
            inv_transition: 1.0 / (cutoff - beam),
            tan_cutoff: cutoff.tan(),
            falloff,
            texture,
        }
    }

    /// `1 - cos` of the cutoff angle.
    pub fn one_minus_cos_cutoff(&self) -> f32 {
        let s = (0.5 * self.cutoff).sin();
        2.0 * s * s
    }

    /// Power per solid angle in a local direction (any length).
    pub fn intensity(&self, local: Vec3) -> Rgb {
        let cos = local.normalize_or_zero().z;
        if cos <= self.cos_cutoff {
            return Rgb::ZERO;
        }
        let falloff = if cos >= self.cos_beam {
            1.0
        } else {
            match self.falloff {
                Falloff::Linear => {
                    ((self.cutoff - cos.acos()) * self.inv_transition).clamp(0.0, 1.0)
                }
                Falloff::Smooth => smoothstep(self.cos_cutoff, self.cos_beam, cos),
            }
        };
        let Some(texture) = &self.texture else {
            return self.intensity * falloff;
        };
        let uv = Vec2::new(local.x, local.y) / (local.z * self.tan_cutoff) * 0.5 + 0.5;
        self.intensity * falloff * texture.eval(&SurfacePoint::at_uv(uv))
    }

    pub fn cluster(&self) -> Cluster {
        let axis = (self.to_world * Vec3::Z).normalize_or_zero();
        let texture = self.texture.as_ref().map_or(Rgb::ONE, Texture::mean);
        let strength = selection_weight(self.intensity * texture);
        Cluster {
            cos_spread: self.cos_cutoff,
            axis,
            ..Cluster::ball(self.position, 0.0, strength)
        }
    }

    #[inline]
    pub fn incident(&self, p: Vec3) -> Option<DeltaIncident> {
        let intensity = self.intensity(self.to_local * (p - self.position));
        if intensity == Rgb::ZERO {
            return None;
        }
        incident_from(self.position, p, intensity)
    }
}
