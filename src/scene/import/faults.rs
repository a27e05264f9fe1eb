//! What is wrong with a scene: all of it at once, in the order of its lines.
//!
//! Reading goes on behind a mistake with something plain in its place. At the end everything that
//! was wrong is one error; with [`lenient`](crate::scene::import::ImportOptions::lenient), a
//! warning each that says what took its place.

use super::{ImportError, Location};
use std::cell::RefCell;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::path::PathBuf;

/// A place in one of the files of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct At {
    /// Index of the file.
    pub file: usize,
    /// Line, from 1.
    pub line: u32,
    /// Column in characters, from 1.
    pub column: u32,
}

impl At {
    /// The same with the name of its file among `files`.
    pub fn among(self, files: &[PathBuf]) -> Location {
        Location {
            file: files.get(self.file).cloned().unwrap_or_default(),
            line: self.line,
            column: self.column,
        }
    }
}

/// Errors that are listed; the others are counted.
const MOST_LISTED: usize = 100;

/// Bytes of a message. A value of the scene that it quotes may be longer than anyone reads.
const LONGEST: usize = 1000;

/// Cuts a message that is too long.
fn shorten(message: &mut String) {
    if message.len() > LONGEST {
        let end = (0..=LONGEST).rev().find(|i| message.is_char_boundary(*i));
        message.truncate(end.unwrap_or(0));
        message.push_str(" ...");
    }
}

/// Something wrong, and what takes its place.
#[derive(Clone, Debug)]
struct Fault {
    at: At,
    error: ImportError,
    instead: &'static str,
}

/// Everything found so far.
#[derive(Debug, Default)]
pub(super) struct Faults(RefCell<Vec<Fault>>);

impl Faults {
    /// Notes what is wrong because of what stands at `at`.
    pub fn add(&self, at: At, mut error: ImportError, instead: &'static str) {
        shorten(&mut error.message);
        self.0.borrow_mut().push(Fault { at, error, instead });
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.0.borrow().len()
    }

    /// Forgets all but the first `count`.
    pub fn truncate(&self, count: usize) {
        self.0.borrow_mut().truncate(count);
    }

    /// In the order of files and lines, each once.
    fn sorted(&self) -> Vec<Fault> {
        let mut list = self.0.borrow().clone();
        list.sort_by_key(|f| (f.at.file, f.at.line, f.at.column));
        let mut told = HashSet::new();
        list.retain(|f| told.insert(f.error.to_string()));
        list
    }

    /// Each as a warning.
    pub fn warnings(&self) -> Vec<String> {
        let warning = |f: Fault| {
            // What to do about it stands on a line of its own behind an error.
            let error = ImportError {
                help: None,
                ..f.error
            };
            format!("{error}; {}", f.instead)
        };
        self.sorted().into_iter().map(warning).collect()
    }

    /// All of them as one error; `None` if nothing is wrong.
    pub fn error(&self) -> Option<ImportError> {
        let list = self.sorted();
        let mut errors = list.iter().map(|f| &f.error);
        let mut whole = errors.next()?.clone();
        if list.len() == 1 {
            return Some(whole);
        }
        let mut helped = HashSet::new();
        if let Some(help) = whole.help.take() {
            let _ = write!(whole.message, "\n  help: {help}");
            helped.insert(help);
        }
        for error in errors.take(MOST_LISTED - 1) {
            let mut error = error.clone();
            // The same advice a hundred times helps no more than once.
            error.help = error.help.filter(|help| helped.insert(help.clone()));
            let _ = write!(whole.message, "\n{error}");
        }
        if list.len() > MOST_LISTED {
            let _ = write!(whole.message, "\nand {} more", list.len() - MOST_LISTED);
        }
        let _ = write!(whole.message, "\n{} errors", list.len());
        Some(whole)
    }
}
