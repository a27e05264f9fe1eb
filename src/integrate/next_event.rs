//! Next-event estimation: light is looked for where it comes from.

use super::context::PathContext;
use super::direction::drops;
use super::path::Path;
use super::vertex::Vertex;
use crate::accel::Ray;
use crate::bsdf::{LobeFlags, Transport};
use crate::light::{Incoming, LightSelection, Lights};
use crate::math::mis::power_heuristic;
use crate::math::offset::gamma;
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec3};

/// A shadow ray stops this much short of the light, relative to the distance, so as not to meet the
/// light's own surface. An occluder closer to the light than this is not seen.
const SHADOW_MARGIN: f32 = 1e-4;

/// Light that a path receives if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Offer {
    /// What comes from the light.
    pub incoming: Incoming,
    /// What it is multiplied by: throughput, BSDF and MIS weight over density.
    factor: Rgb,
}

impl Offer {
    /// Media let this much of it through.
    #[inline]
    pub fn attenuate(&mut self, transmittance: Rgb) {
        self.factor *= transmittance;
    }

    /// The radiance that the path's sample gains.
    #[inline]
    pub fn radiance(&self, lights: &Lights) -> Rgb {
        self.factor * lights.radiance(&self.incoming)
    }
}

/// An offer, for an accumulator.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// Index of the accumulator that it is added to.
    pub accumulator: u32,
    /// What is added.
    pub(super) offer: Offer,
}

/// A shadow ray with the light it would bring, if there is one. A light is sampled with probability
/// `probability`: a field leaves it out where it seldom brings anything. Which one, `selection`
/// says. `u` are uniform numbers.
#[inline(always)]
pub(super) fn sample_light(
    context: &PathContext,
    vertex: &Vertex,
    path: &mut Path,
    probability: f32,
    selection: &mut impl LightSelection,
    mut u: [f32; 3],
) -> Option<(Ray, Offer)> {
    let PathContext {
        scene, settings, ..
    } = *context;
    let Vertex {
        point, bsdf, wo, ..
    } = *vertex;
    path.light_probability = probability;
    if !bsdf.flags().has(LobeFlags::SMOOTH) {
        path.from_normal = Vec3::ZERO;
        return None;
    }
    path.from_normal = bsdf.light_normal(wo);
    if probability < 1.0 {
        if u[0] >= probability {
            return None;
        }
        u[0] = (u[0] / probability).min(BELOW_ONE);
    }
    let light = scene
        .lights
        .sample(point.p, path.from_normal, selection, u)?;
    if drops(settings, vertex, light.dir) {
        return None;
    }
    let (f, bsdf_pdf) = bsdf.eval_pdf(wo, light.dir, Transport::Radiance);
    if f == Rgb::ZERO {
        return None;
    }
    let light_pdf = light.pdf * probability;
    let weight = if light.delta {
        1.0
    } else {
        let pdf = vertex
            .guided
            .map_or(bsdf_pdf, |g| g.pdf(light.dir, bsdf_pdf));
        power_heuristic(light_pdf, pdf)
    };
    // At a collision distances that are drawn by lights find it, too.
    let collision = vertex.media.and_then(|at| at.collision.as_ref());
    let weight = match (collision, light.leaf) {
        (Some(collision), Some(leaf)) => weight * scene.lights.free_flight_weight(collision, leaf),
        _ => weight,
    };
    // Large BSDFs (narrow lobes) meet small weights before bright lights: the other order overflows
    // (S8).
    let offer = Offer {
        factor: path.throughput * (f * (weight / light_pdf)),
        incoming: light.incoming,
    };
    let mut ray = point.spawn_ray(light.dir);
    if light.distance.is_finite() {
        ray = shadow_ray(ray.org, point.p + light.dir * light.distance);
    }
    Some((ray, offer))
}

/// A ray that ends just before a place on a light.
///
/// It runs through that place, not along the direction in which the light was sampled: beside that,
/// by the offset of its origin, it meets a light that it grazes earlier than its margin allows (a
/// lamp that touches the ceiling lost 3 % of its light around the touch).
#[inline]
pub(super) fn shadow_ray(org: Vec3, light: Vec3) -> Ray {
    let to = light - org;
    let distance = to.length();
    let mut ray = Ray::new(org, to / distance.max(f32::MIN_POSITIVE));
    let rounding = 4.0 * gamma(7) * org.abs().max_element();
    ray.tmax = distance * (1.0 - SHADOW_MARGIN) - rounding;
    ray
}
