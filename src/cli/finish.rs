//! The end of a render: what is written, and what the exit code says about it.
//!
//! | the render is | a whole image | a shard |
//! |---|---|---|
//! | complete | the images; the checkpoint goes | the part; the checkpoint goes |
//! | interrupted | the images so far | nothing: half a part would be in the way |
//! | interrupted, with checkpoints | the checkpoint, the images so far | the checkpoint |
//!
//! SIGUSR1 without checkpoints writes the images so far, and rendering goes on.

use super::checkpoint::Checkpoint;
use super::denoising::Denoising;
use super::output::Outputs;
use super::render_args::RenderArgs;
use super::{Failure, memory};
use crate::film::Film;
use crate::film::Metadata;
use crate::film::part::Record;
use crate::integrate::progress::{Spent, StoppedBy, Summary};
use crate::report::stats::Stats;
use std::time::Instant;

/// A render that has ended, one way or the other.
pub struct Done<'a> {
    /// The command line.
    pub args: &'a RenderArgs,
    /// Where to write.
    pub outputs: &'a Outputs,
    /// Where to save, if that is wanted.
    pub checkpoint: Option<&'a Checkpoint>,
    /// What takes the noise away, if that is wanted.
    pub denoising: Option<Denoising<'a>>,
    /// What a shard's part says about itself.
    pub record: Option<Record>,
    /// Brightness of 8-bit formats.
    pub exposure: f32,
}

impl Done<'_> {
    /// Writes everything and completes the measurements.
    ///
    /// # Errors
    /// When something cannot be written; after an interrupt, with all written.
    pub fn write(&self, film: &Film, summary: &Summary, stats: &mut Stats) -> Result<(), Failure> {
        let interrupted = summary.stopped_by == StoppedBy::Interrupt;
        if film.samples_done() == 0 {
            return Err(nothing_done(interrupted));
        }
        warn_of_gaps(film);
        let start = Instant::now();
        let saved = match self.checkpoint.filter(|_| interrupted) {
            Some(checkpoint) => checkpoint.save(&spent(summary), film),
            None => Ok(()),
        };
        let written = match (self.args.parts.shard, &self.record) {
            (Some(_), Some(record)) if !interrupted => {
                self.outputs.write_part(&part_of(record, summary), film)
            }
            (Some(_), _) => Ok(()),
            (None, _) => self.write_images(film, stats, interrupted),
        };
        stats.write_seconds = start.elapsed().as_secs_f64() - stats.denoise_seconds;
        stats.peak_memory_bytes = memory::peak_bytes();
        self.outputs.write_stats(&stats.to_json())?;
        saved.map_err(|e| Failure::Refused(e.to_string()))?;
        written?;
        self.close(interrupted)
    }

    /// Writes the images, denoised if that is wanted; noisy where that fails.
    fn write_images(
        &self,
        film: &Film,
        stats: &mut Stats,
        interrupted: bool,
    ) -> Result<(), Failure> {
        let files = &self.args.files;
        let metadata = metadata(self.args, stats.spp, stats.render_seconds);
        let mut picture = film.image(files.layers(), &metadata);
        let mut denoised = Ok(());
        if let Some(denoising) = &self.denoising {
            let start = Instant::now();
            (picture, denoised) = denoising.apply(picture, interrupted);
            stats.denoise_seconds = start.elapsed().as_secs_f64();
        }
        self.outputs
            .write_images(&picture, &files.exr, self.exposure, &files.view.view)?;
        denoised
    }

    /// Writes the images as they are, for whom asks while it renders.
    pub fn write_so_far(&self, spent: &Spent, film: &Film) {
        if self.args.parts.shard.is_some() || film.samples_done() == 0 {
            let missing = match self.args.parts.shard {
                Some(_) => "a shard is saved with --checkpoint only",
                None => "no sample is finished",
            };
            tracing::info!("SIGUSR1: there is nothing to write yet: {missing}");
            return;
        }
        let metadata = metadata(self.args, film.spp_done(), spent.time.as_secs_f64());
        let files = &self.args.files;
        // The end of the render, which writes them again, may fare better.
        let mut picture = film.image(files.layers(), &metadata);
        if let Some(denoising) = &self.denoising {
            picture = denoising.apply_meanwhile(picture);
        }
        if let Err(e) =
            self.outputs
                .write_images(&picture, &files.exr, self.exposure, &files.view.view)
        {
            tracing::warn!("{}", e.text().unwrap_or_default());
        }
    }

    /// Everything is written: what does the exit code say?
    fn close(&self, interrupted: bool) -> Result<(), Failure> {
        match (interrupted, self.checkpoint) {
            (false, Some(checkpoint)) => {
                checkpoint.remove();
                Ok(())
            }
            (false, None) => Ok(()),
            (true, Some(_)) => Err(Failure::Checkpointed),
            (true, None) if self.args.parts.shard.is_some() => {
                tracing::warn!(
                    "the shard is not complete: nothing is written without --checkpoint"
                );
                Err(Failure::Interrupted)
            }
            (true, None) => Err(Failure::Interrupted),
        }
    }
}

/// A render that has ended before its first sample.
pub fn nothing_done(interrupted: bool) -> Failure {
    if interrupted {
        tracing::warn!("no sample was finished: nothing is written");
        return Failure::Interrupted;
    }
    Failure::refused(
        "no sample was finished before the time was up: nothing is written",
        "give more --time; --max-depth 100 ends paths that have no end",
    )
}

/// Says what stays black because the end came early.
pub fn warn_of_gaps(film: &Film) {
    let (all, without) = film.held().fold((0, 0), |(all, without), tile| {
        (all + 1, without + u32::from(tile.done == 0))
    });
    if without > 0 {
        tracing::warn!("{without} of {all} tiles of the image have no sample yet and are black");
    }
}

fn spent(summary: &Summary) -> Spent {
    Spent {
        time: summary.elapsed,
        rays: summary.rays,
    }
}

/// The record with what the render has cost.
fn part_of(record: &Record, summary: &Summary) -> Record {
    let mut record = record.clone();
    record.origin.seconds = summary.elapsed.as_secs_f64();
    record.origin.rays = summary.rays;
    record
}

/// What a file says about how it was made.
fn metadata(args: &RenderArgs, spp: u64, seconds: f64) -> Metadata {
    let words = std::env::args_os().skip(1);
    let words: Vec<_> = words.map(|w| w.to_string_lossy().into_owned()).collect();
    Metadata {
        scene: args.scene.title(),
        settings: words.join(" "),
        spp,
        seconds,
    }
}
