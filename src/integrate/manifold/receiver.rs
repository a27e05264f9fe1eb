//! Receivers: the rough vertices where specular chains end.

use super::guess::Guess;
use crate::accel::Ray;
use crate::bsdf::Bsdf;
use crate::math::Vec3;
use crate::math::offset::offset_origin;
use crate::texture::SurfacePoint;

/// A rough vertex.
#[derive(Clone, Copy, Debug)]
pub struct Receiver {
    /// Where, world space.
    pub position: Vec3,
    error: Vec3,
    ng: Vec3,
    /// The side that light counts from; zero: both.
    side: Vec3,
}

/// A rough vertex that a path has left, and how.
#[derive(Clone, Copy, Debug)]
pub struct LastRoughVertex {
    /// Where.
    pub receiver: Receiver,
    /// The direction in which it left.
    pub dir: Vec3,
    /// The density of that, solid angle.
    pub pdf: f32,
    /// The probability with which a chain was sampled there.
    pub probability: f32,
}

impl Receiver {
    /// That of a vertex.
    pub fn new(point: &SurfacePoint, bsdf: &Bsdf, wo: Vec3) -> Self {
        Self {
            position: point.p,
            error: point.error,
            ng: point.ng,
            side: bsdf.light_normal(wo),
        }
    }

    /// A ray that leaves it.
    pub(super) fn ray(&self, dir: Vec3) -> Ray {
        Ray::new(offset_origin(self.position, self.error, self.ng, dir), dir)
    }

    /// How likely a guess is to be drawn here, relative to others.
    #[inline]
    pub(super) fn weight(&self, guess: &Guess) -> f32 {
        let behind =
            self.side != Vec3::ZERO && self.side.dot(guess.seen_from(self.position)) <= 0.0;
        if behind { 0.0 } else { guess.weight() }
    }
}
