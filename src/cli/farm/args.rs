//! What can be typed for `twintree farm`.

use clap::{Args, ValueEnum};

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
