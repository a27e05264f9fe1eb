//! How far light goes until it meets something: through media and the index-matched surfaces
//! between them.

use super::Scene;
use super::path_medium::{PathMedium, segment};
use crate::accel::{Hit, Ray};
use crate::math::Rgb;
use crate::medium::{Medium, MediumId, Segment};

/// Index-matched surfaces that a ray passes at most: more are a bug of the geometry, and the path
/// ends.
pub const MOST_PASSED: u32 = 10_000;

/// The free flight of a path: until it met a surface, collided or left the scene.
pub struct FreeFlight {
    /// Its last segment.
    pub ray: Ray,
    /// What ended that, if a surface did.
    pub hit: Hit,
    /// Distance to the begin of that.
    pub before: f32,
    /// What the throughput is multiplied by: what came through, and the albedo of a collision.
    pub factor: Rgb,
    /// Distance of a collision on it, and the medium.
    pub collision: Option<(f32, MediumId)>,
    /// Rays that it took beyond the first.
    pub rays: u64,
}

impl FreeFlight {
    /// How far it went; infinite where nothing ended it.
    pub fn distance(&self) -> f32 {
        let last = self.collision.map_or(self.hit.t, |(distance, _)| distance);
        match self.collision.is_some() || self.hit.is_some() {
            true => self.before + last,
            false => f32::INFINITY,
        }
    }
}

/// What happens along a free flight besides.
pub trait FlightObserver {
    /// The flight enters a segment of a medium, as likely in each channel as `at` says.
    fn enters(&mut self, segment: &Segment, medium: &Medium, at: &PathMedium, flight: &FreeFlight);
}

/// Nothing.
impl FlightObserver for () {
    fn enters(&mut self, _: &Segment, _: &Medium, _: &PathMedium, _: &FreeFlight) {}
}

/// Samples a free flight along a ray, through index-matched surfaces.
pub fn sample_flight(
    scene: &Scene,
    (ray, hit): (&Ray, &Hit),
    at: &mut PathMedium,
    observer: &mut impl FlightObserver,
    u: &mut impl FnMut() -> f32,
) -> FreeFlight {
    let media = &scene.media;
    let mut flight = FreeFlight {
        ray: *ray,
        hit: *hit,
        before: 0.0,
        factor: Rgb::ONE,
        collision: None,
        rays: 0,
    };
    for _ in 0..MOST_PASSED {
        let id = at.medium(flight.ray.dir);
        if let Some(medium) = media.list().get(id) {
            let segment = segment(&flight.ray, &flight.hit);
            observer.enters(&segment, medium, at, &flight);
            let sampled = medium.extinction.sample(&segment, &mut at.weights, u);
            flight.factor *= sampled.factor;
            if let Some(distance) = sampled.collision {
                flight.collision = Some((distance, id));
                at.stay(id);
                return flight;
            }
        }
        if !flight.hit.is_some() || !media.side(&flight.hit).index_matched {
            return flight;
        }
        flight.before += flight.hit.t;
        flight.ray = at.cross(scene, &flight.ray, &flight.hit);
        flight.hit = scene.rays.intersect(&flight.ray);
        flight.rays += 1;
    }
    flight.factor = Rgb::ZERO;
    flight
}
