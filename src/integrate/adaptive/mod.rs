//! More samples where there is more noise.
//!
//! Some pixels see a caustic, a lamp in a mirror, the inside of a glass; others a wall. With as
//! many samples for each, the noise of the first spoils an image whose rest was clean long ago. So
//! the first samples of a guided render, a few for every pixel, tell how noisy each is
//! ([`Survey`]), and the next ones are spread by that ([`Shares`]). Samples in proportion to the
//! standard deviation leave the least error in all (Neyman allocation). What counts is relative
//! variance, as for the eye, so that it is not the brightest part of an image that gets them all.
//!
//! A sample of the image stands for one of every pixel. A pixel with a share of 3 takes three paths
//! for it, each worth a third, one with a share of 1/4 takes one path in four samples, worth four.
//! So every *stage* of a render, in which shares stay what they are, counts for as much in each
//! pixel as it has samples, whatever the samples before it were like: each stage is an unbiased
//! estimate given the ones before, and so is their sum. (Weights by number of paths would not be: a
//! pixel whose first samples missed a rare bright path would get few more, and the dark ones would
//! count for more than in others.)
//!
//! The survey is that of the passes that teach the field, which every machine that renders a part
//! of an image makes over the whole film; where those are fewer than [`FEWEST`], some more are
//! made.
//! What it gains is in `EXPERIMENTS.md` beside `integrate`.

mod share;
mod survey;

pub use share::{Share, Shares, TileShares};
pub use survey::{Survey, TileSurvey};

/// Samples of every pixel before the first are spread.
pub const FIRST: u64 = 8;
/// Samples of the whole film that the last spread goes by, at least, if the image has twice as
/// many.
pub const FEWEST: u64 = 16;
