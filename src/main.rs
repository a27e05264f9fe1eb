//! The command line: parses it, runs the command, turns the outcome into an exit code.

use std::process::ExitCode;
use twintree::cli::{Cli, console, failure};

fn main() -> ExitCode {
    let cli = Cli::read();
    console::report_panics();
    match std::panic::catch_unwind(|| cli.run()) {
        Ok(Ok(())) => ExitCode::SUCCESS,
        Ok(Err(failure)) => {
            if let Some(text) = failure.text() {
                console::print_error(&text);
            }
            ExitCode::from(failure.exit_code())
        }
        Err(_) => ExitCode::from(failure::FAILED),
    }
}
