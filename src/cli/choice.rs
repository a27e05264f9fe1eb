//! Words that stand for values of the folders below. One table gives what may be typed, what
//! `--help` says of it, and the value: those folders need not know the command line, and no second
//! list of their variants has to be kept.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Command, Error};
use std::ffi::OsStr;

/// Words, each with its value and what it means.
#[derive(Clone, Copy, Debug)]
pub struct Choice<T: 'static>(pub &'static [(&'static str, T, &'static str)]);

/// Writes a choice as its words: what is said above one is what `--help` says.
macro_rules! choice {
    ($($(#[doc = $meaning:literal])+ $word:literal => $value:expr,)+) => {
        $crate::cli::choice::Choice(&[$(($word, $value, concat!($($meaning),+))),+])
    };
}
pub(super) use choice;

impl<T: PartialEq> Choice<T> {
    /// The word for a value.
    pub fn word(&self, value: &T) -> &'static str {
        let known = self.0.iter().find(|(_, known, _)| known == value);
        known.map_or("", |(word, ..)| word)
    }
}

impl<T> Choice<T> {
    fn words(&self) -> impl Iterator<Item = PossibleValue> + use<T> {
        let words = self.0.iter();
        words.map(|(word, _, meaning)| PossibleValue::new(*word).help(meaning.trim_start()))
    }
}

impl<T: Clone + Send + Sync> TypedValueParser for Choice<T> {
    type Value = T;

    fn parse_ref(&self, cmd: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<T, Error> {
        let typed = PossibleValuesParser::new(self.words()).parse_ref(cmd, arg, value)?;
        let known = self.0.iter().find(|(word, ..)| *word == typed);
        known
            .map(|(_, value, _)| value.clone())
            .ok_or_else(|| Error::new(ErrorKind::InvalidValue).with_cmd(cmd))
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(self.words()))
    }
}
