//! Who watches paths while they travel.

use super::manifold::ManifoldSample;
use super::path::Arrival;
use crate::accel::Hit;
use crate::guide::LightChoice;
use crate::light::LightSource;
use crate::math::{Rgb, Vec3};
use crate::texture::SurfacePoint;

/// Watches paths while they travel. `()` watches nothing and costs nothing.
pub trait PathObserver {
    /// A path from the camera has met its first surface, or nothing. Samples come in their order.
    #[inline]
    fn sees(&mut self, met: Option<(&SurfacePoint, &Hit)>) {
        let _ = met;
    }
    /// Light has come to an accumulator that was scattered `bounces` times.
    #[inline]
    fn shines(&mut self, accumulator: u32, bounces: u32, light: Rgb, from: LightSource) {
        let _ = (accumulator, bounces, light, from);
    }
    /// Whether that is of any interest.
    #[inline]
    fn wants_sources(&self) -> bool {
        false
    }
    /// Whether [`PathObserver::depart`] is to be called for this path.
    #[inline]
    fn wants(&self, accumulator: u32) -> bool {
        let _ = accumulator;
        false
    }
    /// A path reached its next vertex, or left the scene; `radiance` is what it came to so far.
    #[inline]
    fn arrive(&mut self, accumulator: u32, radiance: Rgb, distance: f32) {
        let _ = (accumulator, radiance, distance);
    }
    /// A path that it wants to know of goes on from a vertex, or ends there.
    #[inline]
    fn depart(&mut self, accumulator: u32, departure: Departure) {
        let _ = (accumulator, departure);
    }
    /// The light sample of the vertex that the path has just left was not blocked and brought
    /// `radiance`.
    #[inline]
    fn lit(&mut self, accumulator: u32, radiance: Rgb) {
        let _ = (accumulator, radiance);
    }
    /// A path that came so has sampled a specular chain.
    #[inline]
    fn sampled_manifold(&mut self, arrival: &Arrival, sample: &ManifoldSample) {
        let _ = (arrival, sample);
    }
}

impl PathObserver for () {}

/// How a path left a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// The vertex.
    pub position: Vec3,
    /// Unit shading normal, on the side that the path came from; zero at a collision.
    pub normal: Vec3,
    /// How it came.
    pub arrival: Arrival,
    /// The probability with which a light was sampled; `None` if no field was asked or the path was
    /// split.
    pub light_probability: Option<f32>,
    /// Out of which clusters.
    pub light_choice: LightChoice,
    /// Where it went; `None` if it ended here, by roulette or for want of a direction.
    pub direction: Option<SampledDirection>,
}

/// The way on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct SampledDirection {
    /// Unit direction.
    pub direction: Vec3,
    /// Density with which it was drawn, solid angle, of the mixture.
    pub pdf: f32,
    /// Density that the field alone gives it; 0 if it was not asked.
    pub guide_pdf: f32,
    /// Density that the BSDF alone gives it.
    pub bsdf_pdf: f32,
    /// BSDF times cosine over `pdf`.
    pub weight: Rgb,
    /// Chance with which roulette let the path go on.
    pub survival: f32,
    /// Throughput after all of that.
    pub throughput: Rgb,
}
