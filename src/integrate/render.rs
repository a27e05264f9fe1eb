//! The loop around everything: passes of samples over tiles of the film, until enough.

use super::PathSettings;
use super::wave::Wave;
use crate::camera::Camera;
use crate::film::Film;
use crate::scene::Scene;
use std::time::{Duration, Instant};

/// When to stop: whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Samples a pixel.
    pub spp: u64,
    /// Wall-clock time of rendering.
    pub time: Option<Duration>,
    /// Noise of the image (see [`Film::noise`]).
    pub noise: Option<f32>,
}

/// What stopped a render.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StoppedBy {
    /// All samples were taken.
    Samples,
    /// The time was up.
    Time,
    /// The image was clean enough.
    Noise,
    /// The observer asked for it.
    Interrupt,
}

/// How far a render is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Samples a pixel finished.
    pub spp: u64,
    /// Samples a pixel at most.
    pub spp_limit: u64,
    /// Samples taken over the whole film.
    pub samples: u64,
    /// Time since rendering began.
    pub elapsed: Duration,
    /// Noise, once there are enough samples to tell.
    pub noise: Option<f32>,
}

/// Who watches a render. Called from the rendering threads between passes.
pub trait Observer: Sync {
    /// A pass over the whole film is done.
    fn pass_done(&self, progress: &Progress, film: &Film);
    /// Asked before every tile: `true` ends the render soon.
    fn should_stop(&self) -> bool;
}

/// What a render came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Why it ended.
    pub stopped_by: StoppedBy,
    /// Samples a pixel.
    pub spp: u64,
    /// Samples taken over the whole film.
    pub samples: u64,
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Wall-clock time.
    pub elapsed: Duration,
    /// Noise at the end.
    pub noise: Option<f32>,
}
