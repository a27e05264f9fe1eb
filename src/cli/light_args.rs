//! What can be typed about light transport.

use super::values::Depth;
use clap::{Args, ValueEnum};

/// Light transport and its random numbers.
#[derive(Args, Debug)]
pub struct LightArgs {
    /// Longest path, in edges: 1 is emitters alone, 2 adds direct light; or "unlimited" [default:
    /// the scene's]
    #[arg(
        long,
        value_name = "N",
        allow_hyphen_values = true,
        help_heading = "Light transport"
    )]
    pub max_depth: Option<Depth>,
    /// Depth at which Russian roulette begins [default: the scene's]
    #[arg(long, value_name = "N", help_heading = "Light transport")]
    pub rr_depth: Option<u32>,
    /// Where the samples go, whatever the scene names [default: sobol]
    #[arg(long, value_name = "NAME", help_heading = "Light transport")]
    pub sampler: Option<Sampler>,
    /// Seed of all random numbers: the same seed gives the same bits, whatever the number of
    /// threads
    #[arg(
        long,
        value_name = "N",
        default_value_t = 0,
        help_heading = "Light transport"
    )]
    pub seed: u64,
    /// Emitters are not seen by the camera itself
    #[arg(long, help_heading = "Light transport")]
    pub hide_emitters: bool,
    /// Drop light that crosses a surface only by its interpolated normal
    #[arg(long, help_heading = "Light transport")]
    pub strict_normals: bool,
}

/// Samplers.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// Independent random numbers
    Independent,
    /// Owen-scrambled Sobol points
    Sobol,
}
