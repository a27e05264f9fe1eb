//! How a path leaves a vertex: the direction that it takes, and whether roulette lets it.

use super::chain::{Kinds, Station};
use super::guiding::{GuidedVertex, facing, is_guidable};
use super::next_event::crosses;
use super::record::{Arrival, Departure, Onward, Witness};
use super::reuse::Stage;
use super::roulette;
use super::vertex::{Vertex, coming};
use super::wave::{NO_STATION, Path};
use super::{PathSettings, Roulette};
use crate::accel::Ray;
use crate::bsdf::{BsdfSample, LobeFlags, Transport};
use crate::math::offset::offset_origin;
use crate::math::{Rgb, Vec2};

/// The ray along a sampled direction.
#[inline(always)]
pub(super) fn leave(
    vertex: &Vertex,
    path: &mut Path,
    sample: &BsdfSample,
    distance: f32,
    stations: &mut Vec<Station>,
) -> Option<Ray> {
    let delta = sample.lobe.has(LobeFlags::DELTA);
    let Vertex { point, bsdf, .. } = *vertex;
    path.pdf = if delta { f32::INFINITY } else { sample.pdf };
    path.from = point.p;
    path.cone_width += path.cone_spread * distance;
    if delta {
        path.chain = path.chain.then(sample.lobe);
    } else {
        path.chain = Kinds::EMPTY;
        path.station = NO_STATION;
        if let Some((place, chance)) = vertex.aims {
            path.station = stations.len() as u32;
            stations.push(Station {
                place,
                dir: sample.wi,
                pdf: sample.pdf,
                chance,
            });
        }
        path.stage = vertex.stem.map_or(Stage::Past, Stage::Left);
        path.cone_spread = path.cone_spread.max(bsdf.roughness() * ROUGH_SPREAD);
    }
    Some(Ray::new(
        offset_origin(point.p, point.error, point.ng, sample.wi),
        sample.wi,
    ))
}

/// The next direction, of the BSDF or of the mixture of BSDF and field unless it is known already (`lobe`), and
/// the chance with which roulette let the path take it, both already part of the throughput.
#[inline(always)]
pub(super) fn go_on<const GUIDED: bool>(
    settings: &PathSettings,
    vertex: &Vertex,
    path: &mut Path,
    lobe: Option<BsdfSample>,
    u_roulette: f32,
    arrival: &Arrival,
) -> Option<(BsdfSample, f32)> {
    let Vertex {
        point, bsdf, wo, ..
    } = *vertex;
    let guided = vertex.guided.filter(|_| GUIDED);
    let block = path.sampler.next4();
    path.depth += 1;
    let sample = match (lobe, guided) {
        (Some(lobe), _) => lobe,
        (None, Some(guided)) => guided.sample(bsdf, wo, block)?,
        (None, None) => {
            let u = Vec2::new(block[1], block[2]);
            let u_lobe = vertex.lobes.choose(block[0]);
            bsdf.sample(wo, u_lobe, u, Transport::Radiance)?
        }
    };
    if settings.strict_normals
        && (crosses(point.normals(), sample.wi) || crosses(point.normals(), wo))
    {
        return None;
    }
    path.throughput *= sample.weight;
    // Underflown: whatever it would meet counts for nothing (S21).
    if path.throughput == Rgb::ZERO {
        return None;
    }
    path.eta *= sample.eta;
    let by_field = guided.filter(|_| settings.roulette == Roulette::Field);
    let coming = match lobe {
        // What the field expects comes by the smooth lobes.
        Some(_) => None,
        None => coming::<GUIDED>(settings, vertex, arrival.throughput),
    };
    let survival = match coming {
        Some(coming) => roulette::by_field(path, coming),
        None if path.depth < settings.rr_depth => 1.0,
        None if by_field.is_some() => roulette::MAX_SURVIVAL,
        None => roulette::by_throughput(path),
    };
    if u_roulette >= survival {
        return None;
    }
    path.throughput /= survival;
    if by_field.is_some() {
        path.aimed_with = roulette::standing(path);
    }
    Some((sample, survival))
}

/// Tells the witness how the path left a vertex that a field could guide.
#[inline]
pub(super) fn watch<W: Witness>(
    vertex: &Vertex,
    path: &Path,
    arrival: &Arrival,
    onward: Option<&(BsdfSample, f32)>,
    witness: &mut W,
) {
    if !witness.wants(path.slot) || !is_guidable(vertex.bsdf) {
        return;
    }
    // A delta lobe was chosen: no smooth direction was. That counts as a vertex without one.
    let onward = onward.filter(|o| !o.0.lobe.has(LobeFlags::DELTA));
    let onward = onward.map(|(sample, survival)| {
        let guide_pdf = vertex.guided.map_or(0.0, |g| g.field_pdf(sample.wi));
        Onward {
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
    // The light sample belongs to all ways together.
    let single = vertex.guided.filter(|_| vertex.ways == 1);
    let departure = Departure {
        position: vertex.point.p,
        normal: facing(vertex.point, vertex.wo),
        arrival: *arrival,
        light_chance: single.map(GuidedVertex::light_chance),
        onward,
    };
    witness.leave(path.slot, departure);
}

/// After a rough bounce textures are seen blurred: a lobe of roughness 1 spreads its cone this much per
/// unit distance. A blur of the texture far below the lobe's own width.
pub(super) const ROUGH_SPREAD: f32 = 0.05;
