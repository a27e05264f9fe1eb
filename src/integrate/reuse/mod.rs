//! Suffixes of paths, shared among pixels.
//!
//! A guided path spends most of its time behind its second vertex: there it is followed through many bounces,
//! to learn one number, the radiance that leaves the second vertex towards the first. The paths of other pixels
//! can use that number too. So every path that a field aims has a *stem*, all up to its first rough vertex, and,
//! where the vertex behind that looks alike from all sides, a *suffix*, all that is found there. The stems of a few
//! pixels form a group, and each takes light from the suffixes of all of them (Bekaert, Sbert and Halton,
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
//! - The vertex behind is diffuse, or the base of rough plastic: its radiance is the same towards all stems, or differs
//!   by a known factor ([`crate::bsdf::View`]). What it emits is for its own path alone, weighed against that path's
//!   light sample.
//! - Paths whose throughput there is nearly of one colour share nothing (`LEAST_CHANNEL` in `reuse/stem.rs`).
//! - A group has one sample of each of its pixels: the samples of a pixel stay independent of each other, and its
//!   variance is what they show. Those of neighbouring pixels do not.
//!
//! Most of a large group's suffixes would tell little more than a few of them: only about `FOLLOWED` of a group,
//! drawn by lot, are followed, and stand for all. Paths that teach the field are in groups of at most
//! `MOST_TEACHING`, so that it hears of more vertices behind.
//!
//! Relative variance of a sample (without the worst 0.1 % of the pixels) and processor seconds of 32 samples by a field
//! learned before:
//!
//! | stems of a group | suffixes followed | veach-ajar | a kitchen |
//! |---|---|---|---|
//! | 1 | all | 4.9, 13.7 s | 8.1, 12.7 s |
//! | 8 | all | 1.8, 17.0 s | 4.6, 15.9 s |
//! | 16 | half | 2.1, 12.4 s | 5.0, 12.9 s |
//! | 32 | a quarter | 2.3, 10.5 s | 5.2, 11.2 s |
//! | 64 | a quarter | 1.8, 13.7 s | 4.4, 13.8 s |
//! | 64 | an eighth | 2.5, 9.6 s | 5.5, 11.1 s |
//!
//! With learning, and half of them followed, relative variance times seconds of 64 samples, before anything was shared
//! and now: lux-pool 351, 319; a glass caustic 103, 105; a torus in glass 114, 126, by noise.
//!
//! Sharing once more at every vertex behind, in groups of 8 or 16 that are all followed: 0.90 and 0.83 of the kitchen's
//! variance in 1.37 and 1.55 times the time; with half or a quarter of 16 followed 1.4 and 2.3 times the variance.
//! Drawing for suffixes by what they will bring instead of all alike: the same variance times time. Leaving links away
//! whose density is below a hundredth, a thirtieth, a tenth of the group's largest: as many rays less as there is noise
//! more.
//!
//! A third of the kitchen's vertices behind are rough plastic, which had no part in the figures above. Taken as coat or
//! base by lot ([`super::vertex`]), with the bases shared: the same field's variance times time falls from 56 to 45, with
//! learning and 64 samples from 181 to 151. Nothing changes where there is none (veach-ajar).
//!
//! The paths themselves, and what [`super::inspect`] shows of them, are the same with and without, but for those that
//! end behind their stems because others are followed.

mod exchange;
mod pool;
mod stem;

use super::PathSettings;
pub use pool::{Admission, Pool};

/// Most stems in a group.
pub const MOST: u32 = 64;
/// So many suffixes of a group are followed, where all stems have one.
const FOLLOWED: f32 = 8.0;
/// Most stems in a group of paths that teach.
const MOST_TEACHING: u32 = 16;

/// How paths of these settings share while they teach.
pub fn while_teaching(settings: &PathSettings) -> PathSettings {
    PathSettings {
        reuse: settings.reuse.min(MOST_TEACHING),
        ..settings.clone()
    }
}

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

/// Where a path of a wave comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Origin {
    /// A number for its pixel.
    pub pixel: u32,
    /// A number that it shares with one path of other pixels, and with none of its own.
    pub round: u64,
}
