//! The shadow rays of one bounce of all paths of a wave.

use super::next_event::ShadowRay;
use crate::accel::{Hit, Ray};
use crate::math::{NumberStream, PathSampler, Rgb};
use crate::medium::MediumId;
use crate::scene::Scene;
use crate::scene::free_flight::MOST_PASSED;
use crate::scene::path_medium::PathMedium;

/// Shadow rays, and what they would bring.
#[derive(Default)]
pub(super) struct ShadowRays {
    pub rays: Vec<Ray>,
    pub offers: Vec<ShadowRay>,
    /// Where each begins, in scenes with media.
    pub media: Vec<ShadowMedium>,
}

impl ShadowRays {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.offers.clear();
        self.media.clear();
    }
}

/// A shadow ray's medium, and numbers for its transmittance.
#[derive(Clone, Copy)]
pub(super) struct ShadowMedium {
    pub medium: MediumId,
    pub sampler: PathSampler,
}

impl ShadowRays {
    /// Finds which are blocked in a scene with media, and attenuates what the others bring. Returns
    /// the number of rays.
    pub fn cast(&mut self, scene: &Scene, blocked: &mut [bool]) -> u64 {
        if !scene.media.has_index_matched {
            scene.rays.occluded_batch(&self.rays, blocked);
        }
        let mut traced = 0;
        let each = self.rays.iter().zip(&self.media);
        for (((ray, start), offer), blocked) in each.zip(&mut self.offers).zip(&mut *blocked) {
            if *blocked {
                continue;
            }
            let found = start.attenuation(scene, ray, &mut traced);
            *blocked = found == Rgb::ZERO;
            offer.offer.attenuate(found);
        }
        match scene.media.has_index_matched {
            true => traced,
            false => self.rays.len() as u64,
        }
    }
}

impl ShadowMedium {
    /// What comes through along a shadow ray that begins here; 0 where a surface blocks it.
    pub fn transmittance(&self, scene: &Scene, ray: &Ray, traced: &mut u64) -> Rgb {
        if !scene.media.has_index_matched {
            *traced += 1;
            if scene.rays.occluded(ray) {
                return Rgb::ZERO;
            }
        }
        self.attenuation(scene, ray, traced)
    }

    /// The same for a ray that no surface blocks, unless some surface is index-matched: then that
    /// is found out on the way.
    fn attenuation(&self, scene: &Scene, ray: &Ray, traced: &mut u64) -> Rgb {
        let media = &scene.media;
        let mut numbers = NumberStream::from(self.sampler);
        let mut u = || numbers.draw();
        let mut at = PathMedium::inside(self.medium);
        let (mut ray, mut found) = (*ray, Rgb::ONE);
        for _ in 0..MOST_PASSED {
            let hit = match media.has_index_matched {
                true => {
                    *traced += 1;
                    scene.rays.intersect(&ray)
                }
                false => Hit::NONE,
            };
            if hit.is_some() && !media.side(&hit).index_matched {
                return Rgb::ZERO;
            }
            found *= at.transmittance(scene, &ray, &hit, &mut u);
            if !hit.is_some() || found == Rgb::ZERO {
                return found;
            }
            ray = at.cross(scene, &ray, &hit);
        }
        Rgb::ZERO
    }
}
