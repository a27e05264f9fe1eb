//! What can be typed: the single source of parsing and of `--help`. Each command has its arguments
//! beside it, and those that several commands share are in files of their own.

use super::bench::args::Bench;
use super::check::CheckArgs;
use super::compare::args::CompareArgs;
use super::console::TalkArgs;
use super::denoise::DenoiseArgs;
use super::farm::args::FarmArgs;
use super::field::FieldArgs;
use super::generate::GenerateArgs;
use super::info::InfoArgs;
use super::make::MakeArgs;
use super::merge::MergeArgs;
use super::merge_fields::MergeFieldsArgs;
use super::render_args::RenderArgs;
use super::sweep::args::SweepArgs;
use super::table1::args::Table1Args;
use super::train::TrainArgs;
use clap::{Parser, Subcommand};
use std::ffi::OsString;

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
    /// The words that start this program, where it is not a file of its own.
    #[arg(skip)]
    pub program: Vec<OsString>,
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
    /// Take the noise out of an image
    Denoise(DenoiseArgs),
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
