//! The specular chains that bring light into a scene, and the density of sampling them.

use super::follow::SpecularChain;
use super::guess::Guess;
use super::guesses::Guesses;
use super::newton::{FARTHEST_COSINE, solve};
use super::receiver::{LastRoughVertex, Receiver};
use crate::light::{CausticEmitter, Shining};
use crate::math::Vec3;
use crate::math::mis::power_heuristic;
use crate::scene::Scene;

/// What is known about the chains that bring light into a scene from where it is small and bright.
#[derive(Debug)]
pub struct SpecularChains {
    pub(super) caustic_emitters: Vec<CausticEmitter>,
    pub(super) guesses: Guesses,
}

/// The probability to sample a chain before a trial (see [`super::rate`]).
pub const INITIAL_RATE: f32 = 0.125;

/// Manifold next-event estimation: specular chains, and how often they are sampled.
#[derive(Debug)]
pub struct ManifoldSampling {
    chains: SpecularChains,
    rate: f32,
}

impl ManifoldSampling {
    /// These chains, sampled as often as before a trial.
    pub fn new(chains: SpecularChains) -> Self {
        Self {
            chains,
            rate: INITIAL_RATE,
        }
    }

    /// The same with another probability to sample a chain at a path's first rough vertex.
    pub fn with_rate(self, rate: f32) -> Self {
        Self { rate, ..self }
    }

    /// That probability.
    pub fn rate(&self) -> f32 {
        self.rate
    }

    /// All chains.
    pub fn chains(&self) -> &SpecularChains {
        &self.chains
    }
}

impl SpecularChains {
    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.guesses.bytes()
    }

    /// MIS weight of `light` that a path has met by a chain from its last rough vertex.
    pub fn weight(
        &self,
        scene: &Scene,
        rough_vertex: &LastRoughVertex,
        chain: SpecularChain,
        light: Shining,
    ) -> f32 {
        let Some(caustic_emitter) = self.caustic_emitters.iter().position(|b| b.is(light)) else {
            return 1.0;
        };
        let pdf = self.pdf(
            scene,
            &rough_vertex.receiver,
            rough_vertex.dir,
            chain,
            caustic_emitter as u16,
        );
        power_heuristic(rough_vertex.pdf, pdf * rough_vertex.probability)
    }

    /// Density with which a receiver draws a direction whose chain is `chain` and ends in
    /// `caustic_emitter`.
    fn pdf(
        &self,
        scene: &Scene,
        receiver: &Receiver,
        dir: Vec3,
        chain: SpecularChain,
        caustic_emitter: u16,
    ) -> f32 {
        let guesses = self.guesses.near(receiver.position);
        let Some(owner) = owner(guesses, receiver, dir, chain, caustic_emitter) else {
            return 0.0;
        };
        let guess = &guesses[owner];
        let light = &self.caustic_emitters[caustic_emitter as usize];
        let image = solve(scene, receiver, guess, light, &mut 0);
        let share = receiver.weight(guess) / total(guesses, receiver);
        image.map_or(0.0, |image| image.pdf(dir) * share)
    }
}

/// The weights of all guesses at a receiver.
pub(super) fn total(guesses: &[Guess], receiver: &Receiver) -> f32 {
    guesses.iter().map(|s| receiver.weight(s)).sum()
}

/// The guess that alone may draw a direction: of those with its chain the one seen next to it.
pub(super) fn owner(
    guesses: &[Guess],
    receiver: &Receiver,
    dir: Vec3,
    chain: SpecularChain,
    caustic_emitter: u16,
) -> Option<usize> {
    let mut best = (FARTHEST_COSINE, None);
    for (i, guess) in guesses.iter().enumerate() {
        if guess.chain != chain
            || guess.caustic_emitter != caustic_emitter
            || receiver.weight(guess) <= 0.0
        {
            continue;
        }
        let cosine = guess
            .seen_from(receiver.position)
            .normalize_or_zero()
            .dot(dir);
        if cosine > best.0 {
            best = (cosine, Some(i));
        }
    }
    best.1
}
