//! What a user at the terminal notices: exit codes, messages, files.

mod errors;
mod inspect;
mod invalid;
mod messages;
mod outputs;
mod stopping;
mod support;
