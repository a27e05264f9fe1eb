//! A wave of photons that advance together, one scattering at a time.

use super::media::{self, FlightInMedia};
use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::math::offset::offset_sampled;
use crate::math::{PathSampler, Rgb, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::wavefront::Wavefront;

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

/// Buffers of a wave, kept from one to the next.
#[derive(Default)]
pub struct PhotonWave {
    wavefront: Wavefront<Flight>,
    /// The same in scenes with media.
    in_media: Wavefront<FlightInMedia>,
}

impl PhotonWave {
    /// Traces the photons of `range` to their ends and hands each landing to `land`.
    pub fn trace(
        &mut self,
        scene: &Scene,
        settings: &PhotonSettings,
        range: std::ops::Range<u64>,
        land: &mut impl FnMut(Landing),
    ) -> PhotonCounts {
        let mut counts = PhotonCounts {
            emitted: range.end - range.start,
            ..PhotonCounts::default()
        };
        self.emit(scene, settings, range, &mut counts);
        if !scene.media.is_empty() {
            self.in_media.extend(media::enter(self.wavefront.drain()));
            media::trace(&mut self.in_media, scene, settings, &mut counts, land);
        }
        while !self.wavefront.is_empty() {
            counts.rays += self.wavefront.advance(scene, |flight, ray, hit| {
                scatter(scene, settings, (ray, hit, 0.0), flight, &mut counts, land)
            });
        }
        counts
    }

    fn emit(
        &mut self,
        scene: &Scene,
        settings: &PhotonSettings,
        range: std::ops::Range<u64>,
        counts: &mut PhotonCounts,
    ) {
        for photon in range {
            let mut sampler = PathSampler::independent(settings.seed, photon, u64::MAX);
            let (a, b) = (sampler.next4(), sampler.next4());
            let Some(start) = scene.lights.emit([a[0], a[1], a[2], a[3], b[0]]) else {
                continue;
            };
            if !(start.power.is_finite() && start.dir.is_finite() && start.org.is_finite()) {
                counts.invalid += 1;
                continue;
            }
            let org = if start.ng == Vec3::ZERO {
                start.org
            } else {
                offset_sampled(start.org, start.ng, start.dir)
            };
            let flight = Flight {
                power: start.power,
                sampler,
                bounces: 0,
                travelled: 0.0,
                specular: false,
            };
            self.wavefront.push(flight, Ray::new(org, start.dir));
        }
    }
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
