//! One run: the same program, started anew, so that a crash is one run that failed, and the command
//! in the report is the one that ran.

use crate::cli::failure::INTERRUPTED;
use crate::cli::farm::quote;
use crate::cli::interrupt::Interrupt;
use crate::report::sweep::RunStats;
use rustix::process::{Pid, Signal, kill_process};
use std::ffi::OsString;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Time between two looks at a run.
const INTERVAL: Duration = Duration::from_millis(10);

/// Time to end in after a request.
const GRACE: Duration = Duration::from_secs(5);

/// What came of a run.
pub enum Outcome {
    /// It measured.
    Measured(Box<RunStats>),
    /// It did not end in its time, and was ended.
    TooLate,
    /// It ended without, and why.
    Failed(String),
    /// The user wants an end: it was ended, too.
    Interrupted,
}

/// The words as one would type them.
pub fn typed(words: &[String]) -> String {
    let words = words.iter().map(|w| quote(w));
    let all: Vec<String> = std::iter::once("twintree".into()).chain(words).collect();
    all.join(" ")
}

/// Runs the program with these words, for `longest` at most, and reads what it writes to `stats`.
/// Without words that start it, it is this one's file.
pub fn run(
    (program, words): (&[OsString], &[String]),
    stats: &Path,
    longest: Duration,
    interrupt: &Interrupt,
) -> Outcome {
    // What an earlier run has left must not be taken for this one's.
    let _ = std::fs::remove_file(stats);
    let itself = match program {
        [] => std::env::current_exe().map(|file| vec![file.into_os_string()]),
        _ => Ok(program.to_vec()),
    };
    let child = itself.and_then(|start| {
        let mut command = Command::new(&start[0]);
        command.args(&start[1..]).args(words).stdin(Stdio::null());
        command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn()
    });
    let mut child = match child {
        Ok(child) => child,
        Err(e) => return Outcome::Failed(format!("it cannot be started: {e}")),
    };
    let messages = listen(&mut child);
    let ended = wait(&mut child, longest, interrupt);
    let messages = messages.and_then(|m| m.join().ok()).unwrap_or_default();
    let status = match ended {
        Ended::Itself(status) => status,
        Ended::TooLate => return Outcome::TooLate,
        Ended::Interrupted => return Outcome::Interrupted,
    };
    // The terminal's Ctrl-C reaches the run as well, and perhaps before us.
    if status.code() == Some(i32::from(INTERRUPTED)) {
        return Outcome::Interrupted;
    }
    if !status.success() {
        return Outcome::Failed(format!("{status}: {}", said(&messages)));
    }
    let measured = std::fs::read(stats).map_err(|e| e.to_string());
    match measured.and_then(|bytes| serde_json::from_slice(&bytes).map_err(|e| e.to_string())) {
        Ok(stats) => Outcome::Measured(stats),
        Err(e) => Outcome::Failed(format!("{}: {e}", stats.display())),
    }
}

/// The line of the messages that says what is wrong.
fn said(messages: &str) -> &str {
    let lines = || messages.lines().map(str::trim).filter(|l| !l.is_empty());
    let error = lines().find_map(|l| l.strip_prefix("error: "));
    error.or(lines().next_back()).unwrap_or("no message")
}

enum Ended {
    Itself(ExitStatus),
    TooLate,
    Interrupted,
}

fn wait(child: &mut Child, longest: Duration, interrupt: &Interrupt) -> Ended {
    let start = Instant::now();
    let ended = loop {
        // A run that has ended is not to be signalled: its number may be another's by now.
        match child.try_wait() {
            Ok(None) => {}
            Ok(Some(status)) if !interrupt.requested() => return Ended::Itself(status),
            Ok(Some(_)) | Err(_) => return Ended::Interrupted,
        }
        if interrupt.requested() {
            break Ended::Interrupted;
        }
        if start.elapsed() > longest {
            break Ended::TooLate;
        }
        std::thread::sleep(INTERVAL);
    };
    end(child);
    ended
}

/// Ends a run: kindly, so that it takes its unfinished files away, and by force where that takes
/// long.
fn end(child: &mut Child) {
    // Whatever fails here fails because the run has ended already.
    let _ = kill_process(Pid::from_child(child), Signal::TERM);
    let start = Instant::now();
    while start.elapsed() < GRACE && matches!(child.try_wait(), Ok(None)) {
        std::thread::sleep(INTERVAL);
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// Collects the messages, so that the run never waits for somebody to read them.
fn listen(child: &mut Child) -> Option<std::thread::JoinHandle<String>> {
    let mut pipe = child.stderr.take()?;
    let collect = move || {
        let mut bytes = Vec::new();
        let _ = pipe.read_to_end(&mut bytes);
        String::from_utf8_lossy(&bytes).into_owned()
    };
    std::thread::Builder::new().spawn(collect).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_that_says_what_is_wrong_is_found() {
        let messages = "warning: odd\nerror: no such file\n  help: name another\n";
        assert_eq!(said(messages), "no such file");
        assert_eq!(said("thread panicked\nat the end\n\n"), "at the end");
        assert_eq!(said(""), "no message");
    }
}
