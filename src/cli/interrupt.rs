//! Ctrl-C and SIGTERM. While rendering, the first asks for an end after the tiles in flight, so that the
//! image so far is written; the second quits at once. Before and after there is nothing to save, and the
//! first quits.

use super::failure::{Failure, INTERRUPTED};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the user asked for an end.
#[derive(Clone, Debug, Default)]
pub struct Interrupt {
    state: Arc<State>,
}

#[derive(Debug, Default)]
struct State {
    /// There is something to save.
    patient: AtomicBool,
    requested: AtomicBool,
}

impl Interrupt {
    /// Starts to listen.
    ///
    /// # Errors
    /// When the system refuses a signal handler.
    pub fn listen() -> Result<Self, Failure> {
        let interrupt = Self::default();
        let state = interrupt.state.clone();
        let handler = move || {
            let again = state.requested.swap(true, Ordering::SeqCst);
            if again || !state.patient.load(Ordering::SeqCst) {
                std::process::exit(i32::from(INTERRUPTED));
            }
            tracing::info!("stopping: the image so far will be written (again to quit at once)");
        };
        ctrlc::set_handler(handler)
            .map_err(|e| Failure::Refused(format!("signals cannot be handled: {e}")))?;
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
}
