//! What a render came to: the `--stats` file and the sentence at the end.

use super::table::number;
use super::words;
use crate::guide;
use crate::integrate::training::trial::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Measurements of a render. The field names are the keys of the `--stats` file, documented in
/// [`manual::stats`](crate::manual::stats); times are wall-clock seconds, memory is in bytes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Stats {
    /// Version of the program.
    pub version: String,
    /// The scene file.
    pub scene: String,
    /// Width of the image (the crop's, if there is one).
    pub width: u32,
    /// Height of the image.
    pub height: u32,
    /// Seed of all random numbers.
    pub seed: u64,
    /// All that shaped the pixels, by the names of the options.
    pub settings: BTreeMap<String, String>,
    /// Threads.
    pub threads: usize,
    /// The ray tracer, with its version.
    pub accel: String,
    /// `samples`, `time`, `noise` or `interrupt`.
    pub stopped_by: &'static str,
    /// Samples a pixel.
    pub spp: u64,
    /// Samples over the whole image.
    pub samples: u64,
    /// `samples / render_seconds`.
    pub samples_per_second: f64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// `rays / render_seconds`.
    pub rays_per_second: f64,
    /// Expected root of the relative mean squared error; `null` below two samples a pixel.
    pub noise: Option<f32>,
    /// Standard error of the noise, as a share of it: large where a few pixels have most of the
    /// variance.
    pub noise_error: Option<f32>,
    /// Share of the variance that the noisiest 0.1 % of the numbers have, which the noise leaves
    /// out.
    pub noise_worst: Option<f32>,
    /// Samples dropped because they were not finite.
    pub invalid_samples: u64,
    /// Reading the scene and its meshes.
    pub load_seconds: f64,
    /// Building the ray tracer's trees and the lights.
    pub build_seconds: f64,
    /// Learning the field; 0 without one.
    pub train_seconds: f64,
    /// Bytes of the learned field; 0 without one.
    pub field_memory_bytes: u64,
    /// Most bytes that learning held on the way: trees, and the records that they learned from; 0
    /// without it.
    pub learning_memory_bytes: u64,
    /// Rendering.
    pub render_seconds: f64,
    /// Denoising; 0 without it.
    pub denoise_seconds: f64,
    /// Writing the images.
    pub write_seconds: f64,
    /// Most memory that the process held; `null` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
    /// Memory of the ray tracer's trees.
    pub accel_memory_bytes: u64,
    /// Memory of texels.
    pub texture_memory_bytes: u64,
    /// Triangles of all meshes, instances counted once.
    pub triangles: u64,
    /// The image that errors were measured against.
    pub reference: Option<String>,
    /// The error over time, against the reference.
    pub errors: Vec<ErrorPoint>,
    /// The field that was learned on the way, in numbers; `null` without one.
    pub field: Option<guide::Stats>,
    /// Whether guiding pays, where that was tried.
    pub trial: Option<Verdict>,
    /// What was odd about the scene.
    pub warnings: Vec<String>,
}

/// The error at one moment of a render.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ErrorPoint {
    /// Time of rendering, learning included, as `render_seconds`.
    pub seconds: f64,
    /// Time that processors spent on it; `null` where the system does not tell.
    pub cpu_seconds: Option<f64>,
    /// Samples a pixel.
    pub spp: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Root of the mean squared difference.
    pub rmse: f64,
    /// Mean of (I - R)^2 / (R^2 + 0.01).
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// relMSE of the means over blocks of 4 x 4 pixels; `null` where there is no such block.
    #[serde(default)]
    pub relmse_4x4: Option<f64>,
    /// The same for 16 x 16 pixels.
    #[serde(default)]
    pub relmse_16x16: Option<f64>,
}

impl Stats {
    /// The `--stats` file.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// The end of a render in one sentence.
    pub fn sentence(&self) -> String {
        let why = match self.stopped_by {
            "time" => "the time is up",
            "noise" => "clean enough",
            "interrupt" => "interrupted",
            _ => "all samples are taken",
        };
        let noise = self
            .noise
            .map_or(String::new(), |n| format!(", noise {n:.4}"));
        format!(
            "{why}: {} spp in {}{noise}, {} samples/s",
            self.spp,
            words::time(self.render_seconds),
            words::count(self.samples_per_second),
        )
    }

    /// How far the image is from the reference, if there is one, in another.
    pub fn error_sentence(&self) -> Option<String> {
        let error = self.errors.last()?;
        Some(format!(
            "against the reference: RMSE {}, relMSE {} ({} trimmed; of 4x4, 16x16 blocks {})",
            number(error.rmse),
            number(error.relmse),
            number(error.relmse_trimmed),
            words::errors_of_blocks([error.relmse_4x4, error.relmse_16x16])
        ))
    }
}
