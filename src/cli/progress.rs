//! How far a render is: a bar on a terminal, lines elsewhere.

use super::bar::{BAR_INTERVAL, LONGEST_SILENCE, Part, columns, drawn, fitting, line};
use super::console::Console;
use super::error_track::ErrorTrack;
use super::finish::Done;
use super::interrupt::Interrupt;
use super::preview::Tev;
use super::remaining::{Goal, History, Mark};
use super::waiting::Waiting;
use crate::film::{Film, Noise};
use crate::image::{LibraryLoading, library_is_missing};
use crate::integrate::progress::{Learning, Limits, Observer, Progress, Spent};
use crate::report::words;
use indicatif::ProgressBar;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Lines come at every tenth of the work, but not faster than this.
const SHORTEST_SILENCE: Duration = Duration::from_secs(1);

/// Watches a render for the person who waits.
pub struct Watch<'a> {
    interrupt: &'a Interrupt,
    console: &'a Console,
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
    /// What writes the image, from the first tile on.
    library: OnceLock<LibraryLoading>,
}

enum Display {
    Nothing,
    Bar(ProgressBar),
    Lines,
}

/// What was shown last, and what the passes have told.
struct Shown {
    at: Instant,
    tenths: u64,
    noise: Option<Noise>,
    history: History,
    aside: Aside,
}

/// Time that is not spent on drawing.
#[derive(Default)]
struct Aside {
    /// In all, what is under way left out.
    taken: Duration,
    /// What is under way, and since when.
    since: Option<(Learning, Instant)>,
    /// Tells of that.
    waiting: Option<Waiting>,
}

impl Aside {
    fn time(&self) -> Duration {
        self.taken
            + self
                .since
                .map_or(Duration::ZERO, |(_, since)| since.elapsed())
    }
}

impl<'a> Watch<'a> {
    /// Starts watching a render of `film`, which may go on from a checkpoint: `before` is the time
    /// it has taken already.
    pub fn start(
        interrupt: &'a Interrupt,
        console: &'a Console,
        limits: Limits,
        film: &Film,
        preview: Option<Tev>,
        (done, before): (&'a Done<'a>, Duration),
    ) -> Self {
        let display = match (console.shows_progress(), console.has_terminal()) {
            (false, _) => Display::Nothing,
            (true, false) => Display::Lines,
            (true, true) => Display::Bar(console.bars().add(line())),
        };
        let start = Instant::now();
        let (samples, pixels) = (film.samples_done(), film.held_pixels().max(1));
        Self {
            interrupt,
            console,
            done,
            track: None,
            before: (before, samples),
            limits,
            pixels,
            start,
            samples: AtomicU64::new(samples),
            display,
            shown: Mutex::new(Shown {
                at: start,
                tenths: 0,
                noise: None,
                history: History::from(samples as f64 / pixels as f64),
                aside: Aside::default(),
            }),
            preview: Mutex::new(preview),
            long_paths: AtomicBool::new(false),
            library: OnceLock::new(),
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
        let now = self.mark(&shown);
        let elapsed = self.before.0.as_secs_f64() + self.seconds();
        let left = shown.history.left(&self.goal(), now, elapsed);
        let done = left.map_or(0.0, |left| elapsed / (elapsed + left));
        let tenths = (done * 10.0) as u64;
        let parts = self.parts(now.spp, shown.noise, left);
        match &self.display {
            Display::Bar(bar) => bar.set_message(drawn(done, &parts, columns())),
            _ if tenths <= shown.tenths && silence < LONGEST_SILENCE => return,
            _ => {
                let text = fitting(&parts, usize::MAX);
                tracing::info!("{:>3.0} %  {text}", (done * 100.0).floor());
            }
        }
        shown.at = Instant::now();
        shown.tenths = tenths;
    }

    /// Seconds of this go, what measuring errors took left out.
    fn seconds(&self) -> f64 {
        let aside = self.time_aside();
        self.start.elapsed().saturating_sub(aside).as_secs_f64()
    }

    /// What the render has come to.
    fn mark(&self, shown: &Shown) -> Mark {
        Mark {
            spp: self.samples.load(Ordering::Relaxed) as f64 / self.pixels as f64,
            drawing: (self.seconds() - shown.aside.time().as_secs_f64()).max(0.0),
            noise: shown.noise.map(|noise| f64::from(noise.at_most())),
        }
    }

    fn goal(&self) -> Goal {
        let Limits { spp, time, noise } = self.limits;
        Goal {
            spp: if spp < u64::MAX {
                spp as f64
            } else {
                f64::INFINITY
            },
            seconds: time.map(|time| time.as_secs_f64()),
            noise: noise.map(f64::from),
        }
    }

    /// What there is to say.
    fn parts(&self, spp: f64, noise: Option<Noise>, left: Option<f64>) -> Vec<Part> {
        let samples = self.samples.load(Ordering::Relaxed) - self.before.1;
        let rate = samples as f64 / self.start.elapsed().as_secs_f64();
        let decimals = usize::from(spp < 99.95);
        let limit = match self.limits.spp {
            u64::MAX => String::new(),
            limit => format!("/{limit}"),
        };
        let mut parts = vec![
            Part::new(1, format!("{spp:.decimals$}{limit} spp")),
            Part::new(3, format!("{} samples/s", words::count(rate))),
        ];
        if let Some(noise) = noise {
            let target = self.limits.noise.map(|target| format!(" of {target}"));
            let target = target.unwrap_or_default();
            parts.push(Part::new(2, format!("noise {:.4}{target}", noise.value)));
        }
        parts.extend(left.map(|left| Part::new(0, format!("{} left", words::time(left)))));
        parts
    }
}

impl Observer for Watch<'_> {
    fn pass_done(&self, progress: &Progress, film: &Film) {
        if let Ok(mut shown) = self.shown.lock() {
            shown.noise = progress.noise;
            let mark = self.mark(&shown);
            shown.history.add(mark);
            let lessons = shown.history.lessons;
            tracing::debug!(
                "{:.0} spp: drawn in {:.2} s, the last lesson {:.2} s, taught {:.3}, {:.2} s aside",
                mark.spp,
                mark.drawing,
                lessons.seconds,
                lessons.share,
                shown.aside.taken.as_secs_f64()
            );
        }
        self.show();
        self.show_image(film, false);
        if let Some(track) = self.track {
            track.pass_done(progress, film);
        }
    }

    fn tile_done(&self, samples: u64) {
        self.samples.fetch_add(samples, Ordering::Relaxed);
        if self.done.args.parts.shard.is_none() {
            self.library.get_or_init(LibraryLoading::begin);
        }
        self.show();
    }

    fn learns(&self, how: Learning) {
        let waiting = match how {
            Learning::Paths | Learning::Photons => Waiting::for_learning(self.console, None),
            Learning::Trial => Waiting::start(self.console, |seconds| {
                format!("trying whether guiding pays, {}", words::time(seconds))
            }),
        };
        if let Ok(mut shown) = self.shown.lock() {
            shown.aside.since = Some((how, Instant::now()));
            shown.aside.waiting = Some(waiting);
        }
    }

    fn draws(&self, learned: f64) {
        let Ok(mut shown) = self.shown.lock() else {
            return;
        };
        if let Some((how, since)) = shown.aside.since.take() {
            let took = since.elapsed();
            shown.aside.taken += took;
            // Photons and trials come once: they tell nothing of the lessons to come.
            if how == Learning::Paths {
                let lessons = &mut shown.history.lessons;
                lessons.seconds = took.as_secs_f64();
                lessons.gain = learned - lessons.share;
            }
        }
        shown.history.lessons.share = learned;
        // Its thread has to see that it is over: nobody else is to wait for that.
        let waiting = shown.aside.waiting.take();
        drop(shown);
        drop(waiting);
    }

    fn should_stop(&self) -> bool {
        // Without what writes images, the work would be lost: the end says why.
        self.interrupt.requested() || library_is_missing()
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
