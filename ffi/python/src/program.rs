//! The command line itself, for `python -m twintree`: in a process of its own, whose signals,
//! terminal and threads it takes over.

use pyo3::prelude::*;
use std::ffi::OsString;
use twintree::cli::{Cli, console};

/// Runs the command line with these words, the program's name before them, and returns the exit
/// code. `program` are the words that start it.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>, program: Vec<OsString>) -> u8 {
    py.detach(|| {
        let mut cli = match Cli::read_from(words) {
            Ok(cli) => cli,
            Err(e) => {
                // Where nobody takes the words, the code says it all the same.
                let _ = e.print();
                return e.exit_code() as u8;
            }
        };
        cli.program = program;
        match cli.run() {
            Ok(()) => 0,
            Err(failure) => {
                if let Some(text) = failure.text() {
                    console::print_error(&text);
                }
                failure.exit_code()
            }
        }
    })
}
