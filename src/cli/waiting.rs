//! What is shown while one waits for work that says nothing itself: on a terminal a line that
//! moves, elsewhere a line now and then.

use super::bar::{BAR_INTERVAL, LONGEST_SILENCE, fitting, spinner};
use super::console::Console;
use crate::integrate::training::traced;
use crate::report::words;
use indicatif::ProgressBar;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// Shows that work goes on, until it is dropped.
pub struct Waiting {
    /// Hangs up to say that it is over.
    over: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Waiting {
    /// For a field that is learned. `records` are the photons and paths that there will be, if that
    /// is known.
    pub fn for_learning(console: &Console, records: Option<u64>) -> Self {
        let before = traced();
        Self::start(console, move |seconds| {
            sentence(traced() - before, records, seconds)
        })
    }

    /// From now on; `text` says what goes on, given the seconds since.
    pub fn start(console: &Console, text: impl Fn(f64) -> String + Send + 'static) -> Self {
        if !console.shows_progress() {
            return Self {
                over: None,
                thread: None,
            };
        }
        let bar = console
            .has_terminal()
            .then(|| console.bars().add(spinner()));
        let (over, ended) = channel();
        let show = move || show(&ended, bar.as_ref(), text);
        Self {
            over: Some(over),
            // Where no thread can be had, nothing is shown.
            thread: std::thread::Builder::new().spawn(show).ok(),
        }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        self.over = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn show(ended: &Receiver<()>, bar: Option<&ProgressBar>, text: impl Fn(f64) -> String) {
    let start = Instant::now();
    let interval = match bar {
        Some(_) => BAR_INTERVAL,
        None => LONGEST_SILENCE,
    };
    while ended.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
        let text = text(start.elapsed().as_secs_f64());
        match bar {
            Some(bar) => {
                bar.set_message(fitting(text));
                bar.tick();
            }
            None => tracing::info!("{text}"),
        }
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

fn sentence(done: u64, records: Option<u64>, seconds: f64) -> String {
    // A look at where paths go comes before, and counts as well.
    let done = records.map_or(done, |all| done.min(all));
    let count = words::count(done as f64);
    let of = match records {
        Some(all) => format!("{count} of {}", words::count(all as f64)),
        None => count,
    };
    format!("learning: {of} photons and paths, {}", words::time(seconds))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_far_learning_is() {
        assert_eq!(
            sentence(500_000, Some(2_500_000), 12.34),
            "learning: 500 k of 2.50 M photons and paths, 12.3 s"
        );
        assert!(sentence(u64::MAX, Some(u64::MAX), 1e9).len() < 70);
    }
}
