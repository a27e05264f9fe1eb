//! `twintree farm`: job files for queues that run an image's shards on many machines.
//!
//! Queues are good at what they do (who runs when, what happens when a machine dies) and every site
//! has its own. The program therefore talks to none: it prints a file for one, which a person
//! reads, changes and submits. All of them do the same: an array of `twintree render --shard`, then
//! `twintree merge`. What makes that safe is in those commands: shards write whole files or none,
//! go on from a checkpoint when they are started once more, and end at once if their part is there
//! already.

pub mod args;
mod k8s;
mod openjd;
mod plan;
mod slurm;
#[cfg(test)]
mod tests;
mod words;

use self::args::{FarmArgs, Queue};
use self::plan::Plan;
pub(crate) use self::plan::quote;
use super::{Failure, console};

/// Prints the job file. `threads` is what `-j` said before the scene.
///
/// # Errors
/// When the words that are meant for `twintree render` are none that it takes, or cannot be cut up.
pub fn run(args: &FarmArgs, threads: Option<u16>) -> Result<(), Failure> {
    let plan = Plan::new(args, threads)?;
    console::print_result(&match args.format {
        Queue::Slurm => slurm::script(&plan),
        Queue::Openjd => openjd::template(&plan),
        Queue::K8s => k8s::manifest(&plan, &args.image, &args.claim),
    })
}
