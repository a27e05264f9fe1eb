//! Photons in scenes with participating media: they collide between surfaces.

use super::flight::{Flight, scatter};
use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::Ray;
use crate::math::{NumberStream, Rgb, Vec2, Vec3};
use crate::medium::MediumId;
use crate::scene::Scene;
use crate::scene::free_flight::{FreeFlight, sample_flight};
use crate::scene::path_medium::PathMedium;
use crate::scene::wavefront::Wavefront;

/// Numbers of the photons' sequences: beside those of the photon itself.
const FLIGHT: u32 = 0x666c_6967;

/// A photon and the medium that it is in, once its first ray has told.
#[derive(Clone, Copy)]
pub(super) struct FlightInMedia {
    flight: Flight,
    at: Option<PathMedium>,
}

/// Photons that begin wherever their lights are.
pub(super) fn enter(
    photons: impl Iterator<Item = (Flight, Ray)>,
) -> impl Iterator<Item = (FlightInMedia, Ray)> {
    photons.map(|(flight, ray)| (FlightInMedia { flight, at: None }, ray))
}

/// Traces all photons of a wavefront to their ends.
pub(super) fn trace(
    wavefront: &mut Wavefront<FlightInMedia>,
    scene: &Scene,
    settings: &PhotonSettings,
    counts: &mut PhotonCounts,
    land: &mut impl FnMut(Landing),
) {
    while !wavefront.is_empty() {
        let mut passed = 0;
        let rays = wavefront.advance(scene, |photon, ray, hit| {
            let FlightInMedia { flight, at } = photon;
            let begin = || PathMedium::inside(scene.medium_along(ray, hit));
            let at = at.get_or_insert_with(begin);
            let first = flight.sampler.next4();
            let mut numbers = NumberStream::new(first, flight.sampler.fork(FLIGHT));
            let flown = sample_flight(scene, (ray, hit), at, &mut (), &mut || numbers.draw());
            passed += flown.rays;
            flight.power *= flown.factor;
            if flight.power == Rgb::ZERO {
                return None;
            }
            if let Some(collision) = flown.collision {
                return collide(scene, settings, (&flown, collision), flight, counts, land);
            }
            if flown.hit.is_some() {
                at.arrive(scene, &flown.ray, &flown.hit);
            }
            let met = (&flown.ray, &flown.hit, flown.before);
            scatter(scene, settings, met, flight, counts, land)
        });
        counts.rays += rays + passed;
    }
}

/// Records a collision and samples where the photon goes. Its power is what the medium scatters: a
/// landing tells of all that collides.
fn collide(
    scene: &Scene,
    settings: &PhotonSettings,
    (flown, (distance, medium)): (&FreeFlight, (f32, MediumId)),
    flight: &mut Flight,
    counts: &mut PhotonCounts,
    land: &mut impl FnMut(Landing),
) -> Option<Ray> {
    let medium = scene.media.list().get(medium)?;
    let (position, dir) = (flown.ray.at(distance), flown.ray.dir);
    let albedo = medium.extinction.albedo(position);
    flight.travelled += flown.before + distance;
    counts.landings += 1;
    land(Landing {
        position,
        direction: -dir,
        normal: Vec3::ZERO,
        power: Rgb::select(albedo.cmpgt(Rgb::ZERO), flight.power / albedo, Rgb::ZERO),
        distance: flight.travelled,
        bounces: flight.bounces,
        specular: flight.specular,
    });
    if flight.bounces >= settings.max_bounces {
        return None;
    }
    let u = flight.sampler.next4();
    // The albedo is in the power already.
    let survival = flight.roulette(settings, albedo, u[3])?;
    flight.scattered(Rgb::ONE / survival, false, counts)?;
    let next = medium.phase.sample(dir, u[0], Vec2::new(u[1], u[2]));
    Some(Ray::new(position, next))
}
