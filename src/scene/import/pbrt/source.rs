//! The files of a scene, as statements.
//!
//! Files that others include or import are found in rounds: those of a round are parsed side by
//! side, and what they name makes the next round. A file that is named twice is parsed once. How
//! often each is applied is counted later, against what small files can grow to.

use super::statement::{self, Plugin, Statement, What};
use super::tokens::{Tokens, Wrong};
use crate::image::foreign;
use crate::scene::import::faults::{At, Faults};
use crate::scene::import::{ImportError, ImportOptions, Location, encoding, gzip, named};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Mistakes of one file that are told. Behind a hundred, no one reads on.
const MOST_WRONG: usize = 200;
/// Files of a scene.
const MOST_FILES: usize = 100_000;

/// All files of a scene.
#[derive(Debug, Default)]
pub(super) struct Source {
    /// By number: what places refer to.
    pub files: Vec<PathBuf>,
    /// By the same number.
    pub scripts: Vec<Script>,
    /// What is wrong.
    pub faults: Faults,
    /// The numbers of files.
    numbers: HashMap<PathBuf, usize>,
}

/// A file.
#[derive(Debug, Default)]
pub(super) struct Script {
    pub statements: Vec<Statement>,
    /// Its size as text.
    pub bytes: u64,
    /// By the names that it has for them, the files that it names.
    pub named: HashMap<String, usize>,
}

/// What parsing a file gives.
struct Parsed {
    statements: Vec<Statement>,
    bytes: u64,
    wrong: Vec<Wrong>,
}

impl Source {
    /// Reads a scene with all files that it is made of.
    ///
    /// # Errors
    /// When the main file cannot be read as text.
    pub fn read(path: &Path, options: &ImportOptions) -> Result<Self, ImportError> {
        let mut source = Self {
            files: vec![path.to_owned()],
            numbers: HashMap::from([(path.to_owned(), 0)]),
            ..Self::default()
        };
        let parsed = parse(path, 0, options).map_err(|message| ImportError {
            at: None,
            file: Some(path.to_owned()),
            message,
            help: None,
        })?;
        source.accept(parsed);
        let mut done = 0;
        while done < source.scripts.len() {
            let end = source.scripts.len();
            let asked: Vec<At> = (done..end).flat_map(|file| source.find(file)).collect();
            let first = source.scripts.len();
            let fresh = &source.files[first..];
            let parsed: Vec<_> = fresh
                .par_iter()
                .enumerate()
                .map(|(i, path)| parse(path, first + i, options))
                .collect();
            for (parsed, at) in parsed.into_iter().zip(asked) {
                match parsed {
                    Ok(parsed) => source.accept(parsed),
                    Err(message) => {
                        let path = source.files[source.scripts.len()].clone();
                        let hint = named::hint_of(&path);
                        let message = format!("{}: {message}{hint}", path.display());
                        source.fault(at, message, "it is left out");
                        source.scripts.push(Script::default());
                    }
                }
            }
            done = end;
        }
        Ok(source)
    }

    fn accept(&mut self, parsed: Parsed) {
        for Wrong { at, message } in parsed.wrong {
            self.fault(at, message, "it is left out");
        }
        self.scripts.push(Script {
            statements: parsed.statements,
            bytes: parsed.bytes,
            named: HashMap::new(),
        });
    }

    /// Numbers the files that a file names; those that are new are returned as the places that
    /// name them, in order.
    fn find(&mut self, file: usize) -> Vec<At> {
        let mut fresh = Vec::new();
        let mut named = HashMap::new();
        let statements = std::mem::take(&mut self.scripts[file].statements);
        for statement in &statements {
            let (What::Include(name) | What::Import(name)) = &statement.what else {
                continue;
            };
            if named.contains_key(name) || self.files.len() >= MOST_FILES {
                continue;
            }
            let path = self.resolve(statement.at, name);
            let known = self.numbers.get(&path).copied();
            let number = known.unwrap_or_else(|| {
                let number = self.files.len();
                self.numbers.insert(path.clone(), number);
                self.files.push(path);
                fresh.push(statement.at);
                number
            });
            named.insert(name.clone(), number);
        }
        let script = &mut self.scripts[file];
        (script.statements, script.named) = (statements, named);
        fresh
    }

    /// The file `name` that something at `at` asks for. As in pbrt, what is not absolute lies
    /// beside the main file; only what is not there is looked for beside the file that names it.
    pub fn resolve(&self, at: At, name: &str) -> PathBuf {
        let folder = |file: usize| {
            let parent = self.files.get(file).and_then(|f| f.parent());
            named::resolve(parent.unwrap_or(Path::new("")), name)
        };
        let beside_main = folder(0);
        if at.file == 0 || beside_main.exists() {
            return beside_main;
        }
        let own = folder(at.file);
        if own.exists() { own } else { beside_main }
    }

    /// A place with its file's name.
    pub fn location(&self, at: At) -> Location {
        at.among(&self.files)
    }

    /// An error at a place.
    pub fn error(&self, at: At, message: impl Into<String>) -> ImportError {
        ImportError {
            at: Some(self.location(at)),
            file: None,
            message: message.into(),
            help: None,
        }
    }

    /// Notes what is wrong at a place, and what takes its place.
    pub fn fault(&self, at: At, message: impl Into<String>, instead: &'static str) {
        self.faults.add(at, self.error(at, message), instead);
    }

    /// Notes an error that has a place of its own.
    pub fn fault_of(&self, at: At, error: ImportError, instead: &'static str) {
        self.faults.add(at, error, instead);
    }

    /// All plugins of all files, with their places.
    pub fn plugins(&self) -> impl Iterator<Item = (At, &Plugin)> {
        let statements = self.scripts.iter().flat_map(|s| &s.statements);
        statements.filter_map(|s| match &s.what {
            What::Plugin(plugin) => Some((s.at, &**plugin)),
            _ => None,
        })
    }
}

fn parse(path: &Path, file: usize, options: &ImportOptions) -> Result<Parsed, String> {
    let bytes = gzip::open(path, options.decode)?;
    if let Some(foreign) = foreign::by_head(&bytes) {
        return Err(foreign.to_string());
    }
    if let Some(wrong) = encoding::wide(&bytes) {
        return Err(format!("it {wrong}"));
    }
    let text = encoding::lines(&bytes);
    Ok(parse_text(&text, file))
}

fn parse_text(text: &[u8], file: usize) -> Parsed {
    let mut tokens = Tokens::new(text, encoding::start(text), file);
    let mut parsed = Parsed {
        statements: Vec::new(),
        bytes: text.len() as u64,
        wrong: Vec::new(),
    };
    loop {
        match statement::next(&mut tokens) {
            Ok(Some(statement)) => parsed.statements.push(statement),
            Ok(None) => return parsed,
            Err(wrong) => {
                parsed.wrong.push(wrong);
                if parsed.wrong.len() >= MOST_WRONG {
                    return parsed;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The speed that the manual names; run with `--release -- --ignored --nocapture`.
    #[test]
    #[ignore = "measures"]
    fn text_is_parsed_at_a_hundred_megabytes_a_second() {
        let mut text = String::from("Shape \"trianglemesh\" \"point3 P\" [\n");
        let mut rng = crate::math::Pcg32::new(1, 1);
        while text.len() < 200 << 20 {
            use std::fmt::Write as _;
            let [x, y, z] = [0; 3].map(|_| rng.next_f32() * 20.0 - 10.0);
            let _ = writeln!(text, "{x:.6} {y:.6} {z:.6}");
        }
        text.push_str("]\n");
        let start = std::time::Instant::now();
        let parsed = parse_text(text.as_bytes(), 0);
        let seconds = start.elapsed().as_secs_f64();
        let rate = text.len() as f64 * 1e-6 / seconds;
        println!("{rate:.0} MB/s in one thread");
        assert!(parsed.wrong.is_empty() && rate > 100.0);
    }
}
