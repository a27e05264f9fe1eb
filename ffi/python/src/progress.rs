//! How far a render or a training is, as Python shows it.

use crate::work::Meanwhile;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use twintree::cli::error_track::ErrorTrack;
use twintree::film::Film;
use twintree::integrate::progress::{Learning, Limits, Observer, Progress};
use twintree::integrate::training;

/// How far a render is. Its threads write it, the one that holds Python's lock reads it.
pub struct Watcher {
    pub stop: AtomicBool,
    /// Samples over the whole film, and its pixels.
    pub samples: AtomicU64,
    pub pixels: AtomicU64,
    /// Paths traced to learn from before this work began.
    traced: u64,
    /// Paths that will be, where that is known.
    records: Option<u64>,
    state: Mutex<State>,
    start: Instant,
}

#[derive(Clone, Default)]
pub struct State {
    pub limits: Option<Limits>,
    noise: Option<f32>,
    learns: bool,
    pub track: Option<Arc<ErrorTrack>>,
}

impl Watcher {
    /// Of work that begins now; `records` is how many paths will teach, where that is known.
    pub fn new(records: Option<u64>) -> Self {
        Self {
            stop: AtomicBool::new(false),
            samples: AtomicU64::new(0),
            pixels: AtomicU64::new(1),
            traced: training::traced(),
            records,
            state: Mutex::default(),
            start: Instant::now(),
        }
    }

    /// Changes what is known.
    pub fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }

    pub fn state(&self) -> State {
        self.state
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    pub fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

impl Observer for Watcher {
    fn pass_done(&self, progress: &Progress, film: &Film) {
        self.change(|state| state.noise = progress.noise.map(|n| n.value));
        if let Some(track) = self.state().track {
            track.pass_done(progress, film);
        }
    }

    fn tile_done(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
    }

    fn should_stop(&self) -> bool {
        self.stops()
    }

    fn learns(&self, _: Learning) {
        self.change(|state| state.learns = true);
    }

    fn draws(&self, _: f64) {
        self.change(|state| state.learns = false);
    }

    fn time_aside(&self) -> std::time::Duration {
        self.state()
            .track
            .map_or_else(Default::default, |t| t.time_taken())
    }
}

/// Shows how far work is by an object of Python's.
pub struct Shown<'a> {
    watcher: &'a Watcher,
    by: Option<Py<PyAny>>,
}

impl<'a> Shown<'a> {
    pub fn begin(
        py: Python<'_>,
        watcher: &'a Watcher,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let module = py.import("twintree._progress")?;
        let by = module.call_method1("begin", (progress,))?;
        let by = (!by.is_none()).then(|| by.unbind());
        Ok(Self { watcher, by })
    }
}

impl Meanwhile for Shown<'_> {
    fn look(&mut self, py: Python<'_>, done: bool) -> PyResult<()> {
        let Some(by) = &self.by else { return Ok(()) };
        let state = self.watcher.state();
        let how = PyDict::new(py);
        let pixels = self.watcher.pixels.load(Ordering::Relaxed).max(1);
        let samples = self.watcher.samples.load(Ordering::Relaxed);
        let learns = state.limits.is_none() || state.learns;
        how.set_item("doing", if learns { "learning" } else { "rendering" })?;
        how.set_item("spp", samples as f64 / pixels as f64)?;
        how.set_item("seconds", self.watcher.start.elapsed().as_secs_f64())?;
        how.set_item(
            "records",
            training::traced().saturating_sub(self.watcher.traced),
        )?;
        how.set_item("most_records", self.watcher.records)?;
        let limits = state.limits;
        how.set_item("most_spp", limits.map(|l| l.spp).filter(|n| *n < u64::MAX))?;
        how.set_item(
            "most_seconds",
            limits.and_then(|l| l.time).map(|t| t.as_secs_f64()),
        )?;
        how.set_item("noise", state.noise)?;
        how.set_item("least_noise", limits.and_then(|l| l.noise))?;
        by.call_method1(py, "show", (how, done))?;
        Ok(())
    }
}

impl Drop for Shown<'_> {
    fn drop(&mut self) {
        let Some(by) = self.by.take() else { return };
        // A bar that cannot be taken away is no reason to lose a picture.
        Python::attach(|py| {
            let _ = by.call_method0(py, "close");
        });
    }
}
