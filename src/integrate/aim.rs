//! Who aims at suns and lamps, and how often.
//!
//! Rough vertices of guided paths do that some chain leads to (see [`super::chain`]), with a chance that a trial
//! found to pay.

use super::chain::{Aimed, Cone, Place, Request};
use super::guiding::is_guidable;
use super::onward::ROUGH_SPREAD;
use super::reuse::Stage;
use super::vertex::{Vertex, Walk};
use super::wave::Path;

/// How much less often a path aims behind its first rough vertex: what it finds there counts for less.
const BEHIND: f32 = 0.4;
/// Sets the numbers that chains are sampled by apart from others.
const NUMBERS: u32 = 0x6169_6d00;

/// Where a vertex aims from, and with which chance; `None` where it never does. (Whether any chain leads there is not asked
/// before it does: most vertices do not aim, most times.)
#[inline]
pub(super) fn aims(walk: &Walk, vertex: &Vertex, path: &Path) -> Option<(Place, f32)> {
    let aiming = walk.guide?.aiming()?;
    if !is_guidable(vertex.bsdf) {
        return None;
    }
    let place = Place::new(vertex.point, vertex.bsdf, vertex.wo);
    let chance = match path.stage {
        Stage::Fresh => aiming.chance(),
        _ => aiming.chance() * BEHIND,
    };
    Some((place, chance))
}

/// What comes of aiming from a vertex at a `distance` from the one before, if it does this time.
#[inline]
pub(super) fn aim(walk: &Walk, vertex: &Vertex, path: &Path, distance: f32) -> Option<Aimed> {
    let (aiming, (place, chance)) = (walk.guide?.aiming()?, vertex.aims?);
    // Numbers beside the path's own.
    let mut numbers = path.sampler.fork(NUMBERS);
    if numbers.next4()[0] >= chance {
        return None;
    }
    let request = Request {
        walk,
        vertex,
        place: &place,
        chance,
        most: (walk.settings.max_depth - 2).saturating_sub(path.depth),
        cone: Cone {
            width: path.cone_width + path.cone_spread * distance,
            spread: path.cone_spread.max(vertex.bsdf.roughness() * ROUGH_SPREAD),
        },
    };
    let [a, b, c, _] = numbers.next4();
    Some(aiming.chains().sample(&request, [a, b, c]))
}
