//! How far a render is: a bar on a terminal, lines elsewhere.

use super::bar::{BAR_INTERVAL, LONGEST_SILENCE, STEPS, bar, fitting};
use super::console::Console;
use super::error_track::ErrorTrack;
use super::finish::Done;
use super::interrupt::Interrupt;
use super::preview::Tev;
use crate::film::{Film, Noise};
use crate::integrate::progress::{Limits, Observer, Progress, Spent};
use crate::report::words;
use indicatif::ProgressBar;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Lines come at every tenth of the work, but not faster than this.
const SHORTEST_SILENCE: Duration = Duration::from_secs(1);

/// Watches a render for the person who waits.
pub struct Watch<'a> {
    interrupt: &'a Interrupt,
    done: &'a Done<'a>,
    track: Option<&'a ErrorTrack>,
    /// Time and samples of earlier goes.
    before: (Duration, u64),
    limits: Limits,
    pixels: u64,
    start: Instant,
    samples: AtomicU64,
    display: Display,
    shown: Mutex<Shown>,
    preview: Mutex<Option<Tev>>,
    /// Whether it was said that paths are long.
    long_paths: AtomicBool,
}

enum Display {
    Nothing,
    Bar(ProgressBar),
    Lines,
}

/// What was shown last.
struct Shown {
    at: Instant,
    tenths: u64,
    noise: Option<Noise>,
}

impl<'a> Watch<'a> {
    /// Starts watching a render of `film`, which may go on from a checkpoint: `before` is the time
    /// it has taken already.
    pub fn start(
        interrupt: &'a Interrupt,
        console: &Console,
        limits: Limits,
        film: &Film,
        preview: Option<Tev>,
        (done, before): (&'a Done<'a>, Duration),
    ) -> Self {
        let display = match (console.shows_progress(), console.has_terminal()) {
            (false, _) => Display::Nothing,
            (true, false) => Display::Lines,
            (true, true) => Display::Bar(console.bars().add(bar())),
        };
        let start = Instant::now();
        Self {
            interrupt,
            done,
            track: None,
            before: (before, film.samples_done()),
            limits,
            pixels: film.held_pixels().max(1),
            start,
            samples: AtomicU64::new(film.samples_done()),
            display,
            shown: Mutex::new(Shown {
                at: start,
                tenths: 0,
                noise: None,
            }),
            preview: Mutex::new(preview),
            long_paths: AtomicBool::new(false),
        }
    }

    /// Measures errors along the way, if there is a reference.
    pub fn measuring(self, track: Option<&'a ErrorTrack>) -> Self {
        Self { track, ..self }
    }

    /// Shows the last image and takes the bar away.
    pub fn finish(self, film: &Film) {
        self.show_image(film, true);
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn show_image(&self, film: &Film, last: bool) {
        let Ok(mut preview) = self.preview.lock() else {
            return;
        };
        let Some(tev) = preview.as_mut() else { return };
        if let Err(e) = tev.show(film, last) {
            tracing::warn!("the preview ends: tev has gone ({e})");
            *preview = None;
        }
    }

    /// Shows how far things are, if it is time to. Never waits for another thread that is at it.
    fn show(&self) {
        let Ok(mut shown) = self.shown.try_lock() else {
            return;
        };
        let silence = shown.at.elapsed();
        let shortest = match self.display {
            Display::Nothing => return,
            Display::Bar(_) => BAR_INTERVAL,
            Display::Lines => SHORTEST_SILENCE,
        };
        if silence < shortest {
            return;
        }
        let samples = self.samples.load(Ordering::Relaxed);
        let elapsed = self.before.0 + self.start.elapsed();
        let fraction = fraction_done(&self.limits, self.pixels, samples, elapsed, shown.noise);
        let tenths = (fraction * 10.0) as u64;
        let text = self.sentence(samples, elapsed, fraction, shown.noise);
        match &self.display {
            Display::Bar(bar) => {
                bar.set_message(fitting(text));
                bar.set_position((fraction * STEPS as f64) as u64);
            }
            _ if tenths == shown.tenths && silence < LONGEST_SILENCE => return,
            _ => tracing::info!("{:>3.0} %  {text}", (fraction * 100.0).floor()),
        }
        shown.at = Instant::now();
        shown.tenths = tenths;
    }

    fn sentence(
        &self,
        samples: u64,
        elapsed: Duration,
        fraction: f64,
        noise: Option<Noise>,
    ) -> String {
        let seconds = elapsed.as_secs_f64();
        let rate = (samples - self.before.1) as f64 / self.start.elapsed().as_secs_f64();
        let spp = samples as f64 / self.pixels as f64;
        let decimals = usize::from(spp < 99.95);
        let mut text = format!("{spp:.decimals$}");
        if self.limits.spp < u64::MAX {
            text += &format!("/{}", self.limits.spp);
        }
        text += &format!(" spp  {} samples/s", words::count(rate));
        if let Some(noise) = noise {
            text += &format!("  noise {:.4}", noise.value);
        }
        if fraction > 0.0 {
            let left = seconds * (1.0 - fraction) / fraction;
            text += &format!("  {} left", words::time(left));
        }
        text
    }
}

impl Observer for Watch<'_> {
    fn pass_done(&self, progress: &Progress, film: &Film) {
        if let Ok(mut shown) = self.shown.lock() {
            shown.noise = progress.noise;
        }
        self.show();
        self.show_image(film, false);
        if let Some(track) = self.track {
            track.pass_done(progress, film);
        }
    }

    fn tile_done(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        self.show();
    }

    fn should_stop(&self) -> bool {
        self.interrupt.requested()
    }

    fn time_aside(&self) -> Duration {
        self.track.map_or(Duration::ZERO, ErrorTrack::time_taken)
    }

    fn path_is_long(&self, edges: u32) {
        if !self.long_paths.swap(true, Ordering::Relaxed) {
            tracing::warn!(
                "paths go on after {edges} edges: they may have no end. --max-depth 100 ends them"
            );
        }
    }

    fn gave_up(&self) {
        tracing::warn!(
            "paths without an end in sight were given up, and the samples that were traced with them are left out"
        );
    }

    fn should_pause(&self) -> bool {
        let due = self.done.checkpoint.is_some_and(|c| c.is_due());
        // Before the first sample there is nothing to save.
        let there = self.samples.load(Ordering::Relaxed) > 0;
        there && (due || self.interrupt.save_requested())
    }

    fn paused(&self, spent: &Spent, film: &Film) {
        self.interrupt.saves();
        let Some(checkpoint) = self.done.checkpoint else {
            return self.done.write_so_far(spent, film);
        };
        // An older checkpoint is still there, and the next may fare better: no reason to stop.
        if let Err(e) = checkpoint.save(spent, film) {
            tracing::warn!("no checkpoint: {e}; rendering goes on");
        }
    }
}

/// Which part of the work is done, by the limit that will be reached first. The error of a mean
/// falls with the root of the samples, so noise tells the part by its square.
fn fraction_done(
    limits: &Limits,
    pixels: u64,
    samples: u64,
    elapsed: Duration,
    noise: Option<Noise>,
) -> f64 {
    let by_samples = samples as f64 / (pixels as f64 * limits.spp as f64);
    let by_time = limits
        .time
        .map_or(0.0, |t| elapsed.as_secs_f64() / t.as_secs_f64());
    let by_noise = match (limits.noise, noise) {
        (Some(target), Some(noise)) => f64::from(target / noise.at_most()).powi(2),
        _ => 0.0,
    };
    by_samples.max(by_time).max(by_noise).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_that_comes_first_tells_how_far_things_are() {
        let limits = |spp, time, noise| Limits { spp, time, noise };
        let done = |limits: Limits, noise: Option<f32>| {
            let noise = noise.map(|value| Noise {
                value,
                error: 0.0,
                worst: 0.0,
            });
            fraction_done(&limits, 100, 1000, Duration::from_secs(30), noise)
        };
        let minute = Some(Duration::from_secs(60));
        assert_eq!(done(limits(40, None, None), None), 0.25);
        assert_eq!(done(limits(40, minute, None), None), 0.5);
        assert_eq!(done(limits(40, minute, Some(0.5)), None), 0.5);
        assert_eq!(done(limits(40, minute, Some(0.5)), Some(0.5)), 1.0);
        assert_eq!(done(limits(u64::MAX, None, Some(0.5)), Some(1.0)), 0.25);
        assert_eq!(done(limits(5, None, None), None), 1.0);
    }
}
