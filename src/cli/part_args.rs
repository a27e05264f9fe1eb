//! What can be typed to render in parts and in several goes.

use super::values;
use crate::film::Shard;
use clap::Args;
use std::time::Duration;

/// Rendering in parts and in several goes.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Parts and checkpoints")]
pub struct PartArgs {
    /// Render a share of the image, 0/4 to 3/4, into a part file for "twintree merge"
    #[arg(long, value_name = "I/N", value_parser = shard, conflicts_with_all = ["time", "noise", "preview"])]
    pub shard: Option<Shard>,
    /// Save the state of the render beside the first output this often, and when interrupted
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub checkpoint: Option<Duration>,
    /// Go on from the checkpoint, if there is one; save another when interrupted
    #[arg(long)]
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

/// A share of the film, `i/n` with `i` counted from 0.
///
/// # Errors
/// When it is not one.
pub fn shard(text: &str) -> Result<Shard, String> {
    let numbers = text
        .split_once('/')
        .map(|(i, n)| (i.parse::<u32>(), n.parse::<u32>()));
    let Some((Ok(index), Ok(count))) = numbers else {
        return Err("expected i/n such as 0/4, the first of four".into());
    };
    if index >= count {
        return Err(format!(
            "shards are counted from 0: the last of {count} is {}/{count}",
            count.saturating_sub(1)
        ));
    }
    Ok(Shard { index, count })
}
