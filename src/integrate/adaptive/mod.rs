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
//!
//! Relative variance of a sample without the worst 0.1 % of the pixels, and rays a path, even and
//! spread: a kitchen at 64 samples 3.44, 10.0 and 3.14, 9.9 (medians of three), at 256 4.5, 9.4 and
//! 3.6, 9.2; veach-ajar at 256 1.46, 11.6 and 1.39, 11.2; a torus in glass at 64 0.61, 9.9 and
//! 0.62, 10.1 (medians of four), at 256 1.58, 11.2 and 1.60, 11.7: its bright paths are too rare to
//! show in the first samples. What perfect knowledge of the variances would leave: 0.70 in the
//! kitchen, 0.80 in veach-ajar.

mod share;
mod survey;

pub use share::{Share, Shares, TileShares};
pub use survey::{Survey, TileSurvey};

/// Samples of every pixel before the first are spread.
pub const FIRST: u64 = 8;
/// Samples of the whole film that the last spread goes by, at least, if the image has twice as
/// many.
pub const FEWEST: u64 = 16;
