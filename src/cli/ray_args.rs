//! What can be typed about the ray tracer.

use super::choice::{Choice, choice};
use crate::accel::Backend;
use clap::{Args, ValueEnum};
use serde::Serialize;

/// The ray tracer, and how it is built. What it comes to is known once it is built.
#[derive(Args, Clone, Debug, Default, Serialize)]
#[command(next_help_heading = "Machine")]
pub struct RayArgs {
    /// Ray tracer [default: embree, where it was compiled in]
    #[arg(long, value_name = "NAME", value_parser = TRACERS)]
    #[serde(skip)]
    pub accel: Option<Tracer>,
    /// How its trees are built [default: balanced, or compact where memory is short]
    #[arg(long, value_name = "WAY")]
    pub accel_build: Option<AccelBuild>,
}

/// A ray tracer, and whether no ray may slip through between triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tracer {
    /// Which one.
    pub backend: Backend,
    /// Whether it is watertight at edges, whatever the scene.
    pub robust: bool,
}

impl Tracer {
    const fn new(backend: Backend, robust: bool) -> Self {
        Self { backend, robust }
    }
}

const TRACERS: Choice<Tracer> = choice! {
    /// Debian's Embree
    "embree" => Tracer::new(Backend::Embree, false),
    /// Embree that lets no ray slip through between triangles, for a few per cent of speed
    "embree:robust" => Tracer::new(Backend::Embree, true),
    /// A tree in pure Rust, always watertight
    "obvhs" => Tracer::new(Backend::Obvhs, false),
};

/// Ways of building the ray tracer's tree.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AccelBuild {
    /// Quick to build
    Fast,
    /// The balance for a render of a minute
    Balanced,
    /// Least memory
    Compact,
    /// Slow to build, fastest rays
    High,
}
