//! What all queues are to run.

use super::args::FarmArgs;
use super::words::{self, Words};
use crate::cli::Failure;
use std::path::Path;

/// An image cut into jobs. Names of files are as they were typed: jobs run in the same directory.
#[derive(Debug)]
pub struct Plan {
    /// What the job is called: the first image's name without its end, in letters that every queue
    /// takes.
    pub name: String,
    /// The command line that this was made by.
    pub made_by: String,
    /// Number of shards.
    pub shards: u32,
    /// How many run at once.
    pub slots: u32,
    /// Threads of a shard, if that was said.
    pub threads: Option<String>,
    /// The directory for the parts.
    pub parts: String,
    words: Words,
}

/// Between checkpoints, unless told otherwise: what a machine that dies may cost.
const CHECKPOINT: &str = "60s";

impl Plan {
    /// Takes the command line apart.
    ///
    /// # Errors
    /// When `twintree render` would not take the words, or a farm cannot.
    pub fn new(args: &FarmArgs, threads: Option<u16>) -> Result<Self, Failure> {
        let mut words = words::sort(&args.render)?;
        if words.outputs.is_empty() {
            let stem = Path::new(words.scene.first().map_or("", String::as_str))
                .file_stem()
                .unwrap_or_default();
            words.outputs = vec![format!("{}.exr", stem.to_string_lossy())];
        }
        let first = words.outputs.first().cloned().unwrap_or_default();
        let threads = words.threads.take().or(threads.map(|n| n.to_string()));
        Ok(Self {
            name: name_of(Path::new(&first)),
            made_by: std::iter::once("twintree".to_owned())
                .chain(std::env::args().skip(1).map(|word| quote(&word)))
                .collect::<Vec<_>>()
                .join(" "),
            shards: args.shards,
            slots: args.slots.unwrap_or(args.shards).min(args.shards),
            threads,
            parts: format!("{first}.parts"),
            words,
        })
    }

    /// The number of the last shard.
    pub fn last(&self) -> u32 {
        self.shards - 1
    }

    /// The shell's command to make the directory of the parts.
    pub fn prepare(&self) -> String {
        format!("mkdir -p {}", quote(&self.parts))
    }

    /// The shell's command to learn the field that all shards are guided by, if they are.
    pub fn train(&self, threads: Option<&str>) -> Option<String> {
        let words = self.words.train.as_ref()?;
        let mut line = vec![PROGRAM.to_owned(), "train".into()];
        line.extend(self.words.scene.iter().map(|word| quote(word)));
        line.extend(words.iter().map(|word| quote(word)));
        line.push(format!("-o {}", self.field()));
        line.extend(threads.map(|n| format!("-j {n}")));
        Some(line.join(" "))
    }

    fn field(&self) -> String {
        quote(&format!("{}/light.field", self.parts))
    }

    /// The shell's command to render a shard, whose number is what the shell makes of `index`;
    /// `threads` is its number of threads, likewise.
    pub fn shard(&self, index: &str, threads: Option<&str>) -> String {
        let mut line = vec![PROGRAM.to_owned(), "render".into()];
        line.extend(self.words.scene.iter().map(|word| quote(word)));
        line.extend(self.words.render.iter().map(|word| quote(word)));
        if self.words.train.is_some() {
            line.push(format!("--field {}", self.field()));
        }
        let count = self.shards;
        line.push(format!("--shard \"{index}/{count}\""));
        line.push(format!(
            "-o {}/\"{index}-of-{count}.exr\"",
            quote(&self.parts)
        ));
        let interval = self.words.checkpoint.as_deref().unwrap_or(CHECKPOINT);
        line.push(format!("--checkpoint {} --resume", quote(interval)));
        line.extend(threads.map(|n| format!("-j {n}")));
        line.join(" ")
    }

    /// The shell's command to join the parts.
    pub fn merge(&self) -> String {
        // The number of shards is in the names: parts of another cut, left from an earlier day,
        // stay out.
        let parts = format!("{}/*-of-{}.exr", quote(&self.parts), self.shards);
        let mut line = vec![PROGRAM.to_owned(), "merge".into(), parts];
        let images = self.words.outputs.iter();
        line.extend(images.flat_map(|image| ["-o".into(), quote(image)]));
        line.extend(self.words.merge.iter().map(|word| quote(word)));
        line.join(" ")
    }
}

/// The program, which may be somewhere else on the machines of the farm.
const PROGRAM: &str = "\"${TWINTREE:-twintree}\"";

/// A word as a shell takes it for one.
pub fn quote(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:%+@".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

/// Lower-case letters, digits and single hyphens, at most 50: the strictest rule is Kubernetes's.
fn name_of(image: &Path) -> String {
    let stem = image.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = String::new();
    for c in stem.chars().take(50) {
        if c.is_ascii_alphanumeric() {
            name.push(c.to_ascii_lowercase());
        } else if !name.ends_with('-') {
            name.push('-');
        }
    }
    let name = name.trim_matches('-');
    if name.is_empty() { "twintree" } else { name }.to_owned()
}
