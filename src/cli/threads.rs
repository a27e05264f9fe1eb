//! The pool of threads that loads, builds and renders.

use super::Failure;
use crate::accel;
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};

/// Starts the pool; without a number, as many threads as the machine gives this process.
///
/// # Errors
/// When the system refuses the threads.
pub fn start(threads: Option<u16>) -> Result<(), Failure> {
    // The calling thread evaluates light too, and must round denormals as the others do.
    accel::prepare_thread();
    builder(threads).build_global().map_err(refused)
}

/// A pool of its own, for who embeds the program: what is installed in it runs on its threads alone.
///
/// # Errors
/// When the system refuses the threads.
pub fn pool(threads: Option<u16>) -> Result<ThreadPool, Failure> {
    builder(threads).build().map_err(refused)
}

fn builder(threads: Option<u16>) -> ThreadPoolBuilder {
    ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, usize::from))
        .thread_name(|i| format!("render {i}"))
        .start_handler(|_| accel::prepare_thread())
}

fn refused(e: ThreadPoolBuildError) -> Failure {
    let help = "ask for fewer with --threads";
    Failure::refused(format!("threads cannot be started: {e}"), help)
}

/// Threads of the pool.
pub fn count() -> usize {
    rayon::current_num_threads()
}
