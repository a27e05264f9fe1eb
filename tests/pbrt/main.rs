//! pbrt's scene files: the same scenes as in Mitsuba's language, and hostile ones.

#[path = "../support/mod.rs"]
mod support;

mod agreement;
mod agreement_images;
mod agreement_v3;
mod coated;
mod hostile;
mod pair;
mod stage;
mod told;
