//! How far light goes until it meets something: through media and the index-matched surfaces
//! between them.

use super::Scene;
use super::path_medium::{PathMedium, segment};
use crate::accel::{Hit, Ray};
use crate::math::Rgb;
use crate::medium::MediumId;

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

/// Samples a free flight along a ray, through index-matched surfaces.
pub fn sample_flight(
    scene: &Scene,
    (ray, hit): (&Ray, &Hit),
    at: &mut PathMedium,
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
