//! When a render stops, how far it is, and who watches it.

use crate::film::{Film, Noise};
use std::time::Duration;

/// Below this many samples a pixel's own variance is not to be trusted.
pub const MIN_SPP_FOR_NOISE: u64 = 16;

/// Most samples a pixel takes in one pass: the interval between looks at the clock.
pub const PASS_SPP: u64 = 64;

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

impl Limits {
    /// Whether the noise after `spp` samples a pixel is as low as was asked for.
    pub(super) fn are_met_by_noise(&self, spp: u64, noise: Option<Noise>) -> bool {
        let target = self.noise.filter(|_| spp >= MIN_SPP_FOR_NOISE);
        target.is_some_and(|target| noise.is_some_and(|n| n.at_most() <= target))
    }
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
    /// Rays traced, shadow rays included.
    pub rays: u64,
    /// Time since rendering began.
    pub elapsed: Duration,
    /// Noise, once there are enough samples to tell.
    pub noise: Option<Noise>,
}

/// What a render does between passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Learning {
    /// It learns from camera paths that were drawn.
    Paths,
    /// It learns from photons.
    Photons,
    /// It tries whether guiding pays.
    Trial,
}

/// Whether work is to end soon, with what it has come to. Asked often, from many threads at once.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Who watches a render. Called from the rendering threads between passes.
pub trait Observer: Sync {
    /// A pass over the whole film is done.
    fn pass_done(&self, progress: &Progress, film: &Film);
    /// A tile has got `samples` more. Called from many threads at once.
    fn tile_done(&self, samples: u64) {
        let _ = samples;
    }
    /// Asked before every tile: `true` ends the render soon.
    fn should_stop(&self) -> bool;
    /// Asked before every tile: `true` halts the render after the tiles in flight, so that
    /// [`Observer::paused`] sees a film that nobody is at. It then goes on where it was.
    fn should_pause(&self) -> bool {
        false
    }
    /// Nothing is drawn from now on.
    fn learns(&self, how: Learning) {
        let _ = how;
    }
    /// It goes on drawing. So much of what is to be learned from camera paths is known, from 0 to 1.
    fn draws(&self, learned: f64) {
        let _ = learned;
    }
    /// A path goes on after so many edges. Called from many threads at once, and more than once.
    fn path_is_long(&self, edges: u32) {
        let _ = edges;
    }
    /// Paths without an end in sight were given up, for the render is to end: their samples, and
    /// those that were traced with them, are left out.
    fn gave_up(&self) {}
    /// Time that [`Observer::pass_done`] has kept the render waiting for matters of its own: it
    /// does not count as rendering.
    fn time_aside(&self) -> Duration {
        Duration::ZERO
    }
    /// The render has halted.
    fn paused(&self, spent: &Spent, film: &Film) {
        let _ = (spent, film);
    }
}

/// What a render has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spent {
    /// Wall-clock time.
    pub time: Duration,
    /// Rays traced, shadow rays included.
    pub rays: u64,
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
    pub noise: Option<Noise>,
}
