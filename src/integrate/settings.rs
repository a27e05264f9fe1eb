//! How paths are traced: what the scene and the command line say.

use crate::math::PathSampler;
use crate::scene::description::SamplerKind;
use serde::Serialize;

/// How paths are traced.
#[derive(Clone, Debug, PartialEq)]
pub struct PathSettings {
    /// Most edges of a path seen from the camera: 1 is emission alone, 2 adds direct light.
    /// `u32::MAX` is unlimited.
    pub max_depth: u32,
    /// Russian roulette starts at this depth.
    pub rr_depth: u32,
    /// What is done beside where a field guides.
    pub guided: GuidedSettings,
    /// The camera itself does not see emitters.
    pub hide_emitters: bool,
    /// The camera itself does not see what shines from outside the scene.
    pub hide_environment: bool,
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

/// How paths are traced where a field guides them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct GuidedSettings {
    /// What roulette goes by.
    pub roulette: Roulette,
    /// How many paths share what they find behind their first rough vertices (see
    /// [`super::reuse`]); 1: none do.
    pub reuse: u32,
    /// Suns and lamps behind mirrors and glass are sampled, too (see [`super::manifold`]), as often
    /// as that pays.
    pub manifold: bool,
    /// Where a field is learned from the image's first samples, the later ones are spread by noise
    /// (see [`super::adaptive`]).
    pub adaptive: bool,
}

impl GuidedSettings {
    /// The field gives directions and ends paths, and each path is for itself: as fields are learned
    /// and looked at.
    pub const PLAIN: Self = Self {
        roulette: Roulette::Field,
        reuse: 1,
        manifold: false,
        adaptive: false,
    };
}

/// What the chance of a guided path to go on is decided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Roulette {
    /// What the field expects the path to bring.
    #[default]
    Field,
    /// The throughput, as without a field.
    Throughput,
}
