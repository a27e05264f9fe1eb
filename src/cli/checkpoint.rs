//! Checkpoints: the state of a render in a file beside its first output, so that a machine may go
//! away.
//!
//! A checkpoint of `out.exr` is the part file `out.exr.checkpoint`. It is written every
//! `--checkpoint`, on SIGUSR1, and when the render is interrupted; it is read by `--resume`, and
//! goes when the render is complete. The render it is read by must be the one that wrote it: what
//! differs is said.

use super::Failure;
use super::part_args::PartArgs;
use crate::film::Film;
use crate::film::part::{self, Packing, PartReader, Record};
use crate::image::{ImageError, atomic};
use crate::integrate::progress::Spent;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Where and when to save.
#[derive(Debug)]
pub struct Checkpoint {
    path: PathBuf,
    interval: Option<Duration>,
    record: Record,
    last: Mutex<Instant>,
}

impl Checkpoint {
    /// Checkpoints of the render that `record` is about, saved every `interval`.
    pub fn new(output: &Path, interval: Option<Duration>, record: Record) -> Self {
        Self {
            path: Self::path_of(output),
            interval,
            record,
            last: Mutex::new(Instant::now()),
        }
    }

    /// Where the checkpoint of an output is.
    pub fn path_of(output: &Path) -> PathBuf {
        let mut path = output.as_os_str().to_owned();
        path.push(".checkpoint");
        path.into()
    }

    /// Checkpoints, if the command line wants them.
    pub fn wanted(args: &PartArgs, output: &Path, record: Option<&Record>) -> Option<Self> {
        let record = record.filter(|_| args.saves())?;
        Some(Self::new(output, args.checkpoint, record.clone()))
    }

    /// What the render is.
    pub fn record(&self) -> &Record {
        &self.record
    }

    /// Whether it is time to save.
    pub fn is_due(&self) -> bool {
        let (Some(interval), Ok(last)) = (self.interval, self.last.lock()) else {
            return false;
        };
        last.elapsed() >= interval
    }

    /// Saves the film. The next time is counted from now, whether that worked or not.
    ///
    /// # Errors
    /// When the file cannot be written; an older one stays.
    pub fn save(&self, spent: &Spent, film: &Film) -> Result<(), ImageError> {
        let start = Instant::now();
        let mut record = self.record.clone();
        record.origin.seconds = spent.time.as_secs_f64();
        record.origin.rays = spent.rays;
        let result = part::write(&self.path, &record, film, Packing::Fast);
        if let Ok(mut last) = self.last.lock() {
            *last = Instant::now();
        }
        result?;
        tracing::info!(
            "checkpoint {} at {:.1} spp, saved in {:.2} s",
            self.path.display(),
            film.samples_done() as f64 / film.held_pixels().max(1) as f64,
            start.elapsed().as_secs_f64()
        );
        Ok(())
    }

    /// Fills the film from the checkpoint, if there is one, and says what it has cost so far.
    ///
    /// # Errors
    /// When the file is damaged, or belongs to another render.
    pub fn load(&self, film: &mut Film) -> Result<Option<Spent>, Failure> {
        if !self.path.exists() {
            tracing::info!(
                "no checkpoint {}: rendering from the start",
                self.path.display()
            );
            return Ok(None);
        }
        let reader = PartReader::open(&self.path)?;
        let theirs = reader.record().clone();
        self.compare(&theirs)?;
        reader.read_into(film, &mut |_| Ok(()))?;
        self.check_goal(film)?;
        tracing::info!(
            "going on from {} at {:.1} spp",
            self.path.display(),
            film.samples_done() as f64 / film.held_pixels().max(1) as f64
        );
        let seconds = theirs.origin.seconds;
        Ok(Some(Spent {
            time: Duration::try_from_secs_f64(seconds).unwrap_or_default(),
            rays: theirs.origin.rays,
        }))
    }

    /// Takes the checkpoint away: the render is complete.
    pub fn remove(&self) {
        atomic::remove(&self.path);
    }

    fn compare(&self, theirs: &Record) -> Result<(), Failure> {
        let ours = &self.record;
        let mut differences =
            ours.identity
                .differences("here", &theirs.identity, "in the checkpoint");
        if ours.shard != theirs.shard {
            differences.push(format!(
                "the shard is {} here and {} in the checkpoint",
                ours.shard, theirs.shard
            ));
        }
        if ours.region != theirs.region && differences.is_empty() {
            differences.push("the regions of the film differ".into());
        }
        if differences.is_empty() {
            return Ok(());
        }
        Err(Failure::wrong(
            format!(
                "{} is of another render: {}",
                self.path.display(),
                differences.join("; ")
            ),
            "render with the same scene and settings, or without --resume to begin again",
        ))
    }

    /// More samples than before may be asked for, but not fewer than there are.
    fn check_goal(&self, film: &Film) -> Result<(), Failure> {
        let most = film.held().map(|t| t.done).max().unwrap_or(0);
        match self.record.goal {
            Some(goal) if most > goal => Err(Failure::wrong(
                format!(
                    "{} has {most} samples a pixel, more than the {goal} to render",
                    self.path.display()
                ),
                format!("ask for at least --spp {most}, or begin again without --resume"),
            )),
            _ => Ok(()),
        }
    }
}
