//! What goes wrong, as Python's exceptions with the program's words.
//!
//! | exception | when |
//! |---|---|
//! | `ValueError` | a setting, a scene, an array or a file is wrong |
//! | `TypeError` | there is no such setting, or an array is of no numbers |
//! | `RuntimeError` | the machine refused, samples were not finite (`strict`), or an internal error |
//! | `KeyboardInterrupt` | Ctrl-C came before there was anything to keep |

use pyo3::exceptions::{PyKeyboardInterrupt, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use twintree::cli::Failure;
use twintree::guide::GuideError;
use twintree::scene::import::ImportError;

/// An exception that is yet to be raised: made on threads that know no Python.
pub enum Fault {
    /// `ValueError`.
    Value(String),
    /// `TypeError`.
    Type(String),
    /// `RuntimeError`.
    Runtime(String),
    /// `KeyboardInterrupt`.
    Interrupt,
}

impl From<Failure> for Fault {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Wrong(text) => Self::Value(in_keywords(&text)),
            Failure::Refused(text) | Failure::Invalid(text) | Failure::Passed(text) => {
                Self::Runtime(in_keywords(&text))
            }
            Failure::Interrupted | Failure::Checkpointed => Self::Interrupt,
        }
    }
}

impl From<ImportError> for Fault {
    fn from(error: ImportError) -> Self {
        Failure::from(error).into()
    }
}

impl From<GuideError> for Fault {
    fn from(error: GuideError) -> Self {
        Failure::from(error).into()
    }
}

impl From<Fault> for PyErr {
    fn from(fault: Fault) -> Self {
        match fault {
            Fault::Value(text) => PyValueError::new_err(text),
            Fault::Type(text) => PyTypeError::new_err(text),
            Fault::Runtime(text) => PyRuntimeError::new_err(text),
            Fault::Interrupt => PyKeyboardInterrupt::new_err(()),
        }
    }
}

/// The program's words with its options as keyword arguments: `--max-depth <N>` is `max_depth`.
pub fn in_keywords(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("--") {
        let (before, option) = rest.split_at(at);
        out.push_str(before);
        let name = &option[2..];
        let is_part = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let end = name.find(|c| !is_part(c)).unwrap_or(name.len());
        // A dash in a sentence, or a line of them, is no option.
        if end < 2 || name.starts_with('-') || before.ends_with(|c: char| c.is_alphanumeric()) {
            out.push_str("--");
            rest = name;
            continue;
        }
        out.push_str(&name[..end].trim_end_matches('-').replace('-', "_"));
        rest = without_placeholder(&name[end..]);
    }
    out + rest
}

/// What follows ` <NAME>` or `=<NAME>`.
fn without_placeholder(text: &str) -> &str {
    let inside = text.strip_prefix(" <").or(text.strip_prefix("=<"));
    inside
        .and_then(|t| t.split_once('>'))
        .map_or(text, |(_, rest)| rest)
}
