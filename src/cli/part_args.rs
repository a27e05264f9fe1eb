//! What can be typed to render in parts: options of `render`, and the commands `merge` and `farm`.

use super::file_args::FileArgs;
use super::values;
use crate::film::Shard;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// Rendering in parts and in several goes.
#[derive(Args, Debug)]
pub struct PartArgs {
    /// Render a share of the image, 0/4 to 3/4, into a part file for "twintree merge"
    #[arg(long, value_name = "I/N", value_parser = values::shard, conflicts_with_all = ["time", "noise", "preview"], help_heading = "Parts and checkpoints")]
    pub shard: Option<Shard>,
    /// Save the state of the render beside the first output this often, and when interrupted
    #[arg(long, value_name = "TIME", value_parser = values::duration, help_heading = "Parts and checkpoints")]
    pub checkpoint: Option<Duration>,
    /// Go on from the checkpoint, if there is one; save another when interrupted
    #[arg(long, help_heading = "Parts and checkpoints")]
    pub resume: bool,
}

impl PartArgs {
    /// Whether the state of the render is saved when it is interrupted.
    pub fn saves(&self) -> bool {
        self.resume || self.checkpoint.is_some()
    }

    /// Whether parts of any kind are read or written.
    pub fn wanted(&self) -> bool {
        self.saves() || self.shard.is_some()
    }
}

/// Arguments of `twintree merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Part files, in any order; checkpoints too, with --partial
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,
    /// Files.
    #[command(flatten)]
    pub files: FileArgs,
    /// Write what there is: what is missing stays black
    #[arg(long)]
    pub partial: bool,
}

/// Arguments of `twintree farm`.
#[derive(Args, Debug)]
#[command(
    override_usage = "twintree farm --format <FORMAT> [OPTIONS] <SCENE> [OPTIONS of render]..."
)]
pub struct FarmArgs {
    /// Which queue is to run the jobs
    #[arg(long, value_name = "FORMAT")]
    pub format: Queue,
    /// Parts that the image is cut into
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub shards: u32,
    /// Most parts that are rendered at the same time [default: all]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub slots: Option<u32>,
    /// Container image that has the program, for k8s
    #[arg(long, value_name = "NAME", default_value = concat!("twintree:", env!("CARGO_PKG_VERSION")))]
    pub image: String,
    /// Claim of the volume that holds the scene, for k8s
    #[arg(long, value_name = "NAME", default_value = "twintree")]
    pub claim: String,
    /// Scene, then any options of "twintree render"; options of "farm" itself come before it
    #[arg(
        required = true,
        trailing_var_arg = true,
        allow_hyphen_values = true,
        value_name = "SCENE and OPTIONS"
    )]
    pub render: Vec<String>,
}

/// What runs jobs.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Queue {
    /// A shell script that submits to Slurm
    Slurm,
    /// A template of the Open Job Description
    Openjd,
    /// Kubernetes jobs
    K8s,
}
