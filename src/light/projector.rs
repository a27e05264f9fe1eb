//! A slide projector (Mitsuba 3's `projector`, pbrt's `projection`): a pinhole camera run backwards.
//!
//! The slide's value is the irradiance on the plane one unit in front of the pinhole, times pi, so
//! the intensity in a direction at angle theta off the axis is `pi value scale / cos^3 theta`. pbrt's
//! values are intensities instead.

use super::cluster::Cluster;
use super::description::Slide;
use super::incident::DeltaIncident;
use super::point::incident_from;
use crate::math::rgb::selection_weight;
use crate::math::{Affine3A, Mat3, Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};
use std::f32::consts::PI;

/// A projector.
#[derive(Clone, Debug)]
pub(super) struct Projector {
    pub position: Vec3,
    pub to_world: Mat3,
    to_local: Mat3,
    slide: Texture,
    values: Slide,
    scale: f32,
    /// Half the slide's width and height at distance 1.
    half: Vec2,
}

impl Projector {
    /// `fov_degrees` spans the slide's width; `aspect` is its width over its height.
    pub fn new(
        to_world: Affine3A,
        (slide, values): (Texture, Slide),
        scale: f32,
        [fov_degrees, aspect]: [f32; 2],
    ) -> Self {
        let half_width = (0.5 * fov_degrees.to_radians()).tan();
        let m = Mat3::from(to_world.matrix3);
        Self {
            position: to_world.translation.into(),
            to_world: m,
            to_local: m.inverse(),
            slide,
            values,
            scale,
            half: Vec2::new(half_width, half_width / aspect),
        }
    }

    /// Area of the slide at distance 1.
    pub fn slide_area(&self) -> f32 {
        4.0 * self.half.x * self.half.y
    }

    /// The local direction, at distance 1 along the axis, through a place of the slide.
    pub fn through(&self, uv: Vec2) -> Vec3 {
        let at = self.half * (Vec2::ONE - uv * 2.0);
        at.extend(1.0)
    }

    /// Irradiance that leaves through a place of the slide, at distance 1.
    pub fn slide(&self, uv: Vec2) -> Rgb {
        let value = self.slide.eval(&SurfacePoint::at_uv(uv)) * self.scale;
        match self.values {
            Slide::Irradiance => value * PI,
            Slide::Intensity => value * self.through(uv).length_recip().powi(3),
        }
    }

    /// Power per solid angle in a local direction (any length).
    pub fn intensity(&self, local: Vec3) -> Rgb {
        if local.z <= 0.0 {
            return Rgb::ZERO;
        }
        let at = Vec2::new(local.x, local.y) / (local.z * self.half);
        let uv = (Vec2::ONE - at) * 0.5;
        if uv.cmplt(Vec2::ZERO).any() || uv.cmpgt(Vec2::ONE).any() {
            return Rgb::ZERO;
        }
        let cos = local.z / local.length();
        self.slide(uv) / (cos * cos * cos)
    }

    pub fn cluster(&self) -> Cluster {
        let axis = (self.to_world * Vec3::Z).normalize_or_zero();
        let strength = selection_weight(self.slide.mean()) * PI * self.scale;
        Cluster {
            cos_spread: 1.0 / (1.0 + self.half.length_squared()).sqrt(),
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
