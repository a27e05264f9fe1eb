//! What a film wants to know of its samples besides (see [`Extras`]), recorded while their paths
//! travel.
//!
//! It watches paths beside whoever else does. Where the film wants nothing more, that costs a
//! comparison a sample.

use super::light_sums::LightSums;
use super::manifold::ManifoldSample;
use super::observer::{Departure, PathObserver};
use super::path::Arrival;
use crate::accel::Hit;
use crate::film::{ExtraSample, Extras, FirstPoint};
use crate::light::{LightSource, Lights};
use crate::math::Rgb;
use crate::texture::SurfacePoint;
use std::sync::Arc;

/// What was recorded of a wave's samples.
#[derive(Clone, Debug, Default)]
pub struct Recorded {
    first: Option<Vec<Option<FirstPoint>>>,
    light: Option<LightSums>,
}

impl Recorded {
    /// Forgets all samples; records from now on what these extras need.
    pub fn start(&mut self, extras: &Arc<Extras>) {
        if let Some(light) = self.light.as_mut().filter(|light| light.are_for(extras)) {
            light.clear();
        } else {
            self.light = LightSums::new(extras);
        }
        self.first = match extras.wants_first_points() {
            true => {
                let mut first = self.first.take().unwrap_or_default();
                first.clear();
                Some(first)
            }
            false => None,
        };
    }

    /// What sample number `i` of the wave brings besides.
    #[inline]
    pub fn of(&self, i: usize) -> ExtraSample<'_> {
        ExtraSample {
            first: self.first.as_ref().and_then(|first| first[i]),
            light: self.light.as_ref().map_or(&[], |light| light.of(i)),
        }
    }

    /// Light that is taken into parts, if that is asked for.
    pub(super) fn light(&mut self) -> Option<&mut LightSums> {
        self.light.as_mut()
    }
}

/// Records, and lets another watch.
pub(super) struct Recording<'r, O> {
    pub observer: &'r mut O,
    pub recorded: &'r mut Recorded,
    pub lights: &'r Lights,
}

impl<O: PathObserver> PathObserver for Recording<'_, O> {
    #[inline(always)]
    fn sees(&mut self, met: Option<(&SurfacePoint, &Hit)>) {
        if let Some(first) = &mut self.recorded.first {
            first.push(met.map(|(point, hit)| FirstPoint {
                position: point.p,
                uv: point.uv,
                normal: point.ng,
                shape: hit.shape,
            }));
        }
    }

    #[inline(always)]
    fn shines(&mut self, accumulator: u32, bounces: u32, light: Rgb, from: LightSource) {
        if let Some(sums) = &mut self.recorded.light {
            sums.add(self.lights, accumulator, bounces, light, from);
        }
    }

    #[inline(always)]
    fn wants_sources(&self) -> bool {
        self.recorded.light.is_some()
    }

    #[inline(always)]
    fn wants(&self, accumulator: u32) -> bool {
        self.observer.wants(accumulator)
    }

    #[inline(always)]
    fn arrive(&mut self, accumulator: u32, radiance: Rgb, distance: f32) {
        self.observer.arrive(accumulator, radiance, distance);
    }

    #[inline(always)]
    fn depart(&mut self, accumulator: u32, departure: Departure) {
        self.observer.depart(accumulator, departure);
    }

    #[inline(always)]
    fn lit(&mut self, accumulator: u32, radiance: Rgb) {
        self.observer.lit(accumulator, radiance);
    }

    #[inline(always)]
    fn sampled_manifold(&mut self, arrival: &Arrival, sample: &ManifoldSample) {
        self.observer.sampled_manifold(arrival, sample);
    }
}
