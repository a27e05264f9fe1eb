//! A photon on its way, and how it scatters at a surface.

use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::math::{PathSampler, Rgb, Vec2};
use crate::scene::Scene;

/// A photon survives roulette at most this often, so that photons between mirrors end.
const MAX_SURVIVAL: f32 = 0.95;

/// What a photon carries from one scattering to the next.
#[derive(Clone, Copy)]
pub(super) struct Flight {
    pub power: Rgb,
    pub sampler: PathSampler,
    pub bounces: u32,
    /// Distance flown since the last scattering that was not specular.
    pub travelled: f32,
    pub specular: bool,
}

/// Records the landing and samples where the photon goes: the next ray, or none. `before` is how
/// far it flew before this ray.
pub(super) fn scatter(
    scene: &Scene,
    settings: &PhotonSettings,
    (ray, hit, before): (&Ray, &Hit, f32),
    flight: &mut Flight,
    counts: &mut PhotonCounts,
    land: &mut impl FnMut(Landing),
) -> Option<Ray> {
    let surface = scene.surfaces.met(hit)?;
    let point = scene.surfaces.point(ray, hit, 0.0);
    let wo = -ray.dir;
    let bsdf = scene.surfaces.bsdf(surface, &point, wo);
    flight.travelled += before + hit.t;
    if bsdf.flags().has(LobeFlags::SMOOTH) {
        counts.landings += 1;
        land(Landing {
            position: point.p,
            direction: wo,
            normal: point.facing(wo),
            power: flight.power,
            distance: flight.travelled,
            bounces: flight.bounces,
            specular: flight.specular,
        });
    }
    if flight.bounces >= settings.max_bounces {
        return None;
    }
    let u = flight.sampler.next4();
    let sample = bsdf.sample(wo, u[0], Vec2::new(u[1], u[2]), Transport::Importance)?;
    let mut weight = sample.weight;
    if flight.bounces >= settings.roulette_after {
        // Powers differ between emitters: what is thinned is the loss at this scattering.
        let survival = weight.max_element().min(MAX_SURVIVAL);
        if u[3] >= survival {
            return None;
        }
        weight /= survival;
    }
    flight.power *= weight;
    if !flight.power.is_finite() {
        counts.invalid += 1;
        return None;
    }
    let delta = sample.lobe.has(LobeFlags::DELTA);
    flight.specular = delta && (flight.specular || flight.bounces == 0);
    if !delta {
        flight.travelled = 0.0;
    }
    flight.bounces += 1;
    Some(point.spawn_ray(sample.wi))
}
