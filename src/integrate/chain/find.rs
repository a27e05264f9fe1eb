//! Photons from suns, to find the chains by which they come.

use super::focus::focus;
use super::follow::{Kinds, LONGEST};
use super::seeds::{Landed, Seed, Seeds};
use super::{Chains, Place, owner};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::integrate::guiding::is_guidable;
use crate::light::Beacon;
use crate::math::offset::offset_origin;
use crate::math::warp::concentric_disk;
use crate::math::{Frame, PathSampler, Vec2, Vec3};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;

/// Photons that look where glass and mirrors are.
const SCOUTS: u64 = 1 << 16;
/// Photons of a sun that then go there.
const PHOTONS: u64 = 1 << 18;
/// Photons in a wave: one task.
const WAVE: u64 = 4096;

/// A window that a sun shines through: part of a disk that faces it, from outside the scene.
#[derive(Clone, Copy)]
struct Window {
    frame: Frame,
    center: Vec3,
    radius: f32,
    min: Vec2,
    max: Vec2,
}

/// Finds the chains that bring sunlight into a scene; `None` if there are none.
pub fn find(scene: &Scene, seed: u64) -> Option<Chains> {
    let suns = scene.lights.beacons();
    let mut landed = Vec::new();
    for (number, beacon) in suns.iter().enumerate() {
        let sun = Sun {
            number: number as u32,
            beacon,
            seed,
        };
        let Some(window) = look(scene, &sun) else {
            continue;
        };
        landed.extend(
            sun.shine(scene, &window, PHOTONS)
                .into_iter()
                .map(|f| f.landed),
        );
    }
    let covers = |seeds: &[Seed], photon: &Landed| {
        let Seed { chain, sun, .. } = photon.seed;
        let owner = owner(seeds, &photon.place, photon.dir, chain, sun)?;
        let beacon = &suns[sun as usize];
        let image = focus(scene, &photon.place, &seeds[owner], beacon, &mut 0)?;
        (image.pdf(photon.dir) > 0.0).then_some(owner)
    };
    let seeds = Seeds::new(landed, &covers);
    (!seeds.is_empty()).then_some(Chains { suns, seeds })
}

/// What became of a photon that came by a chain.
struct Flown {
    /// Where it came through the window.
    at: Vec2,
    landed: Landed,
}

/// The part of the sky's window that chains begin behind.
fn look(scene: &Scene, sun: &Sun) -> Option<Window> {
    let bounds = scene.rays.bounds();
    let all = Window {
        frame: Frame::new(sun.beacon.center),
        center: bounds.center(),
        radius: bounds.radius(),
        min: Vec2::splat(-1.0),
        max: Vec2::ONE,
    };
    let flown = sun.shine(scene, &all, SCOUTS);
    let first = flown.first()?.at;
    let (min, max) = flown.iter().fold((first, first), |(min, max), f| {
        (min.min(f.at), max.max(f.at))
    });
    let margin = (max - min) * MARGIN;
    Some(Window {
        min: (min - margin).max(all.min),
        max: (max + margin).min(all.max),
        ..all
    })
}

/// A sun whose photons are traced.
struct Sun<'a> {
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

impl Sun<'_> {
    /// Photons through a window; those that came by chains, in order.
    fn shine(&self, scene: &Scene, window: &Window, count: u64) -> Vec<Flown> {
        let waves: Vec<u64> = (0..count).step_by(WAVE as usize).collect();
        let wave = |&from: &u64| self.wave(scene, window, from..(from + WAVE).min(count));
        let flown: Vec<Vec<Flown>> = waves.par_iter().map(wave).collect();
        flown.into_iter().flatten().collect()
    }

    fn start(&self, window: &Window, photon: u64) -> (Ray, Flight) {
        let mut sampler =
            PathSampler::independent(self.seed, photon, u64::from(self.number) ^ CHAINS);
        let u = sampler.next4();
        let at = window.min + (window.max - window.min) * Vec2::new(u[0], u[1]);
        let off = concentric_disk(Vec2::new(u[2], u[3])) * self.beacon.radius;
        let dir = -window.frame.to_world(off.extend(1.0)).normalize();
        let from = window.center + window.frame.to_world(at.extend(0.0)) * window.radius;
        let ray = Ray::new(from - dir * (2.0 * window.radius), dir);
        let flight = Flight {
            at,
            sampler,
            chain: Kinds::EMPTY,
            last: Vec3::ZERO,
        };
        (ray, flight)
    }

    fn wave(&self, scene: &Scene, window: &Window, range: Range<u64>) -> Vec<Flown> {
        let (mut rays, mut flights): (Vec<Ray>, Vec<Flight>) =
            range.map(|photon| self.start(window, photon)).unzip();
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
                    sun: self.number,
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

/// How much wider the window is than what the scouts saw, on each side.
const MARGIN: f32 = 0.05;
/// Sets these photons' numbers apart from others'.
const CHAINS: u64 = 0x7f4a_7c15_9e37_79b9;
