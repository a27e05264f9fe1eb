//! What can be typed for `twintree bench`.

use crate::accel::{Backend, BuildQuality};
use crate::cli::choice::{Choice, choice};
use crate::cli::make::SHAPES;
use crate::cli::scene_args::SceneArgs;
use crate::cli::values;
use crate::make::Kind;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// What `twintree bench` measures.
#[derive(Subcommand, Debug)]
pub enum Bench {
    /// Build times, memory and rays a second of both ray tracers
    Accel(Box<BenchAccelArgs>),
    /// How loading, building and tracing grow with the size of a mesh
    Scale(BenchScaleArgs),
}

/// Arguments of `twintree bench accel`.
#[derive(Args, Debug)]
pub struct BenchAccelArgs {
    /// Scene; its file may also be a mesh: .ply, .obj or .serialized
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Build qualities to measure
    #[arg(long, value_name = "NAMES", value_delimiter = ',', default_value = "fast,balanced,high",
          value_parser = QUALITIES)]
    pub quality: Vec<BuildQuality>,
    /// What is traced.
    #[command(flatten)]
    pub rates: RateArgs,
}

/// What is traced, and how the rates of that are kept.
#[derive(Args, Debug)]
pub struct RateArgs {
    /// Ray tracers to measure [default: all there are]
    #[arg(long, value_name = "NAME", value_delimiter = ',', value_parser = BACKENDS)]
    pub accel: Vec<Backend>,
    /// Rays of each kind
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1024..=1 << 24))]
    pub rays: u32,
    /// Seconds for each rate: the rays are traced again and again, and the median counts
    #[arg(long, value_name = "SECONDS", default_value_t = 0.3, value_parser = values::limit)]
    pub seconds: f64,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Arguments of `twintree bench scale`.
#[derive(Args, Debug)]
pub struct BenchScaleArgs {
    /// Triangles of the smallest mesh
    #[arg(long, value_name = "N", default_value = "1k", value_parser = values::amount)]
    pub least: u64,
    /// Triangles of the largest mesh, such as 64M; each is four times the one before
    #[arg(long, value_name = "N", default_value = "4M", value_parser = values::amount)]
    pub most: u64,
    /// Shape of the meshes
    #[arg(long, value_name = "SHAPE", default_value = "terrain", value_parser = SHAPES)]
    pub kind: Kind,
    /// What is traced.
    #[command(flatten)]
    pub rates: RateArgs,
    /// Where the meshes are written while they are needed: 20 bytes a triangle [default: the
    /// system's directory for temporary files]
    #[arg(long, value_name = "DIRECTORY")]
    pub directory: Option<PathBuf>,
    /// Draw the curves
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// Ray tracers that can be measured.
const BACKENDS: Choice<Backend> = choice! {
    /// Debian's Embree
    "embree" => Backend::Embree,
    /// A tree in pure Rust
    "obvhs" => Backend::Obvhs,
};

/// How long to build, for how fast a tree.
pub const QUALITIES: Choice<BuildQuality> = choice! {
    /// Quick to build
    "fast" => BuildQuality::Fast,
    /// What a render takes
    "balanced" => BuildQuality::Balanced,
    /// Slow to build, fastest to trace
    "high" => BuildQuality::High,
};
