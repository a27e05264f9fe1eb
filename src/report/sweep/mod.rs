//! What a sweep measured, and what it means: `report.json`, `runs.csv` and `index.html`.
//!
//! | file | idea |
//! |---|---|
//! | this one | what was measured, as it is kept |
//! | [`curve`] | error over time: of a run, and the median of several |
//! | [`finding`] | what each configuration came to, and how it compares with the first |
//! | [`analysis`] | which configurations are better, and whether that is certain |
//! | [`advice`] | what to use for a draft, a normal and a final render |
//! | [`plot`] | curves drawn as SVG |
//! | [`pictures`] | images as PNG data inside the page |
//! | [`page`] | the page |
//! | [`table`] | `runs.csv` |

pub mod advice;
pub mod analysis;
pub mod curve;
pub mod finding;
mod html;
pub mod page;
pub mod pictures;
pub mod plot;
mod sections;
pub mod table;
#[cfg(test)]
mod tests;

use crate::report::stats::ErrorPoint;
use serde::{Deserialize, Serialize};

/// A sweep: what was to be run, and the runs so far. The field names are the keys of `report.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// What the runs have in common.
    pub setting: Setting,
    /// The command that made the report.
    pub command: String,
    /// Where it ran.
    pub machine: Machine,
    /// The runs, in the order in which they were made.
    pub runs: Vec<Run>,
}

/// What the runs of a sweep have in common: a sweep goes on only where all of it is the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Setting {
    /// Version of the program.
    pub version: String,
    /// The scene file.
    pub scene: String,
    /// Fingerprint of all that the scene consists of.
    pub scene_fingerprint: String,
    /// The image that errors are measured against.
    pub reference: Reference,
    /// Words of every run, between the scene and the options of the configuration.
    pub common: Vec<String>,
    /// Which clock the curves go by.
    pub clock: Clock,
    /// Seconds that each run renders.
    pub seconds: f64,
    /// Runs of each configuration.
    pub rounds: u32,
    /// What is tried; the first is what the others are compared with.
    pub configurations: Vec<Configuration>,
}

/// Which time curves show.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Clock {
    /// That of the wall: what one waits.
    #[default]
    Wall,
    /// That which the processors spent on a run, over its threads: what one would wait at the least
    /// if nothing else ran. It favours work that only some of the threads take part in.
    Processors,
}

/// The image that errors are measured against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// The file.
    pub path: String,
    /// Fingerprint of its bytes.
    pub fingerprint: String,
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Its own relMSE, from its variance layer; `null` without one.
    pub relmse: Option<f64>,
}

/// A set of options that is tried.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Configuration {
    /// Its name: that of its files, too.
    pub name: String,
    /// The option that it changes, or `combination`.
    pub knob: String,
    /// The words of its command line.
    pub options: Vec<String>,
}

/// Where a sweep ran.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor.
    pub processor: String,
    /// Threads that it runs at once.
    pub threads: usize,
    /// Bytes of memory.
    pub memory_bytes: Option<u64>,
    /// The operating system.
    pub system: String,
    /// Version of its kernel.
    pub kernel: String,
    /// Libraries, with their versions.
    pub libraries: Vec<String>,
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Run {
    /// Name of the configuration.
    pub configuration: String,
    /// Which of its runs, from 0.
    pub round: u32,
    /// The command, for a shell.
    pub command: String,
    /// Why there are no measurements.
    pub failure: Option<String>,
    /// Seconds from start to end.
    pub wall_seconds: f64,
    /// What it measured.
    pub stats: Option<RunStats>,
}

/// What a report needs of the file that `--stats` writes; see [`crate::report::stats::Stats`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct RunStats {
    pub threads: usize,
    pub accel: String,
    pub spp: u64,
    pub samples: u64,
    pub rays: u64,
    pub load_seconds: f64,
    pub build_seconds: f64,
    pub train_seconds: f64,
    pub render_seconds: f64,
    pub peak_memory_bytes: Option<u64>,
    pub accel_memory_bytes: u64,
    pub field_memory_bytes: u64,
    pub texture_memory_bytes: u64,
    pub errors: Vec<ErrorPoint>,
    pub field: Option<FieldStats>,
    pub trial: Option<Trial>,
}

/// A learned field in numbers; see [`crate::guide::Stats`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct FieldStats {
    pub space_nodes: u64,
    pub space_cells: u64,
    pub product_nodes: u64,
    pub links: u64,
    pub links_per_cell: f64,
    pub training_bytes: u64,
}

/// Whether guiding paid; see [`crate::integrate::training::trial::Verdict`].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub struct Trial {
    pub guided: f64,
    pub unguided: f64,
    pub tail: f64,
    pub guided_rays: f64,
    pub unguided_rays: f64,
    pub light_found: f64,
}

impl RunStats {
    /// The part of the rendering that learning took.
    pub fn train_share(&self) -> f64 {
        self.train_seconds / self.render_seconds.max(1e-9)
    }

    /// The part of the processors that the run got; less than 1 where others were busy, too.
    pub fn processor_share(&self) -> Option<f64> {
        let last = self.errors.last()?;
        let had = last.seconds * self.threads as f64;
        Some(last.cpu_seconds? / had.max(1e-9))
    }
}

impl Sweep {
    /// The file `report.json`, with what was concluded.
    pub fn to_json(&self, findings: &analysis::Findings) -> String {
        #[derive(Serialize)]
        struct Written<'a> {
            #[serde(flatten)]
            sweep: &'a Sweep,
            findings: &'a analysis::Findings,
        }
        super::json(&Written {
            sweep: self,
            findings,
        })
    }

    /// The runs of a configuration that have measurements.
    pub fn runs_of<'a>(&'a self, name: &'a str) -> impl Iterator<Item = (&'a Run, &'a RunStats)> {
        let own = self.runs.iter().filter(move |r| r.configuration == name);
        own.filter_map(|r| Some((r, r.stats.as_ref()?)))
    }

    /// Whether a run was made, with or without success.
    pub fn has(&self, name: &str, round: u32) -> bool {
        let mut runs = self.runs.iter();
        runs.any(|r| r.configuration == name && r.round == round)
    }
}
