//! Russian roulette: which paths are worth going on with.
//!
//! Without a field only the throughput is known, and paths of low throughput end (Mitsuba's rule).
//! Guided paths need another rule: a direction towards bright light is drawn with a high density, so
//! that its throughput is low, and the old rule would end just the paths that were aimed well. The
//! field knows how much light a surface reflects; a path lives as long as what it will bring,
//! throughput times reflected radiance, is not small against what the sample is expected to come to
//! (after Vorba and Krivanek, "Adjoint-driven Russian roulette and splitting in light transport
//! simulation", 2016; roulette only).

use super::wave::Path;
use crate::math::Rgb;

/// Roulette lets no path live more often than this, so that paths between mirrors end (Mitsuba's bound).
const MAX_SURVIVAL: f32 = 0.95;
/// A guided path goes on for certain when it brings this share of its sample, or more: 1/3 is the lower
/// edge of the window of the paper. Smaller shares cost more time than they save noise.
const CERTAIN_SHARE: f32 = 1.0 / 3.0;
/// The field may be wrong: no guided path ends more often than nine times in ten.
const MIN_SURVIVAL: f32 = 0.1;

/// What the chance of a guided path to go on is decided by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Roulette {
    /// What the field expects the path to bring.
    #[default]
    Field,
    /// The throughput, as without a field.
    Throughput,
}

/// What roulette by throughput looks at. Where radiance is squeezed by an interface, it will be released
/// again: eta takes that out.
#[inline]
pub fn standing(path: &Path) -> f32 {
    path.throughput.max_element() * path.eta * path.eta
}

/// Chance to go on by throughput, relative to what the field let the path have when it aimed it last. A
/// path that was sent through glass towards the sun has a throughput of a thousandth: to end it there
/// unless it is lucky would undo the aiming. Guarded by `roulette_spares_what_the_field_aimed_through_glass`.
#[inline]
pub fn by_throughput(path: &Path) -> f32 {
    (standing(path) / path.aimed_with).min(MAX_SURVIVAL)
}

/// Chance to go on by what the path will bring: `coming` is the throughput up to the vertex times the
/// radiance that the field expects the surface to reflect, `so_far` what the sample has already.
#[inline]
pub fn by_field(path: &mut Path, coming: f32, so_far: Rgb) -> f32 {
    if path.expected <= 0.0 {
        path.expected = coming;
        return 1.0;
    }
    let share = coming / (path.expected + so_far.element_sum());
    let survival = (share / CERTAIN_SHARE).clamp(MIN_SURVIVAL, 1.0);
    if survival.is_finite() { survival } else { 1.0 }
}
