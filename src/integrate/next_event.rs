//! Next-event estimation: light is looked for where it comes from.

use super::guiding::GuidedVertex;
use super::vertex::{Vertex, Walk};
use super::wave::Path;
use crate::accel::Ray;
use crate::bsdf::{LobeFlags, Transport};
use crate::light::{Incoming, Lights};
use crate::math::mis::power_heuristic;
use crate::math::offset::{gamma, offset_origin};
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
    /// The radiance that the path's sample gains.
    #[inline]
    pub fn radiance(&self, lights: &Lights) -> Rgb {
        self.factor * lights.radiance(&self.incoming)
    }
}

/// An offer, for an account.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// The account that it is paid into.
    pub slot: u32,
    /// What is paid.
    pub(super) offer: Offer,
}

/// A shadow ray with the light it would bring, if there is one. With a guide it is left out where it seldom
/// brings any.
#[inline(always)]
pub(super) fn sample_light<const GUIDED: bool>(
    walk: &Walk,
    vertex: &Vertex,
    path: &mut Path,
    mut u: [f32; 3],
) -> Option<(Ray, Offer)> {
    let Walk {
        scene, settings, ..
    } = *walk;
    let Vertex {
        point, bsdf, wo, ..
    } = *vertex;
    let guided = vertex.guided.filter(|_| GUIDED);
    path.light_chance = guided.map_or(1.0, GuidedVertex::light_chance);
    if !bsdf.flags().has(LobeFlags::SMOOTH) {
        path.from_normal = Vec3::ZERO;
        return None;
    }
    path.from_normal = bsdf.light_normal(wo);
    if GUIDED {
        if u[0] >= path.light_chance {
            return None;
        }
        u[0] = (u[0] / path.light_chance).min(BELOW_ONE);
    }
    let light = scene.lights.sample(point.p, path.from_normal, u)?;
    if settings.strict_normals
        && (crosses(point.normals(), light.dir) || crosses(point.normals(), wo))
    {
        return None;
    }
    let (f, bsdf_pdf) = bsdf.eval_pdf(wo, light.dir, Transport::Radiance);
    if f == Rgb::ZERO {
        return None;
    }
    let light_pdf = light.pdf * path.light_chance;
    let weight = if light.delta {
        1.0
    } else {
        let pdf = guided.map_or(bsdf_pdf, |g| g.pdf(light.dir, bsdf_pdf));
        power_heuristic(light_pdf, pdf)
    };
    // Large BSDFs (narrow lobes) meet small weights before bright lights: the other order overflows (S8).
    let offer = Offer {
        factor: path.throughput * (f * (weight / light_pdf)),
        incoming: light.incoming,
    };
    let org = offset_origin(point.p, point.error, point.ng, light.dir);
    let ray = if light.distance.is_finite() {
        shadow_ray(org, point.p + light.dir * light.distance)
    } else {
        Ray::new(org, light.dir)
    };
    Some((ray, offer))
}

/// A ray that ends just before a place on a light.
///
/// It runs through that place, not along the direction in which the light was sampled: beside that, by the
/// offset of its origin, it meets a light that it grazes earlier than its margin allows (a lamp that
/// touches the ceiling lost 3 % of its light around the touch).
#[inline]
pub(super) fn shadow_ray(org: Vec3, light: Vec3) -> Ray {
    let to = light - org;
    let distance = to.length();
    let mut ray = Ray::new(org, to / distance.max(f32::MIN_POSITIVE));
    let rounding = 4.0 * gamma(7) * org.abs().max_element();
    ray.tmax = distance * (1.0 - SHADOW_MARGIN) - rounding;
    ray
}

/// Whether geometric and shading normal disagree about the side `w` is on.
#[inline]
pub(super) fn crosses([geometric, shading]: [Vec3; 2], w: Vec3) -> bool {
    geometric.dot(w) * shading.dot(w) <= 0.0
}
