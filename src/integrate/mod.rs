//! Path tracing.
//!
//! # One sample, from camera to film
//!
//! 1. [`render`](render::render) repeats passes of samples over the film until a limit is reached
//!    ([`progress::Limits`]).
//! 2. `tiles.rs`: a tile of a pass is one task. Its samples travel together as a wave.
//! 3. [`camera_sample`] starts a path: pixel, filter, lens, random numbers.
//! 4. [`wave`] advances all paths by one bounce at a time, so that the ray tracer gets rays in
//!    bulk.
//! 5. `bounce.rs`: what a ray met; `features.rs`: what a denoiser is told of it; `emission.rs`: its
//!    light, weighed by multiple importance sampling; `recording.rs`: what else a film wants to
//!    know.
//! 6. `scatter.rs`: plain path tracing at a vertex: emitter sampling (`next_event.rs`), BSDF
//!    sampling, Russian roulette ([`roulette`]); `direction.rs`: the next ray.
//!
//! A guided path has more state ([`guided_path`]) and scatters otherwise (`guided_scatter.rs`,
//! `guided_direction.rs`): the field shapes directions ([`guided_vertex`]), paths are split by what they
//! are worth (`splitting.rs`) and among lobes (`lobe_splitting.rs`), specular chains are sampled
//! ([`manifold`]), and pixels share suffixes ([`reuse`]). [`training`] learns the field from the
//! image's first passes, [`adaptive`] spreads the samples of the later ones. [`debug`] looks into
//! single samples and points.
//!
//! # Decisions that rest on samples
//!
//! A decision must not share random numbers with what it decides about; otherwise the mean is
//! biased.
//! - Field, mixture fractions, rates of light samples and of manifold next-event estimation:
//!   learned in earlier iterations. Each iteration has Sobol sequences of its own
//!   ([`camera_sample::Iteration`]).
//! - Paths a pixel takes ([`adaptive`]): told by earlier iterations, too. An iteration counts in
//!   each pixel for a number of samples that is fixed before it begins.
//! - Roulette and splitting: go by the field and by what the path has met so far, and make up for
//!   their chances; what comes behind is not known to them.
//! - Whether guiding pays ([`training::trial`]): told by paths that are thrown away.
//! - Groups for sharing ([`reuse`]): drawn by the numbers of pixel and sample alone.
//! - When to stop ([`progress::Limits`]): `--noise` and `--time` look at the samples that are kept.
//!   That is optional stopping. A pixel's share in the noise, or the time, of the whole image is
//!   small, and so is what it can do to its own mean.
//!
//! tests/unbiased.rs holds each of them to the mean of hundreds of small renders.
//!
//! Each sample's numbers come from `(seed, pixel, sample)` alone and each pixel's sum is taken in
//! sample order, so neither the tiles nor the threads can change a bit of the image.

pub mod adaptive;
mod bounce;
pub mod camera_sample;
mod context;
pub mod debug;
mod direction;
mod emission;
mod equiangular;
mod features;
mod guided_direction;
pub mod guided_path;
mod guided_scatter;
pub mod guided_vertex;
pub mod guiding;
pub mod light_sums;
mod lobe_splitting;
pub mod manifold;
mod media;
mod next_event;
pub mod observer;
pub mod path;
pub mod progress;
mod recording;
pub mod render;
pub mod reuse;
pub mod roulette;
mod scatter;
mod settings;
mod shadows;
mod splitting;
mod tiles;
pub mod training;
mod vertex;
pub mod wave;

#[cfg(test)]
mod tests;

pub use context::{PathContext, View};
pub use settings::{GuidedSettings, PathSettings, Roulette};
