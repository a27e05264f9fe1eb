//! A wave of photons that advance together, one scattering at a time.

use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::math::offset::{offset_origin, offset_sampled};
use crate::math::{PathSampler, Rgb, Vec2, Vec3};
use crate::scene::Scene;

/// A photon survives roulette at most this often, so that photons between mirrors end.
const MAX_SURVIVAL: f32 = 0.95;

/// What a photon carries from one scattering to the next.
#[derive(Clone, Copy)]
struct Flight {
    power: Rgb,
    sampler: PathSampler,
    bounces: u32,
    /// Distance flown since the last scattering that was not specular.
    travelled: f32,
    specular: bool,
}

/// Buffers of a wave, kept from one to the next.
#[derive(Default)]
pub struct PhotonWave {
    rays: Vec<Ray>,
    hits: Vec<Hit>,
    flights: Vec<Flight>,
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
        while !self.rays.is_empty() {
            self.hits.resize(self.rays.len(), Hit::NONE);
            scene.rays.intersect_batch(&self.rays, &mut self.hits);
            counts.rays += self.rays.len() as u64;
            self.advance(scene, settings, &mut counts, land);
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
            self.rays.push(Ray::new(org, start.dir));
            self.flights.push(Flight {
                power: start.power,
                sampler,
                bounces: 0,
                travelled: 0.0,
                specular: false,
            });
        }
    }

    /// Handles one landing of every photon and keeps those that fly on, in order.
    fn advance(
        &mut self,
        scene: &Scene,
        settings: &PhotonSettings,
        counts: &mut PhotonCounts,
        land: &mut impl FnMut(Landing),
    ) {
        let mut kept = 0;
        for i in 0..self.rays.len() {
            if !self.hits[i].is_some() {
                continue;
            }
            let mut flight = self.flights[i];
            let next = scatter(
                scene,
                settings,
                &self.rays[i],
                &self.hits[i],
                &mut flight,
                counts,
                land,
            );
            let Some(ray) = next else { continue };
            self.rays[kept] = ray;
            self.flights[kept] = flight;
            kept += 1;
        }
        self.rays.truncate(kept);
        self.flights.truncate(kept);
    }
}

/// Records the landing and samples where the photon goes: the next ray, or none.
fn scatter(
    scene: &Scene,
    settings: &PhotonSettings,
    ray: &Ray,
    hit: &Hit,
    flight: &mut Flight,
    counts: &mut PhotonCounts,
    land: &mut impl FnMut(Landing),
) -> Option<Ray> {
    let surface = &scene.surfaces.list[hit.shape as usize];
    let point = scene.surfaces.point(ray, hit, 0.0);
    let wo = -ray.dir;
    let bsdf = scene
        .surfaces
        .materials
        .resolve(surface.material, &point, wo);
    flight.travelled += hit.t;
    if bsdf.flags().has(LobeFlags::SMOOTH) {
        let normal = if point.frame.n.dot(wo) < 0.0 {
            -point.frame.n
        } else {
            point.frame.n
        };
        counts.landings += 1;
        land(Landing {
            position: point.p,
            direction: wo,
            normal,
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
    let org = offset_origin(point.p, point.error, point.ng, sample.wi);
    Some(Ray::new(org, sample.wi))
}
