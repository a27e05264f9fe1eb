//! Plain path tracing: how an unguided path scatters.

use super::bounce::{Arrived, BounceResult, Scatter};
use super::context::PathContext;
use super::direction::{drops, record_departure, spawn_ray};
use super::next_event::{ShadowRay, sample_light};
use super::observer::PathObserver;
use super::path::{Arrival, FirstHit, Path};
use super::roulette;
use super::settings::PathSettings;
use super::vertex::Vertex;
use crate::bsdf::{BsdfSample, Transport};
use crate::guide::LightChoice;
use crate::light::Shining;
use crate::math::{Rgb, Vec2};

/// Plain path tracing.
pub(super) struct Plain;

impl<'s> Scatter<'s> for Plain {
    type Path = Path;

    #[inline(always)]
    fn weight_after_delta(&self, _: &PathContext<'s>, _: &Path, _: Shining) -> f32 {
        1.0
    }

    #[inline(always)]
    fn seen_by<'f>(&self, path: &Path, first_hits: &'f mut [FirstHit]) -> Option<&'f mut FirstHit> {
        // Few vertices come after a delta lobe: the others are told by what is at hand.
        if path.pdf.is_finite() {
            return None;
        }
        let first = &mut first_hits[path.accumulator as usize];
        (first.specular_edges == path.depth).then_some(first)
    }

    fn accumulators(&self) -> Option<usize> {
        None
    }

    #[inline(always)]
    fn scatter(
        &mut self,
        context: &PathContext<'s>,
        at: Arrived<'_, 's>,
        path: &mut Path,
        observer: &mut impl PathObserver,
    ) -> BounceResult {
        let vertex = Vertex {
            point: at.point,
            bsdf: at.bsdf,
            wo: at.wo,
            guided: None,
            media: at.media,
            light_choice: LightChoice::NONE,
        };
        let arrival = Arrival {
            throughput: path.throughput,
            radiance: at.radiance,
        };
        let [u0, u1, u2, u_roulette] = path.sampler.next4();

        // ------------------------ Emitter sampling ------------------------
        let accumulator = path.accumulator;
        let shadow = sample_light(context, &vertex, path, 1.0, &mut (), [u0, u1, u2])
            .map(|(ray, offer)| (ray, ShadowRay { accumulator, offer }));

        // ----------------- BSDF sampling, Russian roulette -----------------
        let sampled = sample_bsdf(context.settings, &vertex, path, u_roulette);
        record_departure(&vertex, true, path, &arrival, sampled.as_ref(), observer);
        let ray = sampled.map(|(sample, _)| spawn_ray(&vertex, path, &sample, at.distance));
        BounceResult { ray, shadow }
    }
}

/// The next direction and the probability with which roulette let the path take it, both already
/// part of the throughput.
#[inline(always)]
fn sample_bsdf(
    settings: &PathSettings,
    vertex: &Vertex,
    path: &mut Path,
    u_roulette: f32,
) -> Option<(BsdfSample, f32)> {
    let u = path.sampler.next4();
    path.depth += 1;
    let (u_direction, transport) = (Vec2::new(u[1], u[2]), Transport::Radiance);
    let sample = vertex
        .bsdf
        .sample(vertex.wo, u[0], u_direction, transport)?;
    if drops(settings, vertex, sample.wi) {
        return None;
    }
    path.throughput *= sample.weight;
    // Underflown: whatever it would meet counts for nothing (S21).
    if path.throughput == Rgb::ZERO {
        return None;
    }
    path.eta *= sample.eta;
    let survival = match path.depth < settings.rr_depth {
        true => 1.0,
        false => roulette::by_throughput(path, 1.0, roulette::most(vertex)),
    };
    if u_roulette >= survival {
        return None;
    }
    path.throughput /= survival;
    Some((sample, survival))
}
