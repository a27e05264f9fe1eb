//! The command line: one file a subcommand, and what they share.
//!
//! [`args`] says what can be typed and is the manual (`--help`), [`values`] reads numbers with units
//! (`1h30m`, `512M`) and [`choice`] words that stand for a value, [`failure`] decides exit codes. Everything a person
//! reads goes to standard error through [`console`]; standard output carries only what was asked
//! for.

pub mod aov;
pub mod args;
pub mod bar;
pub mod bench;
pub mod budget;
pub mod carried;
pub mod check;
pub mod checkpoint;
pub mod choice;
pub mod compare;
pub mod console;
pub mod denoise;
pub mod denoising;
pub mod error_track;
pub mod failure;
pub mod farm;
pub mod field;
pub mod field_file;
pub mod file_args;
pub mod finish;
pub mod frame_list;
pub mod frames;
pub mod generate;
pub mod guide_args;
pub mod help;
pub mod identity;
pub mod idle;
pub mod info;
pub mod input;
pub mod interrupt;
pub mod invalid;
pub mod learning;
pub mod light_args;
mod light_layers;
pub mod load;
pub mod make;
pub mod memory;
pub mod merge;
pub mod merge_fields;
pub mod output;
pub mod part_args;
pub mod picture_args;
pub mod prepared;
pub mod preview;
pub mod progress;
pub mod quality;
pub mod ray_args;
mod remaining;
pub mod render;
pub mod render_args;
pub mod scene_args;
pub mod settings;
pub mod single;
pub mod sweep;
pub mod table1;
pub mod targets;
pub mod threads;
pub mod train;
pub mod values;
pub mod view;
mod view_arg;
pub mod waiting;

pub use args::Cli;
pub use failure::Failure;

use args::Command;
use clap::CommandFactory;

impl Cli {
    /// Does what the command line asks for.
    ///
    /// # Errors
    /// Whatever ends the program with an exit code other than 0.
    pub fn run(&self) -> Result<(), Failure> {
        let console = console::Console::start(&self.talk);
        let interrupt = interrupt::Interrupt::listen(&console)?;
        for idle in &self.idle {
            tracing::warn!("{idle}");
        }
        threads::start(self.threads)?;
        match &self.command {
            Command::Render(args) => render::run(args, &console, &interrupt),
            Command::Merge(args) => merge::run(args, &console, &interrupt),
            Command::Denoise(args) => denoise::run(args, &console, &interrupt),
            Command::Train(args) => train::run(args, &console),
            Command::Field(args) => field::run(args),
            Command::MergeFields(args) => merge_fields::run(args),
            Command::Farm(args) => farm::run(args, self.threads),
            Command::Info(args) => info::run(args),
            Command::Check(args) => check::run(args),
            Command::Make(args) => make::run(args),
            Command::Compare(args) => compare::run(args),
            Command::Table1(args) => table1::run(args),
            Command::Sweep(args) => {
                let watch = (&console, &interrupt, &self.program[..]);
                sweep::run(args, self.threads, watch)
            }
            Command::Bench(what) => bench::run(what),
            Command::Generate(args) => generate::run(args, &Cli::command()),
        }
    }
}
