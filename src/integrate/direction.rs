//! How a path leaves a vertex: the ray along the sampled direction, and what is recorded of it.

use super::guided_vertex::{GuidedVertex, is_guidable, side};
use super::observer::{Departure, PathObserver, SampledDirection};
use super::path::{Arrival, Path};
use super::settings::PathSettings;
use super::vertex::Vertex;
use crate::accel::Ray;
use crate::bsdf::{BsdfSample, LobeFlags};
use crate::math::Vec3;
use crate::math::frame::normals_disagree;

/// After a rough bounce textures are seen blurred: a lobe of roughness 1 spreads its cone this much
/// per unit distance. A blur of the texture far below the lobe's own width.
pub(super) const ROUGH_SPREAD: f32 = 0.05;

/// The ray along a sampled direction.
#[inline(always)]
pub(super) fn spawn_ray(
    vertex: &Vertex,
    path: &mut Path,
    sample: &BsdfSample,
    distance: f32,
) -> Ray {
    let Vertex { point, bsdf, .. } = *vertex;
    let delta = sample.lobe.has(LobeFlags::DELTA);
    path.pdf = if delta { f32::INFINITY } else { sample.pdf };
    path.from = point.p;
    path.cone_width += path.cone_spread * distance;
    if !delta {
        path.cone_spread = path.cone_spread.max(bsdf.roughness() * ROUGH_SPREAD);
    }
    point.spawn_ray(sample.wi)
}

/// Whether light along this direction is dropped, because shading and geometric normal disagree
/// about a side and the settings are strict.
#[inline(always)]
pub(super) fn drops(settings: &PathSettings, vertex: &Vertex, wi: Vec3) -> bool {
    settings.strict_normals && normals_disagree(vertex.point.normals(), [wi, vertex.wo])
}

/// Tells the observer how the path left a vertex that a field could guide: by the direction and
/// the probability of survival `sampled`, or not at all. `whole` says that the light sample belongs
/// to this direction alone.
#[inline]
pub(super) fn record_departure(
    vertex: &Vertex,
    whole: bool,
    path: &Path,
    arrival: &Arrival,
    sampled: Option<&(BsdfSample, f32)>,
    observer: &mut impl PathObserver,
) {
    // The scattering here is counted already.
    let before = path.depth.saturating_sub(1);
    if !observer.wants(path.accumulator) || !is_guidable(vertex.bsdf, before) {
        return;
    }
    // A delta lobe was chosen: no smooth direction was. That counts as a vertex without one.
    let sampled = sampled.filter(|s| !s.0.lobe.has(LobeFlags::DELTA));
    let direction = sampled.map(|(sample, survival)| {
        let guide_pdf = vertex.guided.map_or(0.0, |g| g.field_pdf(sample.wi));
        SampledDirection {
            direction: sample.wi,
            pdf: sample.pdf,
            guide_pdf,
            bsdf_pdf: vertex
                .guided
                .map_or(sample.pdf, |g| g.bsdf_pdf(sample.pdf, guide_pdf)),
            weight: sample.weight,
            survival: *survival,
            throughput: path.throughput,
        }
    });
    let single = vertex.guided.filter(|_| whole);
    let departure = Departure {
        position: vertex.point.p,
        normal: side(vertex.point, vertex.bsdf, vertex.wo),
        arrival: *arrival,
        light_probability: single.map(GuidedVertex::light_probability),
        light_choice: vertex.light_choice,
        direction,
    };
    observer.depart(path.accumulator, departure);
}
