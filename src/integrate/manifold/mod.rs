//! Manifold next-event estimation: light that comes by mirrors and clear glass, sampled.
//!
//! A matt point in a glass cube, or under a wave, sees the sun in a few directions, each of them
//! narrow: the rounded edge of the glass shows it a hundred times smaller than it is. No light
//! sample gets through the glass, and a field over directions cannot know that direction, for it is
//! another one from every point. Here it is found in two steps:
//!
//! 1. Before rendering, photons from small lights tell by which *specular chains* light comes into
//!    a region of space (`find.rs`). Each region keeps initial guesses (`guesses.rs`): where the
//!    light's image is seen, and how that direction turns with the receiver (`guess.rs`).
//! 2. At a receiver, a guess is drawn and Newton's method leads from there to the direction whose
//!    chain ends in the middle of the light (`newton.rs`). Ray differentials
//!    (`ray_differential.rs`) give the size of the image; a direction is drawn in it (`sample.rs`).
//!
//! Light that the path meets by itself, by the same chain, is weighed against that by multiple
//! importance sampling. That needs the density of any direction. It is the density of one guess
//! alone: of those with the direction's chain, the one that is seen next to it (`chains.rs`). What
//! another guess leads to there counts as nothing. Specular manifold sampling (Zeltner, Georgiev
//! and Jakob 2020) starts anywhere, so that it has no density; guesses that are known beforehand
//! have one.
//!
//! It changes no mean, whatever the guesses: light that they do not lead to is found by paths as
//! before. How often it is worth its rays is told by a trial ([`rate`]).
//!
//! Measurements are in `EXPERIMENTS.md` beside `integrate`.

mod chains;
mod find;
mod follow;
mod guess;
mod guesses;
mod newton;
mod next_event;
pub mod rate;
mod ray_differential;
mod receiver;
mod sample;
#[cfg(test)]
mod tests;
mod window;

pub use chains::{ManifoldSampling, SpecularChains};
pub use find::find_chains;
pub use follow::{Cone, SpecularChain};
pub(super) use next_event::{receiver, sample_manifold};
pub use receiver::{LastRoughVertex, Receiver};
pub use sample::{FoundLight, ManifoldSample};
