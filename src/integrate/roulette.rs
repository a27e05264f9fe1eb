//! Russian roulette: which paths are worth going on with.
//!
//! Without a field only the throughput is known, and paths of low throughput end (Mitsuba's rule).
//! When that begins matters little: variance times time with `--rr-depth` 1 to 5 is the same within
//! a tenth in a Cornell box, veach-ajar, a kitchen and a torus in glass, so the default is
//! Mitsuba's. Guided paths need another rule: a direction towards bright light is drawn with a high
//! density, so that its throughput is low, and the old rule would end just the paths that were
//! aimed well. The field knows how much light a surface reflects; a path lives as long as what it
//! will bring, throughput times reflected radiance, is not small against what the sample is
//! expected to come to. Where it is large against that, the path is split: it came by a density
//! that was too low, and goes on in several ways (after Vorba and Krivanek, "Adjoint-driven Russian
//! roulette and splitting in light transport simulation", 2016).

use super::guided_path::GuidedPath;
use super::path::Path;
/// Roulette lets no path live more often than this, so that paths between mirrors end (Mitsuba's
/// bound).
pub const MAX_SURVIVAL: f32 = 0.95;
/// A guided path goes on for certain when it brings this share of its sample, or more: the lower
/// edge of a window whose upper one is [`MOST_SHARE`]. Variance times rays of windows in
/// veach-ajar, a kitchen, a Cornell box: 1/3 and no splitting 44, 77, 1.6; 1/3 to 2 40, 78, 1.6;
/// 0.5 to 2 38, 71, 1.6; 0.75 to 1.5 37, 69, 1.8; 1 to 2 39, 77, 2.0. (For 0.75 instead of 0.5
/// since paths share: veach-ajar 1.12, kitchen 1.1.)
const CERTAIN_SHARE: f32 = 0.5;
/// The field may be wrong: no guided path ends more often than nine times in ten. (0.3 takes the
/// same work.)
const MIN_SURVIVAL: f32 = 0.1;
/// A way of a path that was split brings this many times what its sample was expected to come to,
/// at most. (Since paths share what they find, variance times time with 1.2 is less than with 2:
/// veach-ajar 0.90, a kitchen 0.89, lux-pool 0.91, a glass caustic 1.01; with 0.8 and 0.5 it is
/// more again.)
const MOST_SHARE: f32 = 1.2;
/// No sample is split into more ways, whatever a field says.
pub(super) const MOST_WAYS: u32 = 32;

/// What roulette by throughput looks at. Where radiance is squeezed by an interface, it will be
/// released again: eta takes that out.
#[inline]
pub fn scaled_throughput(path: &Path) -> f32 {
    path.throughput.max_element() * path.eta * path.eta
}

/// Probability to go on by throughput, relative to a `reference`: 1 for a plain path, and for a
/// guided one its scaled throughput when the field guided it last. A path that was sent through
/// glass towards the sun has a throughput of a thousandth: to end it there unless it is lucky would
/// undo the guiding. Guarded by `a_path_that_was_guided_through_glass_is_not_ended`.
#[inline]
pub fn by_throughput(path: &Path, reference: f32) -> f32 {
    (scaled_throughput(path) / reference).min(MAX_SURVIVAL)
}

/// Chance to go on by what the path will bring: `expected_contribution` is the throughput up to the
/// vertex times the radiance that the field expects the surface to reflect. What the sample has
/// already does not matter: the rest of a sample that was lucky is worth no less. (It did once:
/// relative variance in veach-ajar 7.0 instead of 6.2.)
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
    ((share / MOST_SHARE).ceil() as u32).clamp(1, (MOST_WAYS / path.split_factor).max(1))
}
