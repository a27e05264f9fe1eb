//! Light that scatters once between two vertices of a path, found by the lights beside it.
//!
//! Free flight draws distances by how much of the medium lies on the way: near a lamp that is rare.
//! On every segment of a scattering medium a distance is drawn by a light, too (see
//! [`crate::light::LitSegment`]), and the light sampled from there. MIS weighs that against
//! collisions by free flight ([`Lights::free_flight_weight`]), whose light samples and whose
//! directions that meet the light count for the rest. [`Collision`] carries what those need to know.
//!
//! [`Lights::free_flight_weight`]: crate::light::Lights::free_flight_weight

use super::next_event::shadow_ray;
use super::shadows::ShadowMedium;
use crate::bsdf::{Bsdf, Transport};
use crate::light::{Collision, DrawnDistance, LightSource, LitSegment};
use crate::math::{PathSampler, Rgb, Vec2};
use crate::medium::{ChannelWeights, Medium, Segment};
use crate::scene::Scene;
use crate::scene::free_flight::{FlightObserver, FreeFlight};
use crate::scene::path_medium::PathMedium;
use crate::texture::SurfacePoint;

/// Edges of a path on which lights draw distances, from the camera on. Later ones cost as much and
/// bring little: in media that scatter often a path has dozens of them.
pub(super) const EDGES: u32 = 4;

/// What is found along one free flight.
pub(super) struct BesideFlight<'a> {
    scene: &'a Scene,
    sampler: PathSampler,
    /// Number of the segment in the flight.
    segments: u32,
    /// The last segment, if it scatters and lights are beside it, and how likely each channel was
    /// to come there.
    last: Option<(LitSegment, ChannelWeights)>,
    /// Light found, to be multiplied by the path's throughput, and where it is from.
    pub found: smallvec::SmallVec<[(Rgb, LightSource); 1]>,
    /// Rays that it took.
    pub rays: u64,
}

impl<'a> BesideFlight<'a> {
    /// Nothing is found yet; `sampler` gives the numbers.
    pub fn new(scene: &'a Scene, sampler: PathSampler) -> Self {
        Self {
            scene,
            sampler,
            segments: 0,
            last: None,
            found: Default::default(),
            rays: 0,
        }
    }

    /// What a collision on the last segment has to know.
    pub fn collision(&self, distance: f32, medium: &Medium) -> Option<Collision> {
        let (lit, weights) = self.last?;
        Some(collision(&lit, distance, medium, &weights).0)
    }
}

/// The collision at a distance, and what the segment lets through until there.
fn collision(
    lit: &LitSegment,
    distance: f32,
    medium: &Medium,
    weights: &ChannelWeights,
) -> (Collision, Rgb) {
    let segment = lit.segment();
    let passed = medium
        .extinction
        .exact_transmittance(&segment.until(distance));
    let sigma_t = medium.extinction.sigma_t(segment.at(distance));
    let collision = Collision {
        lit: *lit,
        distance,
        density: weights.density(sigma_t * passed),
    };
    (collision, sigma_t * passed)
}

impl FlightObserver for BesideFlight<'_> {
    fn enters(&mut self, segment: &Segment, medium: &Medium, at: &PathMedium, flight: &FreeFlight) {
        self.last = None;
        self.segments += 1;
        if !medium.extinction.scatters() {
            return;
        }
        let lights = &self.scene.lights;
        let Some(lit) = lights.beside(*segment, medium.extinction.least()) else {
            return;
        };
        self.last = Some((lit, at.weights));
        let mut sampler = self.sampler.fork(self.segments);
        let [u0, u1, u2, u3] = sampler.next4();
        let drawn = lights.distance_beside(&lit, [u0, u1]);
        let found = drawn.and_then(|drawn| {
            self.light_at(&lit, &drawn, (medium, at), (Vec2::new(u2, u3), sampler))
        });
        self.found
            .extend(found.map(|(light, from)| (light * flight.factor, from)));
    }
}

impl BesideFlight<'_> {
    /// The light that scatters at a distance that was drawn by a light.
    fn light_at(
        &mut self,
        lit: &LitSegment,
        drawn: &DrawnDistance,
        (medium, at): (&Medium, &PathMedium),
        (u, sampler): (Vec2, PathSampler),
    ) -> Option<(Rgb, LightSource)> {
        let lights = &self.scene.lights;
        let segment = lit.segment();
        let (p, wo) = (segment.at(drawn.distance), -segment.direction);
        let light = lights.sample_leaf(drawn.leaf, p, u)?;
        let albedo = medium.extinction.albedo(p);
        let bsdf = Bsdf::of_medium(medium.phase, albedo, wo);
        let (phase, _) = bsdf.eval_pdf(wo, light.dir, Transport::Radiance);
        let (collision, collides) = collision(lit, drawn.distance, medium, &at.weights);
        let weight = 1.0 - lights.free_flight_weight(&collision, drawn.leaf);
        let factor = collides * albedo * phase * (weight / (drawn.pdf * light.pdf));
        let radiance = factor * lights.radiance(&light.incoming);
        if radiance == Rgb::ZERO {
            return None;
        }
        let origin = SurfacePoint::in_volume(p, wo, 0.0).spawn_ray(light.dir).org;
        let ray = shadow_ray(origin, p + light.dir * light.distance);
        let start = ShadowMedium {
            medium: at.medium(segment.direction),
            sampler,
        };
        let passed = start.transmittance(self.scene, &ray, &mut self.rays);
        let from = lights.source_of(&light.incoming, light.dir);
        (passed != Rgb::ZERO).then_some((radiance * passed, from))
    }
}
