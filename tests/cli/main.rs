//! What a user at the terminal notices: exit codes, messages, files.

mod benching;
mod comparing;
mod errors;
mod fields;
mod generated;
mod inspect;
mod messages;
mod outputs;
mod stopping;
mod support;
