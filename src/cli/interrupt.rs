//! Signals. While rendering, the first Ctrl-C (or SIGTERM, or SIGHUP) asks for an end after the
//! tiles in flight, so that what was rendered is kept; the second quits at once. Before and after
//! there is nothing to save, and the first quits. Whoever quits takes unfinished files and the
//! progress bar away.
//!
//! What comes twice is often one request: `timeout` signals the program and then its whole group,
//! and a terminal that goes away sends SIGHUP, as the shell in it does. So what follows within
//! `ONE_REQUEST` of the first counts with it, and a SIGHUP never makes anybody impatient.
//!
//! A SIGHUP that was ignored when the program began (`nohup`) stays so.
//!
//! SIGUSR1 asks for a checkpoint, or for the image so far where none is kept, and for no end.
//! SIGXFSZ is heard and nothing more: a file that grows beyond its limit is an error of writing
//! then, in words, and not the end of the program.

use super::console::Console;
use super::failure::{Failure, INTERRUPTED};
use crate::image::passing;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Signals that come so soon after the first are the same request.
const ONE_REQUEST: Duration = Duration::from_millis(150);

/// What the user asked for by signals.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    state: Arc<State>,
}

#[derive(Debug, Default)]
struct State {
    /// There is something to save.
    patient: AtomicBool,
    requested: AtomicBool,
    save: AtomicBool,
    /// When an end was last asked for by SIGINT or SIGTERM.
    first: Mutex<Option<Instant>>,
}

/// What a signal comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Order {
    /// All is said already.
    Nothing,
    /// An end, with all saved.
    Stop,
    /// An end at once.
    Quit,
}

impl Interrupt {
    /// Starts to listen: before the first file is read or made.
    ///
    /// # Errors
    /// When the system refuses a signal handler.
    pub fn listen(console: &Console) -> Result<Self, Failure> {
        let refused = |e| Failure::Refused(format!("signals cannot be handled: {e}"));
        let signals = [SIGINT, SIGTERM, SIGXFSZ, SIGUSR1];
        let mut signals = Signals::new(signals).map_err(refused)?;
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        if !is_ignored(&status, SIGHUP) {
            signals.add_signal(SIGHUP).map_err(refused)?;
        }
        let interrupt = Self::default();
        let (state, console) = (interrupt.state.clone(), console.clone());
        std::thread::Builder::new()
            .name("signals".into())
            .spawn(move || {
                for signal in signals.forever() {
                    match state.hear(signal, Instant::now()) {
                        Order::Nothing => {}
                        Order::Stop => say_so(),
                        Order::Quit => quit(&console),
                    }
                }
            })
            .map_err(refused)?;
        Ok(interrupt)
    }

    /// From now on there is something to save.
    pub fn be_patient(&self) {
        self.state.patient.store(true, Ordering::SeqCst);
    }

    /// The render is over, and what comes now can be ended by itself: what was asked for before is
    /// done, and the next request is a new one.
    pub fn begin_anew(&self) {
        self.be_patient();
        self.state.requested.store(false, Ordering::SeqCst);
    }

    /// Whether an end was asked for.
    #[inline]
    pub fn requested(&self) -> bool {
        self.state.requested.load(Ordering::Relaxed)
    }

    /// Whether a checkpoint was asked for.
    #[inline]
    pub fn save_requested(&self) -> bool {
        self.state.save.load(Ordering::Relaxed)
    }

    /// The checkpoint that was asked for is about to be written; what is asked for from now on is
    /// another one.
    pub fn saves(&self) {
        self.state.save.store(false, Ordering::Relaxed);
    }
}

impl State {
    fn hear(&self, signal: i32, now: Instant) -> Order {
        match signal {
            SIGXFSZ => return Order::Nothing,
            SIGUSR1 => {
                self.save.store(true, Ordering::Relaxed);
                return Order::Nothing;
            }
            _ => {}
        }
        let mut first = self.first.lock().unwrap_or_else(PoisonError::into_inner);
        let late = |at: Instant| now.saturating_duration_since(at) > ONE_REQUEST;
        if signal != SIGHUP && first.is_some_and(|at| !late(at)) {
            return Order::Nothing;
        }
        let stopping = self.requested.swap(true, Ordering::SeqCst);
        if !self.patient.load(Ordering::SeqCst) {
            return Order::Quit;
        }
        let fresh = if stopping {
            Order::Nothing
        } else {
            Order::Stop
        };
        if signal == SIGHUP {
            return fresh;
        }
        if first.is_some() && stopping {
            return Order::Quit;
        }
        *first = Some(now);
        fresh
    }
}

/// Whether a signal is ignored, by a process's `/proc/PID/status`.
fn is_ignored(status: &str, signal: i32) -> bool {
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok());
    mask.unwrap_or(0) >> (signal - 1) & 1 == 1
}

/// On a thread of its own: where nobody takes the message, the next signal is heard all the same.
fn say_so() {
    let say = || {
        tracing::info!("stopping: what is rendered so far will be kept (again to quit at once)");
    };
    // Without the message the render stops as well.
    let _ = std::thread::Builder::new().spawn(say);
}

/// Ends the program without destructors: other threads are still at work with what they would
/// destroy.
fn quit(console: &Console) {
    passing::clear();
    console.leave();
    signal_hook::low_level::exit(i32::from(INTERRUPTED));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_comes_at_once_is_one_request_and_a_second_one_quits() {
        let start = Instant::now();
        let at = |ms| start + Duration::from_millis(ms);
        for (signals, expected) in [
            (vec![(SIGINT, 0), (SIGINT, 2000)], Order::Quit),
            (vec![(SIGTERM, 0), (SIGINT, 2000)], Order::Quit),
            // `timeout` signals the program, then its group.
            (vec![(SIGTERM, 0), (SIGTERM, 1)], Order::Nothing),
            (
                vec![(SIGTERM, 0), (SIGTERM, 1), (SIGTERM, 2000)],
                Order::Quit,
            ),
            // A terminal that goes away, and its shell.
            (vec![(SIGHUP, 0), (SIGHUP, 2000)], Order::Nothing),
            (vec![(SIGHUP, 0), (SIGTERM, 2000)], Order::Nothing),
            (vec![(SIGTERM, 0), (SIGHUP, 2000)], Order::Nothing),
            (
                vec![(SIGHUP, 0), (SIGTERM, 2000), (SIGTERM, 4000)],
                Order::Quit,
            ),
            (
                vec![(SIGUSR1, 0), (SIGXFSZ, 1), (SIGINT, 2000)],
                Order::Stop,
            ),
        ] {
            let state = State::default();
            state.patient.store(true, Ordering::SeqCst);
            let orders = signals.iter().map(|&(s, ms)| state.hear(s, at(ms)));
            assert_eq!(orders.last(), Some(expected), "{signals:?}");
            assert!(state.requested.load(Ordering::SeqCst));
        }
    }

    #[test]
    fn what_comes_after_the_render_is_ended_by_a_request_of_its_own() {
        let start = Instant::now();
        let interrupt = Interrupt::default();
        interrupt.be_patient();
        let hear = |signal, ms| {
            let at = start + Duration::from_millis(ms);
            interrupt.state.hear(signal, at)
        };
        assert_eq!(hear(SIGTERM, 0), Order::Stop);
        interrupt.begin_anew();
        // Still the request that has ended the render.
        assert_eq!(hear(SIGTERM, 1), Order::Nothing);
        assert!(!interrupt.requested());
        assert_eq!(hear(SIGINT, 2000), Order::Stop);
        assert!(interrupt.requested());
        assert_eq!(hear(SIGINT, 4000), Order::Quit);
    }

    #[test]
    fn what_is_ignored_is_read() {
        let status = "Name:\ttwintree\nSigIgn:\t0000000000001001\nSigCgt:\t0\n";
        assert!(is_ignored(status, SIGHUP));
        assert!(!is_ignored(status, SIGTERM) && !is_ignored("", SIGHUP));
    }

    #[test]
    fn the_first_quits_where_there_is_nothing_to_save() {
        for signal in [SIGINT, SIGTERM, SIGHUP] {
            let state = State::default();
            assert_eq!(state.hear(signal, Instant::now()), Order::Quit);
        }
        assert_eq!(
            State::default().hear(SIGUSR1, Instant::now()),
            Order::Nothing
        );
    }
}
