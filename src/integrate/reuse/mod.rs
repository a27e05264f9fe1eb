//! Suffixes of paths, shared among pixels.
//!
//! A guided path spends most of its time behind its second vertex: there it is followed through many bounces,
//! to learn one number, the radiance that leaves the second vertex towards the first. The paths of other pixels
//! can use that number too. So every path that a field aims has a *stem*, all up to its first rough vertex, and,
//! where the vertex behind that is diffuse, a *suffix*, all that is found there. The stems of a few pixels
//! form a group, and each takes light from the suffixes of all of them (Bekaert, Sbert and Halton,
//! "Accelerating path tracing by re-using paths", 2002).
//!
//! Any stem of the group could have drawn any of the vertices behind. Stem `i` receives from the suffix at `y`
//!
//! ```text
//! throughput_i f_i(y) G_i(y) V_i(y) L(y) / sum_k p_k(y) G_k(y) V_k(y)
//! ```
//!
//! with the group's densities `p` in solid angle, mixtures of BSDF and field, joined by the balance heuristic
//! (Veach 1997, 9.2), `G = |cos| / r^2` at `y`, visibility `V`, and the estimate `L` that the path which drew
//! `y` came to. Its own density is in the sum, so that no weight exceeds that of ordinary path tracing. What a mask
//! lets through by chance comes out right on average: both places see the same chance.
//!
//! What is shared and what is not:
//! - A stem's direction is drawn once and goes on for certain: where roulette, splitting or the choice of a delta
//!   lobe have a say there is no stem ([`super::vertex`] asks).
//! - The vertex behind is plainly diffuse: its radiance is the same towards all stems. What it emits is for its own
//!   path alone, weighed against that path's light sample.
//! - Paths whose throughput there is nearly of one colour share nothing (`LEAST_CHANNEL` in `reuse/stem.rs`).
//! - A group has one sample of each of its pixels: the samples of a pixel stay independent of each other, and its
//!   variance is what they show. Those of neighbouring pixels do not.
//!
//! Relative variance of a sample (64 samples, without the worst 0.1 % of the pixels) and processor seconds, for groups
//! of 1, 8 and 16: veach-ajar 5.8, 2.4, 1.9 and 35, 43, 50; a kitchen 9.6, 5.9, 5.3 and 31, 35, 37; lux-pool 18, 14.6,
//! 14.1 and 19, 21, 23; a glass caustic 3.7, 3.1, 3.0 and 27, 33, 37; a torus in glass 8.2, 7.4, 7.7 and 14, 14, 14. In
//! the kitchen a third of the vertices behind are not diffuse; were all shared as if they were, it would be 3.2 with
//! groups of 16.
//!
//! The paths themselves, what they teach the field and what [`super::inspect`] shows of them are the same with and
//! without.

mod exchange;
mod pool;
mod stem;

pub use pool::Pool;

/// Most stems in a group.
pub const MOST: u32 = 64;

/// How far a path has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It has met nothing but mirrors and glass.
    Fresh,
    /// It has just left its first rough vertex, the end of the stem of this number.
    Left(u32),
    /// It is past that, or has no stem.
    Past,
}

/// Where the samples of a wave come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Stream of the numbers by which groups are drawn.
    pub seed: u64,
    /// Samples of each pixel, which stand next to each other.
    pub samples: u32,
    /// Number of the first.
    pub first: u64,
}
