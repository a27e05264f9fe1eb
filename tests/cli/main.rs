//! What a user at the terminal notices: exit codes, messages, files.

mod alpha;
mod benching;
mod checkpoints;
mod comparing;
mod denoising;
#[cfg(feature = "oiio")]
mod displays;
mod endless;
mod errors;
mod farming;
mod fields;
mod frames;
mod generated;
mod guiding;
mod importing;
mod inspect;
mod invalid;
mod layers;
mod light;
mod losses;
mod messages;
mod models;
mod outputs;
mod scenes;
mod shards;
mod stopping;
mod support;
mod sweeping;
mod table1;
mod targets;
mod terminal;
mod usd;
mod words;
