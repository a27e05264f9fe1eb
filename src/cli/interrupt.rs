//! Signals. While rendering, the first Ctrl-C (or SIGTERM, or SIGHUP) asks for an end after the tiles in
//! flight, so that what was rendered is kept; the second quits at once. Before and after there is nothing
//! to save, and the first quits. SIGUSR1, where a checkpoint is wanted, asks for one and for no end.
//! SIGXFSZ is heard and nothing more: a file that grows beyond its limit is an error of writing then, in
//! words, and not the end of the program.

use super::failure::{Failure, INTERRUPTED};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGXFSZ};
use signal_hook::iterator::Signals;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

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
}

impl Interrupt {
    /// Starts to listen; to SIGUSR1 only where `saves`, for elsewhere it is nobody's business.
    ///
    /// # Errors
    /// When the system refuses a signal handler.
    pub fn listen(saves: bool) -> Result<Self, Failure> {
        let refused = |e| Failure::Refused(format!("signals cannot be handled: {e}"));
        let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP, SIGXFSZ]).map_err(refused)?;
        if saves {
            signals.add_signal(SIGUSR1).map_err(refused)?;
        }
        let interrupt = Self::default();
        let state = interrupt.state.clone();
        std::thread::Builder::new()
            .name("signals".into())
            .spawn(move || signals.forever().for_each(|signal| state.hear(signal)))
            .map_err(refused)?;
        Ok(interrupt)
    }

    /// From now on there is something to save.
    pub fn be_patient(&self) {
        self.state.patient.store(true, Ordering::SeqCst);
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

    /// The checkpoint that was asked for is about to be written; what is asked for from now on is another one.
    pub fn saves(&self) {
        self.state.save.store(false, Ordering::Relaxed);
    }
}

impl State {
    fn hear(&self, signal: i32) {
        match signal {
            SIGXFSZ => return,
            SIGUSR1 => return self.save.store(true, Ordering::Relaxed),
            _ => {}
        }
        let again = self.requested.swap(true, Ordering::SeqCst);
        if again || !self.patient.load(Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
        tracing::info!("stopping: what is rendered so far will be kept (again to quit at once)");
    }
}
