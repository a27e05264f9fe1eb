//! What can be typed: the single source of parsing and of `--help`.

use super::field_args::{FieldArgs, GuideArgs, MergeFieldsArgs, TrainArgs};
use super::file_args::FileArgs;
use super::light_args::LightArgs;
use super::measure_args::{Bench, CompareArgs};
use super::part_args::{FarmArgs, MergeArgs, PartArgs};
use super::picture_args::PictureArgs;
use super::ray_args::RayArgs;
use super::scene_args::{MakeArgs, SceneArgs};
use super::sweep_args::SweepArgs;
use super::table1::args::Table1Args;
use super::values::{self, PixelAt, Preview};
use clap::{Args, Parser, Subcommand, ValueEnum};
use std::path::PathBuf;
use std::time::Duration;

/// A physically based renderer that learns where light comes from before it renders.
#[derive(Parser, Debug)]
#[command(
    name = "twintree",
    version,
    max_term_width = 100,
    arg_required_else_help = true
)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// How much to say.
    #[command(flatten)]
    pub talk: TalkArgs,
    /// What is to be said about options without effect.
    #[arg(skip)]
    pub idle: Vec<String>,
    /// Threads that load, build and render [default: all that the machine has]
    #[arg(short = 'j', long, global = true, value_name = "N",
          value_parser = clap::value_parser!(u16).range(1..), help_heading = "Machine")]
    pub threads: Option<u16>,
}

/// The subcommands.
#[derive(Subcommand, Debug)]
pub enum Command {
    /// Render a scene to an image
    Render(Box<RenderArgs>),
    /// Join the parts of an image that were rendered with --shard
    Merge(MergeArgs),
    /// Learn where light comes from in a scene, and keep it in a file for "render --field"
    Train(Box<TrainArgs>),
    /// Show what is in a learned field
    Field(Box<FieldArgs>),
    /// Add fields that were learned with "train --field --shard"
    MergeFields(MergeFieldsArgs),
    /// Print job files that render an image in parts on many machines; nothing is submitted
    Farm(FarmArgs),
    /// Show what is in a scene
    Info(InfoArgs),
    /// Load a scene and say what is wrong with it; nothing is rendered
    Check(CheckArgs),
    /// Make something to render
    Make(MakeArgs),
    /// Say how far images are from a reference
    Compare(CompareArgs),
    /// Make the table of the method's paper anew: errors, memory and times of guided rendering
    Table1(Box<Table1Args>),
    /// Try settings on a scene against a reference, and report which to use
    Sweep(SweepArgs),
    /// Measure parts of the program
    #[command(subcommand)]
    Bench(Bench),
    /// Write man pages or shell completions into a directory
    #[command(hide = true)]
    Generate(GenerateArgs),
}

/// How much to say.
#[derive(Args, Debug)]
pub struct TalkArgs {
    /// Print errors only
    #[arg(short, long, global = true, help_heading = "Messages")]
    pub quiet: bool,
    /// Least important messages that are printed
    #[arg(
        long,
        global = true,
        value_name = "LEVEL",
        default_value = "info",
        help_heading = "Messages"
    )]
    pub log_level: LogLevel,
}

/// Importance of a message.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum LogLevel {
    /// What ends the program.
    Error,
    /// What is odd.
    Warn,
    /// What is done.
    Info,
    /// How it is done.
    Debug,
}

/// Arguments of `twintree info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `twintree check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
}

/// Arguments of `twintree generate`.
#[derive(Args, Debug)]
pub struct GenerateArgs {
    /// What to write
    pub what: Manual,
    /// Directory; made if there is none
    pub directory: PathBuf,
}

/// What can be generated from this file.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manual {
    /// A man page for the program and one for each subcommand
    Man,
    /// Completions for bash, zsh and fish
    Completions,
}

/// Arguments of `twintree render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// Files.
    #[command(flatten)]
    pub files: FileArgs,
    /// Measure the error against this image while rendering, for --stats and the message at the end
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "shard",
        help_heading = "Output"
    )]
    pub reference: Option<PathBuf>,
    /// Settings for a purpose: when to stop, and how long to learn; options that are given besides
    /// win
    #[arg(
        long,
        value_name = "NAME",
        conflicts_with = "shard",
        help_heading = "Stop at whichever comes first"
    )]
    pub quality: Option<Preset>,
    /// When to stop.
    #[command(flatten)]
    pub stop: StopArgs,
    /// Parts and checkpoints.
    #[command(flatten)]
    pub parts: PartArgs,
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Picture.
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Light transport.
    #[command(flatten)]
    pub light: LightArgs,
    /// Samples that went wrong.
    #[command(flatten)]
    pub doubt: DoubtArgs,
    /// Guiding.
    #[command(flatten)]
    pub guide: GuideArgs,
    /// Ray tracer.
    #[command(flatten)]
    pub rays: RayArgs,
    /// Show the image while it renders, in the viewer tev (tev=host:port if it runs elsewhere)
    #[arg(long, value_name = "tev[=HOST:PORT]", help_heading = "Messages")]
    pub preview: Option<Preview>,
}

/// What an image is for.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A look at light and frame
    Draft,
    /// To show
    Normal,
    /// To keep
    Final,
}

/// Samples that went wrong.
#[derive(Args, Debug)]
pub struct DoubtArgs {
    /// End with exit code 3 if a sample or a photon was not finite and had to be left out; the
    /// image is written all the same
    #[arg(long, help_heading = "Doubt")]
    pub strict: bool,
    /// Trace one sample of this pixel and print its path; nothing is written
    #[arg(
        long,
        value_name = "X,Y",
        allow_hyphen_values = true,
        help_heading = "Doubt"
    )]
    pub pixel: Option<PixelAt>,
    /// Which sample of the pixel, from 0
    #[arg(
        long,
        value_name = "I",
        default_value_t = 0,
        requires = "pixel",
        help_heading = "Doubt"
    )]
    pub sample: u64,
}

/// When to stop: whichever comes first.
#[derive(Args, Debug)]
pub struct StopArgs {
    /// Stop after N samples a pixel [default: the scene's number, or none with --time or --noise]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..), help_heading = "Stop at whichever comes first")]
    pub spp: Option<u64>,
    /// Stop after this time of rendering: 90, 120s, 2m, 1h30m
    #[arg(long, value_name = "TIME", value_parser = values::duration, help_heading = "Stop at whichever comes first")]
    pub time: Option<Duration>,
    /// Stop at this noise: the expected root of the relative mean squared error
    #[arg(long, value_name = "NOISE", value_parser = values::noise, allow_negative_numbers = true, help_heading = "Stop at whichever comes first")]
    pub noise: Option<f32>,
}
