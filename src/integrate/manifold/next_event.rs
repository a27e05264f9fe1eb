//! Manifold next-event estimation at the vertices of guided paths: where, and how often.
//!
//! Guidable vertices sample a specular chain to a sun or a lamp, with a probability that a trial
//! found to pay (see [`super::rate`]).

use super::follow::Cone;
use super::receiver::Receiver;
use super::sample::{ManifoldSample, Request};
use crate::integrate::context::PathContext;
use crate::integrate::direction::ROUGH_SPREAD;
use crate::integrate::guided_path::{GuidedPath, PrefixState};
use crate::integrate::guided_vertex::is_guidable;
use crate::integrate::vertex::Vertex;

/// Rate behind the first rough vertex of a path, relative to that at it: what is found there counts
/// for less.
const BEHIND_FIRST: f32 = 0.4;
/// Sets the numbers that chains are sampled by apart from others.
const NUMBERS: u32 = 0x6169_6d00;

/// The receiver at a vertex and the probability to sample a chain there; `None` where that is never
/// done. (Whether any chain leads there is not looked up before one is sampled: most times none
/// is.)
#[inline]
pub(in crate::integrate) fn receiver(
    context: &PathContext,
    vertex: &Vertex,
    path: &GuidedPath,
) -> Option<(Receiver, f32)> {
    let manifold = context.guide?.manifold()?;
    if !is_guidable(vertex.bsdf, path.base.depth) {
        return None;
    }
    let receiver = Receiver::new(vertex.point, vertex.bsdf, vertex.wo);
    let probability = match path.prefix {
        PrefixState::Growing => manifold.rate(),
        _ => manifold.rate() * BEHIND_FIRST,
    };
    Some((receiver, probability))
}

/// Samples a light by a specular chain from a vertex at a `distance` from the one before, with the
/// probability that stands with its receiver.
#[inline]
pub(in crate::integrate) fn sample_manifold(
    context: &PathContext,
    vertex: &Vertex,
    receiver: Option<(Receiver, f32)>,
    path: &GuidedPath,
    distance: f32,
) -> Option<ManifoldSample> {
    let (manifold, (receiver, probability)) = (context.guide?.manifold()?, receiver?);
    let path = &path.base;
    // Numbers beside the path's own.
    let mut numbers = path.sampler.fork(NUMBERS);
    if numbers.next4()[0] >= probability {
        return None;
    }
    let [a, b, c, _] = numbers.next4();
    let request = Request {
        context,
        numbers,
        vertex,
        receiver: &receiver,
        probability,
        most: (context.settings.max_depth - 2).saturating_sub(path.depth),
        cone: Cone {
            width: path.cone_width + path.cone_spread * distance,
            spread: path.cone_spread.max(vertex.bsdf.roughness() * ROUGH_SPREAD),
        },
    };
    Some(manifold.chains().sample(&request, [a, b, c]))
}
