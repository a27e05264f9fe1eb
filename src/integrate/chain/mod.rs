//! Suns and lamps seen through glass and in mirrors, aimed at.
//!
//! A matt point in a glass cube, or under a wave, sees the sun in a few directions, each of them narrow: the rounded
//! edge of the glass shows it a hundred times smaller than it is. No light sample gets through the glass, and no
//! field over directions knows that direction, for it is another one from every point. But it can be found. Photons
//! tell by which *chains* of mirrors and clear glass light comes into a region (`seeds`), where its image is seen and how that
//! turns as one moves (`seed`); from any point nearby a few steps of Newton's method lead from there to the direction whose chain ends in
//! the middle of the sun or the lamp (`focus`), and the derivative there (`pencil`) says how large it appears.
//!
//! So a rough vertex of a guided path has one more way to sample light, beside its light sample and the direction it
//! goes on by: a seed is drawn, brought into focus, and a direction drawn in the image (`sample`). What the
//! path meets by itself, by the same chain, is weighed against that by multiple importance sampling. For that the density
//! has to be known of any direction, also of one that was not aimed: it is that of the one seed which is seen next to
//! it among those with its chain; what another seed leads to there counts as nothing. (Summed over all seeds
//! that could have led there, a density took five searches instead of one, and variance times time was 1.2 times as
//! much.) Zeltner, Georgiev and Jakob ("Specular manifold sampling", 2020) walk on the surfaces themselves and start anywhere, so that
//! they have no density; starts that are known beforehand have one.
//!
//! It changes no mean, whatever the seeds: what they do not lead to, paths find as they did before. How often it
//! pays is told by a trial ([`pays`]), place by place it is up to the seeds.
//!
//! Relative variance of a sample without the worst 0.1 % of the pixels, and that times processor seconds of 64 samples
//! with learning, never aimed and aimed: a torus in glass under a small sun 2.3, 0.77 and 0.52, 0.29; lux-pool 8.8,
//! 4.5 and 5.2, 4.2; a kitchen 3.3, 1.39 and 3.4, 1.50 (where it does not pay, the search and the trial are the price).
//! `scenes/pool`, whose sun is a far disk, 3.8 and 1.8 for 1.37 times the time, with the worst pixels 10.9 and 2.3.
//! That was with seeds that knew one distance of their image; what none leads to is most of the noise of a long render. Since
//! they know the wavefront's curvature the relative error of the torus at 256 samples a pixel is 0.0030 instead of 0.0049.

mod find;
mod focus;
mod follow;
pub mod pays;
mod pencil;
mod place;
mod sample;
mod seed;
mod seeds;
#[cfg(test)]
mod tests;
mod window;

pub use follow::{Cone, Kinds};
pub use place::{Place, Station};
pub(super) use sample::Request;
pub use sample::{Aimed, Found};

use super::render::View;
use crate::light::{Beacon, Shining};
use crate::math::Vec3;
use crate::math::mis::power_heuristic;
use crate::photon::schedule::Budget;
use crate::scene::Scene;
use focus::focus;
use seed::Seed;
use seeds::Seeds;

/// What is known about the chains that bring light into a scene from where it is small and bright.
#[derive(Debug)]
pub struct Chains {
    beacons: Vec<Beacon>,
    seeds: Seeds,
}

/// Chains to aim by, and how often.
#[derive(Debug)]
pub struct Aiming {
    chains: Chains,
    chance: f32,
}

impl Aiming {
    /// What a view's paths may aim at, if they are to and there is anything: as often as before a trial. The `budget` is
    /// that of the render.
    pub fn find(view: &View, budget: Budget) -> Option<Self> {
        if !view.settings.aim {
            return None;
        }
        Some(Self {
            chains: find::find(view.scene, view.settings.seed, budget)?,
            chance: pays::FIRST,
        })
    }

    /// The same with another chance to aim at a path's first rough vertex.
    pub fn with_chance(self, chance: f32) -> Self {
        Self { chance, ..self }
    }

    /// That chance.
    pub fn chance(&self) -> f32 {
        self.chance
    }

    /// All chains.
    pub fn chains(&self) -> &Chains {
        &self.chains
    }
}

impl Chains {
    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.seeds.bytes()
    }

    /// What `light` counts that a path has met by a chain from a station.
    pub fn weight(&self, scene: &Scene, station: &Station, chain: Kinds, light: Shining) -> f32 {
        let Some(beacon) = self.beacons.iter().position(|b| b.is(light)) else {
            return 1.0;
        };
        let aimed = self.pdf(scene, &station.place, station.dir, chain, beacon as u16);
        power_heuristic(station.pdf, aimed * station.chance)
    }

    /// Density with which aiming from a place draws a direction whose chain is `chain` and ends in `beacon`.
    fn pdf(&self, scene: &Scene, place: &Place, dir: Vec3, chain: Kinds, beacon: u16) -> f32 {
        let seeds = self.seeds.near(place.position);
        let Some(owner) = owner(seeds, place, dir, chain, beacon) else {
            return 0.0;
        };
        let seed = &seeds[owner];
        let light = &self.beacons[beacon as usize];
        let image = focus(scene, place, seed, light, &mut 0);
        let share = place.weight(seed) / total(seeds, place);
        image.map_or(0.0, |image| image.pdf(dir) * share)
    }
}

/// The weights of all seeds, as a place has them.
fn total(seeds: &[Seed], place: &Place) -> f32 {
    seeds.iter().map(|s| place.weight(s)).sum()
}

/// The seed that alone may draw a direction: of those with its chain the one that is seen next to it.
fn owner(seeds: &[Seed], place: &Place, dir: Vec3, chain: Kinds, beacon: u16) -> Option<usize> {
    let mut best = (focus::FARTHEST_COSINE, None);
    for (i, seed) in seeds.iter().enumerate() {
        if seed.chain != chain || seed.beacon != beacon || place.weight(seed) <= 0.0 {
            continue;
        }
        let cosine = seed.seen_from(place.position).normalize_or_zero().dot(dir);
        if cosine > best.0 {
            best = (cosine, Some(i));
        }
    }
    best.1
}
