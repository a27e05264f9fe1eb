//! Tests of what camera paths tell and how long they live.

mod record;
mod roulette;
