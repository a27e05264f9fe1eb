//! Skies and suns.

use super::SunSky;
use super::distant::Distant;
use crate::math::Affine3A;

/// The sky and the sun as distant lights.
pub(super) fn distant(_settings: &SunSky, _scale: f32, _to_world: &Affine3A) -> Vec<Distant> {
    unimplemented!()
}
