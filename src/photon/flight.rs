//! A photon on its way, and how it scatters at a surface.

use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::math::{PathSampler, Rgb, Vec2};
use crate::scene::Scene;

/// A photon survives roulette at most this often, so that photons between mirrors end, and those in
/// a cloud that absorbs nothing.
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

impl Flight {
    /// The probability with which roulette lets the photon survive a scattering that leaves `left`
    /// of its power; `None` if it ends. Powers differ between emitters: what is thinned is the loss
    /// at this scattering.
    pub fn roulette(&self, settings: &PhotonSettings, left: Rgb, u: f32) -> Option<f32> {
        if self.bounces < settings.roulette_after {
            return Some(1.0);
        }
        let survival = left.max_element().min(MAX_SURVIVAL);
        (u < survival).then_some(survival)
    }

    /// The photon goes on with its power times `weight`, by a `delta` lobe or another. `None` where
    /// that power is no number.
    pub fn scattered(&mut self, weight: Rgb, delta: bool, counts: &mut PhotonCounts) -> Option<()> {
        self.power *= weight;
        if !self.power.is_finite() {
            counts.invalid += 1;
            return None;
        }
        self.specular = delta && (self.specular || self.bounces == 0);
        if !delta {
            self.travelled = 0.0;
        }
        self.bounces += 1;
        Some(())
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
    let survival = flight.roulette(settings, sample.weight, u[3])?;
    let delta = sample.lobe.has(LobeFlags::DELTA);
    flight.scattered(sample.weight / survival, delta, counts)?;
    Some(point.spawn_ray(sample.wi))
}
