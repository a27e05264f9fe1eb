//! Work without Python's lock. It runs on a pool of threads of its own, while the calling thread
//! looks ten times a second for Ctrl-C, shows progress and hands messages over.
//!
//! The pool lives as long as the call: no thread of it is left behind, so that a process may fork
//! between calls. What scenes use (the ray tracer, the cache of textures) does not survive a fork:
//! in a child of a process that has used it, it is refused in words.

use crate::failure::Fault;
use crate::messages;
use pyo3::prelude::*;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use twintree::cli::threads;

/// Time between two looks at signals.
const INTERVAL: Duration = Duration::from_millis(100);
/// The first looks come sooner, so that short work is not waited for.
const SHORT: Duration = Duration::from_millis(5);

/// The process that has used scenes; 0 is none.
static OWNER: AtomicU32 = AtomicU32::new(0);

/// Refuses scenes in a child of a process that has used them.
pub fn own_scenes() -> Result<(), Fault> {
    let here = std::process::id();
    match OWNER.compare_exchange(0, here, Ordering::SeqCst, Ordering::SeqCst) {
        Err(owner) if owner != here => Err(Fault::Runtime(
            "this process was forked from one that uses twintree's scenes, which do not survive that\n  \
             help: start workers with multiprocessing.get_context(\"spawn\"), or load scenes in the \
             workers alone"
                .into(),
        )),
        _ => Ok(()),
    }
}

/// What the calling thread does meanwhile, each time it looks; `done` says that it is the last.
pub trait Meanwhile {
    /// Shows how far things are.
    ///
    /// # Errors
    /// What Python raises: the work is asked to end then, too.
    fn look(&mut self, py: Python<'_>, done: bool) -> PyResult<()>;
}

impl Meanwhile for () {
    fn look(&mut self, _: Python<'_>, _: bool) -> PyResult<()> {
        Ok(())
    }
}

/// Runs `work` on so many threads. Ctrl-C sets `stop`, and the work ends when it sees that. Its
/// outcome and, if anything was raised meanwhile, what that was.
pub fn watched<T: Send>(
    py: Python<'_>,
    threads: Option<u16>,
    stop: &AtomicBool,
    meanwhile: &mut dyn Meanwhile,
    work: impl FnOnce() -> Result<T, Fault> + Send,
) -> PyResult<(Result<T, Fault>, Option<PyErr>)> {
    messages::listen();
    let mut raised = None;
    let outcome = std::thread::scope(|scope| {
        let (sender, mut ended) = channel();
        let run = move || {
            let outcome = caught(|| threads::pool(threads)?.install(work));
            // The receiver waits for it.
            let _ = sender.send(outcome);
        };
        let begun = std::thread::Builder::new().spawn_scoped(scope, run);
        begun.map_err(|e| Fault::Runtime(format!("no thread can be started: {e}")))?;
        let mut interval = SHORT;
        loop {
            let (receiver, patience) = (&mut ended, interval);
            let outcome = py.detach(move || receiver.recv_timeout(patience));
            let last = !matches!(outcome, Err(RecvTimeoutError::Timeout));
            let looked = py
                .check_signals()
                .and_then(|()| messages::hand_over(py))
                .and_then(|()| meanwhile.look(py, last));
            if let Err(e) = looked {
                stop.store(true, Ordering::SeqCst);
                raised.get_or_insert(e);
            }
            match outcome {
                Ok(outcome) => return outcome,
                Err(RecvTimeoutError::Timeout) => interval = (2 * interval).min(INTERVAL),
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(Fault::Runtime("the work has ended without a word".into()));
                }
            }
        }
    });
    Ok((outcome, raised))
}

/// The same for work that cannot be ended early: what was raised meanwhile is raised in the end.
pub fn run<T: Send>(
    py: Python<'_>,
    threads: Option<u16>,
    work: impl FnOnce() -> Result<T, Fault> + Send,
) -> PyResult<T> {
    let (outcome, raised) = watched(py, threads, &AtomicBool::new(false), &mut (), work)?;
    match raised {
        Some(e) => Err(e),
        None => Ok(outcome?),
    }
}

/// A panic is an error of the program, and ends nothing else.
fn caught<T>(work: impl FnOnce() -> Result<T, Fault>) -> Result<T, Fault> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| Err(told(&*panic)))
}

fn told(panic: &(dyn Any + Send)) -> Fault {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text.or(panic.downcast_ref::<&str>().copied());
    let text = text.unwrap_or("no message");
    Fault::Runtime(format!(
        "an internal error of twintree, please report it: {text}"
    ))
}
