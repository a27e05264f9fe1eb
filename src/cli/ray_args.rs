//! What can be typed about the ray tracer.

use clap::{Args, ValueEnum};

/// The ray tracer, and how it is built.
#[derive(Args, Debug, Default)]
pub struct RayArgs {
    /// Ray tracer [default: embree, where it was compiled in]
    #[arg(long, value_name = "NAME", help_heading = "Machine")]
    pub accel: Option<Accel>,
    /// How its trees are built [default: balanced, or compact where memory is short]
    #[arg(long, value_name = "WAY", help_heading = "Machine")]
    pub accel_build: Option<AccelBuild>,
    /// Let no ray slip through between triangles, for a few per cent of speed
    #[arg(long, help_heading = "Machine")]
    pub robust: bool,
}

/// Ray tracers.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accel {
    /// Debian's Embree
    Embree,
    /// A tree in pure Rust
    Obvhs,
}

/// Ways of building the ray tracer's tree.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
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
