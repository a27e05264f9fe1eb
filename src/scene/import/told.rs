//! Warnings, each told once.

use std::collections::HashSet;
use std::ops::Deref;

/// What was odd but not fatal, in the order in which it was found.
#[derive(Debug, Default)]
pub struct Told {
    list: Vec<String>,
    known: HashSet<String>,
}

impl Told {
    /// Adds a warning, unless the same was told before.
    pub fn tell(&mut self, warning: String) {
        if self.is_new(&warning) {
            self.list.push(warning);
        }
    }

    /// Whether these words are asked for the first time.
    pub fn is_new(&mut self, words: &str) -> bool {
        self.known.insert(words.to_owned())
    }

    /// All of them.
    pub fn into_list(self) -> Vec<String> {
        self.list
    }
}

impl Deref for Told {
    type Target = [String];

    fn deref(&self) -> &[String] {
        &self.list
    }
}
