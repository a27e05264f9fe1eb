//! pbrt's scene files: the same scenes as in Mitsuba's language, and hostile ones.

#[path = "../support/mod.rs"]
mod support;

mod agreement;
mod coated;
mod hostile;
mod stage;
mod told;
