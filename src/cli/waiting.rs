//! What is shown while one waits for work that says nothing itself: on a terminal a line that
//! moves, elsewhere a line now and then.

use super::bar::{BAR_INTERVAL, LONGEST_SILENCE, Part, columns, drawn, fitting, line};
use super::console::Console;
use crate::integrate::training::{expected, traced};
use crate::report::words;
use indicatif::ProgressBar;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Instant;

/// What there is to say at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Said {
    /// Share of the work that is done, if that is known.
    done: Option<f64>,
    /// In words.
    parts: Vec<Part>,
}

impl Said {
    /// That so much of the work is done, if that is known, and in words.
    pub fn new(done: Option<f64>, parts: Vec<Part>) -> Self {
        Self { done, parts }
    }
}

impl From<String> for Said {
    fn from(text: String) -> Self {
        Self {
            done: None,
            parts: vec![Part::new(0, text)],
        }
    }
}

/// Shows that work goes on, until it is dropped.
pub struct Waiting {
    /// Hangs up to say that it is over.
    over: Option<Sender<()>>,
    thread: Option<JoinHandle<()>>,
}

impl Waiting {
    /// For a field that is learned. `records` are the photons and paths that there will be; where
    /// that is not given, it is what things look like.
    pub fn for_learning(console: &Console, records: Option<u64>) -> Self {
        let before = traced();
        Self::start(console, move |seconds| {
            // What was expected counts from the beginning, and `records` from now on.
            match records {
                Some(all) => learning(traced() - before, Some(all), seconds),
                None => learning(traced(), expected(), seconds),
            }
        })
    }

    /// From now on; `text` says what goes on, given the seconds since.
    pub fn start<S: Into<Said>>(
        console: &Console,
        text: impl Fn(f64) -> S + Send + 'static,
    ) -> Self {
        if !console.shows_progress() {
            return Self {
                over: None,
                thread: None,
            };
        }
        let bar = console.has_terminal().then(|| console.bars().add(line()));
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

fn show<S: Into<Said>>(ended: &Receiver<()>, bar: Option<&ProgressBar>, text: impl Fn(f64) -> S) {
    let start = Instant::now();
    let interval = match bar {
        Some(_) => BAR_INTERVAL,
        None => LONGEST_SILENCE,
    };
    let mut turns = 0;
    while ended.recv_timeout(interval) == Err(RecvTimeoutError::Timeout) {
        let said = text(start.elapsed().as_secs_f64()).into();
        match bar {
            Some(bar) => bar.set_message(said.on_terminal(turns, columns())),
            None => tracing::info!("{}", fitting(&said.parts, usize::MAX)),
        }
        turns += 1;
    }
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

impl Said {
    /// A line of so many columns: with a bar, or with something that turns.
    fn on_terminal(&self, turns: usize, columns: usize) -> String {
        match self.done {
            Some(done) => drawn(done, &self.parts, columns),
            None => {
                let turning = TURNING[turns % TURNING.len()];
                let room = columns.saturating_sub(BEHIND);
                format!("{turning} {}", fitting(&self.parts, room))
            }
        }
    }
}

/// What turns where nobody knows how long it takes.
const TURNING: [char; 4] = ['⠋', '⠙', '⠸', '⠴'];
/// Columns before the words, and those that stay free behind them.
const BEHIND: usize = 6;

/// How far learning is.
fn learning(done: u64, records: Option<u64>, seconds: f64) -> Said {
    // A look at where paths go comes before, and counts as well.
    let done = records.map_or(done, |all| done.min(all));
    let count = words::count(done as f64);
    let of = match records {
        Some(all) => format!("{count} of {}", words::count(all as f64)),
        None => count,
    };
    Said {
        done: records.map(|all| done as f64 / all.max(1) as f64),
        parts: vec![
            Part::new(0, format!("learning: {of} photons and paths")),
            Part::new(1, words::time(seconds)),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_says_how_far_learning_is() {
        let said = learning(500_000, Some(2_500_000), 12.34);
        let text = "learning: 500 k of 2.50 M photons and paths  12.3 s";
        assert_eq!(said.on_terminal(0, 80), format!("█░░░░░░░  20 %  {text}"));
        assert_eq!(fitting(&said.parts, usize::MAX), text);
        let unknown = learning(500_000, None, 1.0).on_terminal(1, 80);
        assert_eq!(unknown, "⠙ learning: 500 k photons and paths  1.00 s");
        for columns in 0..100 {
            let all = learning(u64::MAX, Some(u64::MAX), 1e9);
            for said in [all, "a sentence of some length".to_owned().into()] {
                let line = said.on_terminal(3, columns);
                assert!(line.chars().count() <= columns.max(2), "{columns}: {line}");
            }
        }
    }
}
