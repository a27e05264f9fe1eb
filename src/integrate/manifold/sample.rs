//! Light by a chain, sampled at a rough vertex.

use super::chains::{SpecularChains, owner, total};
use super::follow::{Arrived, Cone, follow};
use super::newton::solve;
use super::receiver::Receiver;
use crate::accel::{Hit, Ray};
use crate::bsdf::Transport;
use crate::integrate::context::PathContext;
use crate::integrate::vertex::Vertex;
use crate::light::{CausticEmitter, LightSource, Shining};
use crate::math::frame::normals_disagree;
use crate::math::mis::power_heuristic;
use crate::math::{NumberStream, PathSampler, Rgb, Vec2};
use crate::scene::Scene;
use crate::scene::path_medium::PathMedium;

/// What is to be sampled.
pub(in crate::integrate) struct Request<'v, 's> {
    pub context: &'v PathContext<'s>,
    pub vertex: &'v Vertex<'v, 's>,
    /// The vertex.
    pub receiver: &'v Receiver,
    /// The probability with which it is asked for.
    pub probability: f32,
    /// Most scatterings of the chain.
    pub most: u32,
    /// What rays stand for that leave the vertex.
    pub cone: Cone,
    /// Numbers for what media let through.
    pub numbers: PathSampler,
}

/// A light that was found.
#[derive(Clone, Copy, Debug)]
pub struct FoundLight {
    /// Radiance that the vertex reflects, before it is divided by a density.
    pub radiance: Rgb,
    /// Density with which it was drawn, solid angle, the probability of drawing at all included.
    pub pdf: f32,
    /// Density with which the path would have drawn it by itself.
    pub path_pdf: f32,
    /// Scatterings of the chain.
    pub chain: u32,
    /// What it comes from.
    pub from: LightSource,
}

impl FoundLight {
    /// What the vertex gains.
    pub fn light(&self) -> Rgb {
        self.radiance * (power_heuristic(self.pdf, self.path_pdf) / self.pdf)
    }
}

/// What came of sampling a chain.
#[derive(Clone, Copy, Debug, Default)]
pub struct ManifoldSample {
    /// The light.
    pub found: Option<FoundLight>,
    /// Rays that it took.
    pub rays: u32,
}

impl SpecularChains {
    /// Samples light that arrives at a vertex by a chain. `u` are three uniform numbers: one
    /// chooses the guess, two the place in the image.
    pub(in crate::integrate) fn sample(&self, request: &Request, u: [f32; 3]) -> ManifoldSample {
        let mut rays = 0;
        let found = self.find(request, u, &mut rays);
        ManifoldSample { found, rays }
    }

    fn find(&self, request: &Request, u: [f32; 3], rays: &mut u32) -> Option<FoundLight> {
        let Request {
            context,
            vertex,
            receiver,
            ..
        } = *request;
        let scene = context.scene;
        let guesses = self.guesses.near(receiver.position);
        let total = total(guesses, receiver);
        let mut rest = u[0] * total;
        let chosen = guesses.iter().position(|s| {
            rest -= receiver.weight(s);
            rest < 0.0
        })?;
        let guess = &guesses[chosen];
        if guess.chain.len() > request.most {
            return None;
        }
        let caustic_emitter = &self.caustic_emitters[guess.caustic_emitter as usize];
        let image = solve(scene, receiver, guess, caustic_emitter, rays)?;
        let (dir, image_pdf) = image.sample(Vec2::new(u[1], u[2]));
        let pdf = image_pdf * (receiver.weight(guess) / total * request.probability);
        let usable = pdf > 0.0 && pdf.is_finite();
        if !usable
            || owner(guesses, receiver, dir, guess.chain, guess.caustic_emitter) != Some(chosen)
        {
            return None;
        }
        let strict = context.settings.strict_normals;
        let normals = vertex.point.normals();
        if strict && normals_disagree(normals, [dir, vertex.wo]) {
            return None;
        }
        let (f, bsdf_pdf) = vertex.bsdf.eval_pdf(vertex.wo, dir, Transport::Radiance);
        if f == Rgb::ZERO {
            return None;
        }
        *rays += guess.chain.len() + 1;
        let chain = (guess.chain, request.cone);
        let mut passed = ChainTransmittance::new(request);
        let mut seen = |ray: &Ray, hit: &Hit| passed.pass(scene, ray, hit);
        let arrived = follow(scene, receiver.ray(dir), chain, strict, &mut seen)?;
        let (light, from, hit) = shining(scene, caustic_emitter, &arrived)?;
        passed.pass(scene, &arrived.ray, &hit);
        let radiance = f * (arrived.weight * passed.transmittance * light);
        Some(FoundLight {
            radiance,
            pdf,
            path_pdf: vertex.guided.map_or(bsdf_pdf, |g| g.pdf(dir, bsdf_pdf)),
            chain: guess.chain.len(),
            from: from.into(),
        })
    }
}

/// What the media along a chain let through.
struct ChainTransmittance {
    at: Option<PathMedium>,
    transmittance: Rgb,
    numbers: NumberStream,
}

impl ChainTransmittance {
    fn new(request: &Request) -> Self {
        Self {
            at: request.vertex.media.copied(),
            transmittance: Rgb::ONE,
            numbers: request.numbers.into(),
        }
    }

    fn pass(&mut self, scene: &Scene, ray: &Ray, hit: &Hit) {
        if let Some(at) = &mut self.at {
            let numbers = &mut self.numbers;
            self.transmittance *= at.pass(scene, ray, hit, &mut || numbers.draw());
        }
    }
}

/// What a light sends along the end of a chain, if the chain ends there, what that light is, and
/// what the chain's last ray has met.
fn shining(
    scene: &Scene,
    caustic_emitter: &CausticEmitter,
    arrived: &Arrived,
) -> Option<(Rgb, Shining, Hit)> {
    let Arrived { ray, mut cone, .. } = *arrived;
    if let CausticEmitter::Sun { .. } = caustic_emitter {
        let sky = Shining::Sky(ray.dir);
        if !caustic_emitter.is(sky) {
            return None;
        }
        let light = || (scene.lights.environment(ray.dir), sky, Hit::NONE);
        return (!scene.is_blocked(&ray)).then(light);
    }
    let hit = scene.first_hit(&ray);
    cone.grow(hit.t);
    let surface = scene.surfaces.met(&hit)?;
    let shape = Shining::Shape(surface.emitter);
    if !caustic_emitter.is(shape) {
        return None;
    }
    let point = scene.surfaces.point(&ray, &hit, cone.width);
    Some((scene.emitted(surface, &point, -ray.dir), shape, hit))
}
