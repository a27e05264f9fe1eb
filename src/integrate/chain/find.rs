//! Photons from small lights, to find the chains by which they come.

use super::focus::focus;
use super::follow::{Kinds, LONGEST};
use super::seeds::{Landed, Seed, Seeds};
use super::window::{Window, leave};
use super::{Chains, Place, owner};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::integrate::guiding::is_guidable;
use crate::light::Beacon;
use crate::math::offset::offset_origin;
use crate::math::{PathSampler, Vec2, Vec3};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;

/// Photons of a light that look where glass and mirrors are, each time.
const SCOUTS: u64 = 1 << 16;
/// Times that they look, each time closer, unless so many have found something.
const LOOKS: u32 = 3;
/// So many.
const ENOUGH: usize = 1024;
/// Photons that then go there, of all lights together.
const PHOTONS: u64 = 1 << 18;
/// Photons in a wave: one task.
const WAVE: u64 = 4096;

/// Finds the chains that bring light into a scene from where it is small and bright; `None` if there are none.
pub fn find(scene: &Scene, seed: u64) -> Option<Chains> {
    let beacons = scene.lights.beacons();
    let mut landed = Vec::new();
    for (number, beacon) in beacons.iter().enumerate() {
        let light = Light {
            number: number as u32,
            beacon,
            seed,
        };
        let Some(window) = light.look(scene) else {
            continue;
        };
        let photons = PHOTONS / beacons.len() as u64;
        let flown = light.shine(scene, &window, photons);
        landed.extend(flown.into_iter().map(|f| f.landed));
    }
    let covers = |seeds: &[Seed], photon: &Landed| {
        let Seed { chain, beacon, .. } = photon.seed;
        let owner = owner(seeds, &photon.place, photon.dir, chain, beacon)?;
        let light = &beacons[beacon as usize];
        let image = focus(scene, &photon.place, &seeds[owner], light, &mut 0)?;
        (image.pdf(photon.dir) > 0.0).then_some(owner)
    };
    let seeds = Seeds::new(landed, &covers);
    (!seeds.is_empty()).then_some(Chains { beacons, seeds })
}

/// What became of a photon that came by a chain.
struct Flown {
    /// The place of its light's square that it left by.
    at: Vec2,
    landed: Landed,
}

/// A light whose photons are traced.
struct Light<'a> {
    number: u32,
    beacon: &'a Beacon,
    seed: u64,
}

/// A photon under way.
#[derive(Clone, Copy)]
struct Flight {
    at: Vec2,
    sampler: PathSampler,
    chain: Kinds,
    /// Where it scattered last.
    last: Vec3,
}

impl Light<'_> {
    /// The part of it that chains begin behind.
    fn look(&self, scene: &Scene) -> Option<Window> {
        let mut window = Window::ALL;
        for _ in 0..LOOKS {
            let flown = self.shine(scene, &window, SCOUTS);
            window = Window::around(flown.iter().map(|f| f.at))?;
            if flown.len() >= ENOUGH {
                break;
            }
        }
        Some(window)
    }

    /// Photons through a window; those that came by chains, in order.
    fn shine(&self, scene: &Scene, window: &Window, count: u64) -> Vec<Flown> {
        let waves: Vec<u64> = (0..count).step_by(WAVE as usize).collect();
        let wave = |&from: &u64| self.wave(scene, window, from..(from + WAVE).min(count));
        let flown: Vec<Vec<Flown>> = waves.par_iter().map(wave).collect();
        flown.into_iter().flatten().collect()
    }

    fn start(&self, scene: &Scene, window: &Window, photon: u64) -> Option<(Ray, Flight)> {
        let number = u64::from(self.number) ^ CHAINS;
        let mut sampler = PathSampler::independent(self.seed, photon, number);
        let [u, v] = [sampler.next4(), sampler.next4()];
        let at = window.sample(Vec2::new(u[0], u[1]));
        let ray = leave(scene, self.beacon, at, [v[0], u[2], u[3]])?;
        let flight = Flight {
            at,
            sampler,
            chain: Kinds::EMPTY,
            last: Vec3::ZERO,
        };
        Some((ray, flight))
    }

    fn wave(&self, scene: &Scene, window: &Window, range: Range<u64>) -> Vec<Flown> {
        let (mut rays, mut flights): (Vec<Ray>, Vec<Flight>) = range
            .filter_map(|photon| self.start(scene, window, photon))
            .unzip();
        let (mut hits, mut flown) = (Vec::new(), Vec::new());
        while !rays.is_empty() {
            hits.resize(rays.len(), Hit::NONE);
            scene.rays.intersect_batch(&rays, &mut hits);
            let mut kept = 0;
            for i in 0..rays.len() {
                let mut flight = flights[i];
                let next = self.land(scene, (&rays[i], &hits[i]), &mut flight, &mut flown);
                let Some(ray) = next else { continue };
                rays[kept] = ray;
                flights[kept] = flight;
                kept += 1;
            }
            rays.truncate(kept);
            flights.truncate(kept);
        }
        flown
    }

    /// Notes the photon, if it came by a chain, and lets it fly on by a delta lobe.
    fn land(
        &self,
        scene: &Scene,
        (ray, hit): (&Ray, &Hit),
        flight: &mut Flight,
        flown: &mut Vec<Flown>,
    ) -> Option<Ray> {
        if !hit.is_some() {
            return None;
        }
        let surfaces = &scene.surfaces;
        let point = surfaces.point(ray, hit, 0.0);
        let wo = -ray.dir;
        let material = surfaces.list[hit.shape as usize].material;
        let bsdf = surfaces.materials.resolve(material, &point, wo);
        if is_guidable(&bsdf) && !flight.chain.is_empty() {
            let landed = Landed {
                place: Place::new(&point, &bsdf, wo),
                dir: wo,
                seed: Seed {
                    point: flight.last,
                    chain: flight.chain,
                    beacon: self.number,
                    weight: 1.0,
                },
            };
            let at = flight.at;
            flown.push(Flown { at, landed });
        }
        if !bsdf.flags().has(LobeFlags::DELTA) || flight.chain.len() >= LONGEST {
            return None;
        }
        let u = flight.sampler.next4();
        let sample = bsdf.sample(wo, u[0], Vec2::new(u[1], u[2]), Transport::Importance)?;
        if !sample.lobe.has(LobeFlags::DELTA) {
            return None;
        }
        flight.chain = flight.chain.before(sample.lobe);
        flight.last = point.p;
        let org = offset_origin(point.p, point.error, point.ng, sample.wi);
        Some(Ray::new(org, sample.wi))
    }
}

/// Sets these photons' numbers apart from others'.
const CHAINS: u64 = 0x7f4a_7c15_9e37_79b9;
