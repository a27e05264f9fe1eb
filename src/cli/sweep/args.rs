//! What can be typed for `twintree sweep`.

use crate::cli::choice::{Choice, choice};
use crate::cli::scene_args::SceneArgs;
use crate::cli::values;
use crate::report::sweep::Clock;
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;

/// Arguments of `twintree sweep`.
#[derive(Args, Debug)]
#[command(
    override_usage = "twintree sweep [OPTIONS] --reference <FILE> <SCENE> [-- OPTIONS of render...]"
)]
pub struct SweepArgs {
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// A clean image of the scene, rendered with a seed of its own; its size is that of all runs
    #[arg(long, value_name = "FILE")]
    pub reference: PathBuf,
    /// Time for everything: 10m, 1h30m. The same command goes on where it ended
    #[arg(long, value_name = "TIME", default_value = "10m", value_parser = values::duration)]
    pub budget: Duration,
    /// Directory for the report; made if there is none
    #[arg(short, long, value_name = "DIRECTORY", default_value = "report")]
    pub output: PathBuf,
    /// Runs of each configuration, each with a seed of its own
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub rounds: u32,
    /// Time of rendering of each run [default: what the budget allows]
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub time: Option<Duration>,
    /// Time that curves and advice go by
    #[arg(long, value_name = "NAME", default_value = "wall", value_parser = CLOCKS)]
    pub clock: Clock,
    /// Try what this file says instead: JSON with "base", "knobs" and "combinations"; --dry-run
    /// shows what that comes to
    #[arg(long, value_name = "FILE")]
    pub plan: Option<PathBuf>,
    /// Print the commands and run nothing
    #[arg(long)]
    pub dry_run: bool,
    /// Options of "twintree render" for every run, such as --max-depth 8
    #[arg(last = true, allow_hyphen_values = true, value_name = "OPTIONS")]
    pub render: Vec<String>,
}

const CLOCKS: Choice<Clock> = choice! {
    /// What one waits
    "wall" => Clock::Wall,
    /// What processors spent, over the threads: on a machine that is busy with other things
    "processors" => Clock::Processors,
};
