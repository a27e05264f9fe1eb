//! Path tracing.
//!
//! [`render`](render::render) cuts the film into tiles and the samples into passes. A tile of a pass is one task: its
//! samples travel together as a [`wave`], one bounce at a time, so that the ray tracer gets rays in
//! bulk (packets) and the same code runs over many vertices in a row. What happens at a vertex
//! (emission, next-event estimation and BSDF sampling joined by multiple importance sampling, Russian
//! roulette) is in [`vertex`]; what is worth more than expected goes on in several ways ([`split_paths`]); what guided paths
//! find is shared among pixels ([`reuse`]), and suns and lamps behind glass and in mirrors are aimed at ([`chain`]).
//!
//! # Decisions that rest on samples
//!
//! A decision must not share random numbers with what it decides about; otherwise the mean is biased.
//! - Field, mixture fractions, chances of light samples and of aiming: learned in earlier iterations.
//!   Each iteration has Sobol sequences of its own ([`start::Iteration`]).
//! - Paths a pixel takes ([`adaptive`]): told by earlier iterations, too. An iteration counts in each
//!   pixel for a number of samples that is fixed before it begins.
//! - Roulette and splitting: go by the field and by what the path has met so far, and make up for their
//!   chances; what comes behind is not known to them.
//! - Whether guiding pays ([`trial`]): told by paths that are thrown away.
//! - Groups for sharing ([`reuse`]): drawn by the numbers of pixel and sample alone.
//! - When to stop ([`render::Limits`]): `--noise` and `--time` look at the samples that are kept. That is
//!   optional stopping. A pixel's share in the noise, or the time, of the whole image is small, and so is
//!   what it can do to its own mean.
//!
//! tests/unbiased.rs holds each of them to the mean of hundreds of small renders.
//!
//! Each sample's numbers come from `(seed, pixel, sample)` alone and each pixel's sum is taken in sample
//! order, so neither the tiles nor the threads can change a bit of the image.

pub mod adaptive;
mod bounce;
pub mod camera_sample;
mod context;
pub mod debug;
mod direction;
mod emission;
pub mod guided_path;
mod guided_scatter;
pub mod guiding;
mod lobe_splitting;
pub mod manifold;
mod next_event;
pub mod observer;
pub mod path;
pub mod progress;
pub mod render;
pub mod reuse;
pub mod roulette;
mod scatter;
mod settings;
mod splitting;
mod tiles;
pub mod training;
mod vertex;
pub mod wave;

#[cfg(test)]
mod tests;

pub use context::{PathContext, View};
pub use settings::{PathSettings, Roulette};
