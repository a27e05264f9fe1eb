//! Suffixes of paths, shared among pixels.
//!
//! A guided path spends most of its time behind its second vertex: there it is followed through
//! many bounces, to learn one number, the radiance that leaves the second vertex towards the
//! first. The paths of other pixels can use that number too. So every path that a field aims has a
//! *prefix*, all up to its first rough vertex, and, where the vertex behind that looks alike from
//! all sides, a *suffix*, all that is found there. The prefixes of a few pixels form a group, and
//! each takes light from the suffixes of all of them (Bekaert, Sbert and Halton, "Accelerating
//! path tracing by re-using paths", 2002).
//!
//! Any prefix of the group could have drawn any of the vertices behind. Prefix `i` receives from
//! the suffix at `y`
//!
//! ```text
//! throughput_i f_i(y) G_i(y) V_i(y) L(y) / sum_k p_k(y) G_k(y) V_k(y)
//! ```
//!
//! with the group's densities `p` in solid angle, mixtures of BSDF and field, joined by the
//! balance heuristic (Veach 1997, 9.2), `G = |cos| / r^2` at `y`, visibility `V`, and the estimate
//! `L` that the path which drew `y` came to. Its own density is in the sum, so that no weight
//! exceeds that of ordinary path tracing. What a mask lets through by chance comes out right on
//! average: both places see the same chance.
//!
//! In media that only absorb, the throughput has the transmittance to `y` besides. Nothing is shared
//! where media scatter or surfaces are index-matched (`EXPERIMENTS.md` of the path tracer says why).
//!
//! What is shared and what is not:
//! - A prefix's direction is drawn once and goes on for certain: where roulette, splitting or the
//!   choice of a delta lobe have a say there is no prefix (`guided_direction.rs` asks).
//! - The vertex behind is diffuse, or the base of rough plastic: its radiance is the same towards
//!   all prefixes, or differs by a known factor ([`crate::bsdf::View`]). What it emits is for its
//!   own path alone, weighed against that path's light sample.
//! - Paths whose throughput there is nearly of one colour share nothing (`LEAST_CHANNEL` in
//!   `reuse/prefix.rs`).
//! - A group has one sample of each of its pixels: the samples of a pixel stay independent of each
//!   other, and its variance is what they show. Those of neighbouring pixels do not.
//!
//! Sharing must not gain in pixels what it loses in larger pieces of the image. A group mixes the
//! pixels of a tile: what is wrong with a suffix is wrong in all of them, a constellation of
//! fireflies, and does not average out over the tile. Hence:
//! - All suffixes are followed. If a part of them, drawn by lot, stood for all, that would cost
//!   less time and be as good in pixels; but it would multiply the variance of a tile by the number
//!   that each stands for, as what the pixels of a group see would come from fewer paths.
//! - No path of its group makes a pixel brighter than the pixel's own path would, had it met the
//!   same vertex: the balance heuristic's weights come to one, the pixel's own density is in their
//!   sum, and a suffix counts once.
//! - A suffix is linked with the prefixes of its group when its light is known, and not at all
//!   where it brought none (about half of them): what is saved pays for larger groups.
//!
//! The paths themselves, and what [`super::debug::inspect`] shows of them, are the same with and
//! without.
//!
//! What was measured, and what else was tried, is in `EXPERIMENTS.md` beside this file.

mod pool;
mod prefix;
mod reconnection;

pub use pool::{Admission, PrefixPool};

/// Most prefixes in a group.
pub const MAX_GROUP: u32 = 64;
