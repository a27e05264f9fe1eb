//! Russian roulette, and the split factor of guided paths.
//!
//! Without a field only the throughput is known, and paths of low throughput end (Mitsuba's rule
//! and defaults). Guided paths need another rule: a direction towards bright light is drawn with a
//! high density, so that its throughput is low, and the old rule would end just the paths that were
//! guided well. The field knows how much light a surface reflects. A path lives as long as its
//! expected contribution, throughput times reflected radiance, is not small against the pixel
//! estimate. Where it is large against that, the path is split: it came by a density that was too
//! low (Vorba and Krivanek, "Adjoint-driven Russian roulette and splitting in light transport
//! simulation", 2016).

use super::guided_path::GuidedPath;
use super::path::Path;
use super::vertex::Vertex;
use crate::bsdf::LobeFlags;

/// Roulette lets no path live more often than this, so that paths between mirrors end (Mitsuba's
/// bound).
pub const MAX_SURVIVAL: f32 = 0.95;
/// The same at a collision: of a path through a cloud that absorbs nothing, hundreds of collisions
/// are before it, and each weight of 1 / 0.95 makes noise. (A ball of optical depth 60 and albedo 1
/// under an even sky, 1024 samples of 64 pixels: standard error 0.018 with 0.95.) What absorbs
/// nothing and has no end still ends.
const MAX_SURVIVAL_AT_COLLISIONS: f32 = 0.9995;
/// A guided path goes on for certain when its expected contribution is this share of the pixel
/// estimate, or more: the lower edge of the weight window whose upper one is [`MOST_SHARE`].
/// (Windows that were measured are in `EXPERIMENTS.md`.)
const CERTAIN_SHARE: f32 = 0.5;
/// The field may be wrong: no guided path ends more often than nine times in ten.
const MIN_SURVIVAL: f32 = 0.1;
/// The expected contribution of a branch is at most this many times the pixel estimate.
const MOST_SHARE: f32 = 1.2;
/// No sample is split into more branches, whatever a field says.
pub(super) const MOST_BRANCHES: u32 = 32;

/// What roulette by throughput looks at. Where radiance is squeezed by an interface, it will be
/// released again: eta takes that out.
#[inline]
pub fn scaled_throughput(path: &Path) -> f32 {
    path.throughput.max_element() * path.eta * path.eta
}

/// Probability to go on by throughput, relative to a `reference`, and at `most` this: 1 is the
/// reference of a plain path, and of a guided one its scaled throughput when the field guided it
/// last. A path that was sent through glass towards the sun has a throughput of a thousandth: to
/// end it there unless it is lucky would undo the guiding. Guarded by
/// `a_path_that_was_guided_through_glass_is_not_ended`.
#[inline]
pub fn by_throughput(path: &Path, reference: f32, most: f32) -> f32 {
    (scaled_throughput(path) / reference).min(most)
}

/// The most often that a path lives on at a vertex. Scenes without media need not look.
#[inline]
pub(super) fn most(vertex: &Vertex) -> f32 {
    match vertex.media {
        Some(_) if vertex.bsdf.flags().has(LobeFlags::VOLUME) => MAX_SURVIVAL_AT_COLLISIONS,
        _ => MAX_SURVIVAL,
    }
}

/// Chance to go on by what the path will bring: `expected_contribution` is the throughput up to the
/// vertex times the radiance that the field expects the surface to reflect. What the sample has
/// already does not matter: the rest of a sample that was lucky is worth no less.
#[inline]
pub fn by_field(path: &mut GuidedPath, expected_contribution: f32) -> f32 {
    if path.pixel_estimate <= 0.0 {
        path.pixel_estimate = expected_contribution;
        return 1.0;
    }
    let survival =
        (expected_contribution / path.pixel_estimate / CERTAIN_SHARE).clamp(MIN_SURVIVAL, 1.0);
    if survival.is_finite() { survival } else { 1.0 }
}

/// Into how many paths one is split that would bring much more than was expected.
#[inline]
pub fn split_factor(path: &GuidedPath, expected_contribution: f32) -> u32 {
    let share = expected_contribution / path.pixel_estimate;
    if path.pixel_estimate <= 0.0 || !share.is_finite() {
        return 1;
    }
    ((share / MOST_SHARE).ceil() as u32).clamp(1, (MOST_BRANCHES / path.split_factor).max(1))
}
