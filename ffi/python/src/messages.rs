//! The program's messages. They come from any thread, and wait here until the one that holds
//! Python's lock hands them to `logging`, under the name `twintree`.

use pyo3::prelude::*;
use std::fmt::Write as _;
use std::sync::{Mutex, Once, PoisonError};
use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Level, Metadata, Subscriber};

/// Messages that wait, at most: what comes beyond is lost.
const MOST: usize = 10_000;

static WAITING: Mutex<Vec<(Level, String)>> = Mutex::new(Vec::new());

/// Takes messages from the program.
struct Listener;

/// The words of an event.
#[derive(Default)]
struct Words(String);

impl Visit for Words {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "message" {
            // Writing to a string cannot fail.
            let _ = write!(self.0, "{value:?}");
        }
    }
}

impl Subscriber for Listener {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        *metadata.level() <= Level::INFO && metadata.target().starts_with("twintree")
            || metadata.target().starts_with("_native")
    }

    fn new_span(&self, _: &Attributes<'_>) -> Id {
        Id::from_u64(1)
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, event: &Event<'_>) {
        let mut words = Words::default();
        event.record(&mut words);
        let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.len() < MOST {
            waiting.push((*event.metadata().level(), words.0));
        }
    }

    fn enter(&self, _: &Id) {}

    fn exit(&self, _: &Id) {}
}

/// Begins to listen, once.
pub fn listen() {
    static BEGUN: Once = Once::new();
    BEGUN.call_once(|| {
        // Fails only where another part of the process listens already.
        let _ = tracing::subscriber::set_global_default(Listener);
    });
}

/// Hands what waits to `logging`.
pub fn hand_over(py: Python<'_>) -> PyResult<()> {
    let messages = {
        let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
        std::mem::take(&mut *waiting)
    };
    if messages.is_empty() {
        return Ok(());
    }
    let logger = py
        .import("logging")?
        .call_method1("getLogger", ("twintree",))?;
    for (level, text) in messages {
        let method = match level {
            Level::ERROR => "error",
            Level::WARN => "warning",
            _ => "info",
        };
        // The text stands for itself: a per cent sign in it is no format.
        logger.call_method1(method, ("%s", crate::failure::in_keywords(&text)))?;
    }
    Ok(())
}
