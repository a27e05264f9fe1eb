//! Tests of what camera paths tell and how long they live.

mod guiding;
mod record;
mod roulette;
