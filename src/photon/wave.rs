//! A wave of photons that advance together, one scattering at a time.

use super::flight::{Flight, scatter};
use super::media::{self, FlightInMedia};
use super::{Landing, PhotonCounts, PhotonSettings};
use crate::accel::Ray;
use crate::math::offset::offset_sampled;
use crate::math::{PathSampler, Vec3};
use crate::scene::Scene;
use crate::scene::wavefront::Wavefront;

/// Buffers of a wave, kept from one to the next.
#[derive(Default)]
pub struct PhotonWave {
    wavefront: Wavefront<Flight>,
    /// The same in scenes with media.
    in_media: Wavefront<FlightInMedia>,
}

impl PhotonWave {
    /// Traces the photons of `range` to their ends and hands each landing to `land`.
    pub fn trace(
        &mut self,
        scene: &Scene,
        settings: &PhotonSettings,
        range: std::ops::Range<u64>,
        land: &mut impl FnMut(Landing),
    ) -> PhotonCounts {
        let mut counts = PhotonCounts {
            emitted: range.end - range.start,
            ..PhotonCounts::default()
        };
        self.emit(scene, settings, range, &mut counts);
        if !scene.media.is_empty() {
            self.in_media.extend(media::enter(self.wavefront.drain()));
            media::trace(&mut self.in_media, scene, settings, &mut counts, land);
        }
        while !self.wavefront.is_empty() {
            counts.rays += self.wavefront.advance(scene, |flight, ray, hit| {
                scatter(scene, settings, (ray, hit, 0.0), flight, &mut counts, land)
            });
        }
        counts
    }

    fn emit(
        &mut self,
        scene: &Scene,
        settings: &PhotonSettings,
        range: std::ops::Range<u64>,
        counts: &mut PhotonCounts,
    ) {
        for photon in range {
            let mut sampler = PathSampler::independent(settings.seed, photon, u64::MAX);
            let (a, b) = (sampler.next4(), sampler.next4());
            let Some(start) = scene.lights.emit([a[0], a[1], a[2], a[3], b[0]]) else {
                continue;
            };
            if !(start.power.is_finite() && start.dir.is_finite() && start.org.is_finite()) {
                counts.invalid += 1;
                continue;
            }
            let org = if start.ng == Vec3::ZERO {
                start.org
            } else {
                offset_sampled(start.org, start.ng, start.dir)
            };
            let flight = Flight {
                power: start.power,
                sampler,
                bounces: 0,
                travelled: 0.0,
                specular: false,
            };
            self.wavefront.push(flight, Ray::new(org, start.dir));
        }
    }
}
