//! What can be typed about light transport.

use super::choice::{Choice, choice};
use crate::scene::description::SamplerKind;
use clap::Args;
use serde::Serialize;
use std::str::FromStr;

/// Light transport and its random numbers.
#[derive(Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Light transport")]
pub struct LightArgs {
    /// Longest path, in edges: 1 is emitters alone, 2 adds direct light; or "unlimited" [default:
    /// the scene's]
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub max_depth: Option<Depth>,
    /// Depth at which Russian roulette begins [default: the scene's]
    #[arg(long, value_name = "N")]
    pub rr_depth: Option<u32>,
    /// Where the samples go, whatever the scene names [default: sobol]
    #[arg(long, value_name = "NAME", value_parser = SAMPLERS)]
    pub sampler: Option<SamplerKind>,
    /// Seed of all random numbers: the same seed gives the same bits, whatever the number of
    /// threads
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Emitters are not seen by the camera itself
    #[arg(long)]
    pub hide_emitters: bool,
    /// Drop light that crosses a surface only by its interpolated normal
    #[arg(long)]
    pub strict_normals: bool,
}

const SAMPLERS: Choice<SamplerKind> = choice! {
    /// Independent random numbers
    "independent" => SamplerKind::Independent,
    /// Owen-scrambled Sobol points
    "sobol" => SamplerKind::Sobol,
};

/// A limit on the number of edges of a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Depth(
    /// `None` is unlimited.
    pub Option<u32>,
);

impl FromStr for Depth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if matches!(text, "-1" | "unlimited") {
            return Ok(Self(None));
        }
        match text.parse() {
            Ok(depth) if depth > 0 => Ok(Self(Some(depth))),
            _ => Err("expected a whole number from 1 on, or \"unlimited\"".into()),
        }
    }
}
