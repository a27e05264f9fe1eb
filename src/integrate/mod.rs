//! Path tracing.
//!
//! [`render`](render::render) cuts the film into tiles and the samples into passes. A tile of a pass is one task: its
//! samples travel together as a [`wave`], one bounce at a time, so that the ray tracer gets rays in
//! bulk (packets) and the same code runs over many vertices in a row. What happens at a vertex
//! (emission, next-event estimation and BSDF sampling joined by multiple importance sampling, Russian
//! roulette) is in [`vertex`]; what is worth more than expected goes on in several ways ([`forks`]); what guided paths
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
mod aim;
pub mod cells;
pub mod chain;
pub mod effort;
mod emission;
pub mod extend;
pub mod forks;
pub mod guiding;
pub mod importance;
pub mod inspect;
pub mod learn;
pub mod learn_gmm;
mod learn_photons;
pub mod lots;
mod next_event;
mod onward;
pub mod probe;
pub mod record;
pub mod render;
pub mod reuse;
pub mod roulette;
pub mod start;
mod teach;
pub mod trial;
pub mod vertex;
pub mod wave;

#[cfg(test)]
mod tests;

use crate::math::PathSampler;
use crate::scene::description::SamplerKind;
pub use roulette::Roulette;

/// How paths are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSettings {
    /// Most edges of a path seen from the camera: 1 is emission alone, 2 adds direct light. `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// Russian roulette starts at this depth.
    pub rr_depth: u32,
    /// What roulette goes by where a field guides.
    pub roulette: Roulette,
    /// How many paths share what they find behind their first rough vertices, where a field guides (see
    /// [`reuse`]); 1: none do.
    pub reuse: u32,
    /// Where a field guides, paths aim at suns and lamps behind mirrors and glass, too (see [`chain`]), if that pays.
    pub aim: bool,
    /// Where a field is learned from the image's first samples, the later ones are spread by noise (see [`adaptive`]).
    pub adaptive: bool,
    /// The camera itself does not see emitters.
    pub hide_emitters: bool,
    /// Drop light that crosses a surface by its shading normal only.
    pub strict_normals: bool,
    /// Which numbers drive the samples.
    pub sampler: SamplerKind,
    /// Stream of all random numbers.
    pub seed: u64,
}

impl PathSettings {
    /// The numbers of path number `path` of a pixel, whose Sobol sequence starts with path `begin`.
    #[inline]
    pub fn sampler(&self, pixel: u64, begin: u64, path: u64) -> PathSampler {
        match self.sampler {
            SamplerKind::Independent => PathSampler::independent(self.seed, pixel, path),
            SamplerKind::Sobol => PathSampler::sobol(self.seed, pixel, begin, path),
        }
    }
}
