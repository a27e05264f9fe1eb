//! Photons from small lights, to find the chains by which they come.

use super::chains::{SpecularChains, owner};
use super::follow::{LONGEST, SpecularChain};
use super::guess::Guess;
use super::guesses::{Guesses, Landed};
use super::newton::{curved, solve};
use super::receiver::Receiver;
use super::window::{Window, spawn_ray};
use crate::accel::{Hit, Ray};
use crate::bsdf::{LobeFlags, Transport};
use crate::integrate::context::View;
use crate::integrate::guided_vertex::is_guidable;
use crate::light::CausticEmitter;
use crate::math::{PathSampler, Vec2, Vec3};
use crate::photon::schedule::Budget;
use crate::scene::Scene;
use crate::scene::interaction::Interaction;
use crate::scene::wavefront::Wavefront;
use rayon::prelude::*;
use std::ops::Range;

/// Photons of a light that look where glass and mirrors are, each time, at most; and a share of all
/// that go there.
const SCOUTS: u64 = 1 << 16;
const SHARE_OF_SCOUTS: u64 = 4;
/// Times that they look, each time closer, unless so many have found something.
const LOOKS: u32 = 3;
/// So many.
const ENOUGH: usize = 1024;
/// Photons that then go there, of all lights together, where nobody knows how many samples they are
/// for.
const PHOTONS: u64 = 1 << 18;
/// One for so many samples of the image. What no photon has found is met by paths alone, as a
/// speck. (A torus in glass, relative variance without the worst 0.1 % of the pixels, of 3.7
/// million samples with one photon for 8, 16, 32 and 64 of them: 0.0053, 0.0053, 0.0061, 0.0069; of
/// 14.7 million with one for 8 and 32: 0.0026, 0.0026, in 1.16 times the time; with regions of 256
/// photons.)
const SAMPLES_A_PHOTON: u64 = 16;
/// So many for a second, where the time is limited: less than a twentieth of it.
const PHOTONS_A_SECOND: f64 = 8192.0;
/// No fewer, and no more: they are all held until the guesses are chosen, a hundred bytes each and
/// twice for a moment.
const LEAST_AND_MOST: (u64, u64) = (1 << 15, 1 << 19);
/// Lights that are sampled: their numbers have 16 bits.
const MAX_LIGHTS: usize = 1 << 16;
/// Photons in a wave: one task.
const WAVE: u64 = 4096;

/// Photons that are sent for a render of such a budget.
fn photons_for(budget: Budget) -> u64 {
    let Budget::AsNeeded { samples, time } = budget else {
        return PHOTONS;
    };
    let a_while = time.map_or(u64::MAX, |t| (t.as_secs_f64() * PHOTONS_A_SECOND) as u64);
    let (least, most) = LEAST_AND_MOST;
    (samples / SAMPLES_A_PHOTON).min(a_while).clamp(least, most)
}

/// The chains that bring light into a view's scene from where it is small and bright; `None` if
/// there are none, or the view's settings rule them out. The `budget` is that of the render.
pub fn find_chains(view: &View, budget: Budget) -> Option<SpecularChains> {
    // Paths pass index-matched surfaces without counting them, and photons do not.
    let matched = view.scene.media.has_index_matched;
    let wanted = view.settings.guided.manifold && !matched;
    wanted.then(|| find(view.scene, view.settings.seed, budget))?
}

fn find(scene: &Scene, seed: u64, budget: Budget) -> Option<SpecularChains> {
    let photons = photons_for(budget);
    let mut caustic_emitters = scene.lights.caustic_emitters();
    caustic_emitters.truncate(MAX_LIGHTS);
    let mut landed = Vec::new();
    for (number, caustic_emitter) in caustic_emitters.iter().enumerate() {
        let light = Light {
            number: number as u16,
            caustic_emitter,
            seed,
        };
        let Some(window) = light.look(scene, SCOUTS.min(photons / SHARE_OF_SCOUTS)) else {
            continue;
        };
        let flown = light.shine(scene, &window, photons / caustic_emitters.len() as u64);
        landed.extend(flown.into_iter().map(|f| f.landed));
    }
    let covers = |guesses: &[Guess], photon: &Landed| {
        let Guess {
            chain,
            caustic_emitter,
            ..
        } = photon.guess;
        let owner = owner(
            guesses,
            &photon.receiver,
            photon.dir,
            chain,
            caustic_emitter,
        )?;
        let light = &caustic_emitters[caustic_emitter as usize];
        let image = solve(scene, &photon.receiver, &guesses[owner], light, &mut 0)?;
        (image.pdf(photon.dir) > 0.0).then_some(owner)
    };
    let begin = |photon: &Landed| {
        let light = &caustic_emitters[photon.guess.caustic_emitter as usize];
        curved(scene, &photon.receiver, &photon.guess, light).unwrap_or(photon.guess)
    };
    let guesses = Guesses::new(landed, &begin, &covers);
    (!guesses.is_empty()).then_some(SpecularChains {
        caustic_emitters,
        guesses,
    })
}

/// What became of a photon that came by a chain.
struct Flown {
    /// The place of its light's square that it left by.
    at: Vec2,
    landed: Landed,
}

/// A light whose photons are traced.
struct Light<'a> {
    number: u16,
    caustic_emitter: &'a CausticEmitter,
    seed: u64,
}

/// A photon under way.
#[derive(Clone, Copy)]
struct Flight {
    at: Vec2,
    sampler: PathSampler,
    chain: SpecularChain,
    /// Where it scattered last.
    last: Vec3,
}

impl Light<'_> {
    /// The part of it that chains begin behind, as so many photons see it.
    fn look(&self, scene: &Scene, scouts: u64) -> Option<Window> {
        let mut window = Window::ALL;
        for _ in 0..LOOKS {
            let flown = self.shine(scene, &window, scouts);
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

    fn start(&self, scene: &Scene, window: &Window, photon: u64) -> Option<(Flight, Ray)> {
        let number = u64::from(self.number) ^ CHAINS;
        let mut sampler = PathSampler::independent(self.seed, photon, number);
        let [u, v] = [sampler.next4(), sampler.next4()];
        let at = window.sample(Vec2::new(u[0], u[1]));
        let ray = spawn_ray(scene, self.caustic_emitter, at, [v[0], u[2], u[3]])?;
        let flight = Flight {
            at,
            sampler,
            chain: SpecularChain::EMPTY,
            last: Vec3::ZERO,
        };
        Some((flight, ray))
    }

    fn wave(&self, scene: &Scene, window: &Window, range: Range<u64>) -> Vec<Flown> {
        let mut wavefront = Wavefront::default();
        wavefront.extend(range.filter_map(|photon| self.start(scene, window, photon)));
        let mut flown = Vec::new();
        while !wavefront.is_empty() {
            wavefront.advance(scene, |flight: &mut Flight, ray, hit| {
                self.land(scene, (ray, hit), flight, &mut flown)
            });
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
        let met = scene.surfaces.interaction(ray, hit, 0.0)?;
        let bsdf = met.bsdf(&scene.surfaces);
        let Interaction { point, wo, .. } = met;
        if is_guidable(&bsdf, 0) && !flight.chain.is_empty() {
            let landed = Landed {
                receiver: Receiver::new(&point, &bsdf, wo),
                dir: wo,
                guess: Guess::new(point.p, wo, flight.last, flight.chain, self.number),
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
        Some(point.spawn_ray(sample.wi))
    }
}

/// Sets these photons' numbers apart from others'.
const CHAINS: u64 = 0x7f4a_7c15_9e37_79b9;

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn photons_are_as_many_as_the_image_is_worth_and_never_too_many() {
        let of = |samples, seconds: Option<u64>| {
            let time = seconds.map(Duration::from_secs);
            photons_for(Budget::AsNeeded { samples, time })
        };
        let (least, most) = LEAST_AND_MOST;
        assert_eq!(of(16 << 18, None), 1 << 18);
        assert_eq!(of(16 << 18, Some(3600)), 1 << 18);
        assert_eq!(of(u64::MAX, Some(20)), 20 << 13);
        assert_eq!([of(0, None), of(u64::MAX, Some(0))], [least; 2]);
        assert_eq!(
            [of(u64::MAX, None), of(u64::MAX, Some(u64::MAX))],
            [most; 2]
        );
        let given = Budget::Exactly {
            photons: 7,
            batches: 1,
        };
        assert_eq!(photons_for(given), PHOTONS);
    }
}
