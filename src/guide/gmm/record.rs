//! A record while it learns.

use super::Settings;
use super::em::{Learning, Sample};
use super::place::{RecordPlace, SAME_SIDE};
use super::square;
use crate::guide::Photon;
use crate::guide::gaussian::{Domain, Mixture};
use crate::guide::record::weight;
use crate::math::{Frame, Rgb, Vec3};
use std::f64::consts::PI;

/// A photon further from the tangent plane than this share of the radius belongs to another
/// surface.
const SLAB: f32 = 0.5;
/// A record's first photons are so many steps.
pub(super) const FIRST_STEPS: usize = 3;
/// As many photons' worth of the uniform distribution stand beside what a record has seen.
const DOUBT: f64 = 4.0;

/// A record: where it stands and what it has heard.
#[derive(Clone, Debug)]
pub(super) struct Record {
    pub place: RecordPlace,
    frame: Frame,
    /// Sum of powers, each times its kernel weight.
    flux: [f64; 3],
    /// Photons that wait until there are enough for a step.
    pending: Vec<Sample>,
    learning: Option<Box<Learning>>,
    seed: u64,
}

impl Record {
    pub fn new(place: RecordPlace, seed: u64) -> Self {
        Self {
            place,
            frame: Frame::new(place.normal),
            flux: [0.0; 3],
            pending: Vec::new(),
            learning: None,
            seed,
        }
    }

    /// Bytes that a record takes while it learns.
    pub fn bytes(settings: &Settings) -> u64 {
        let pending = FIRST_STEPS * settings.step as usize * size_of::<Sample>();
        (size_of::<Self>() + size_of::<Learning>() + pending) as u64
    }

    /// The photon's weight here, from 1 at the centre to 0 at the rim; `None` if it is not heard.
    #[inline]
    pub fn hears(place: &RecordPlace, photon: &Photon) -> Option<f32> {
        let offset = photon.position - place.position;
        let share = offset.length_squared() / (place.radius * place.radius);
        let beside = offset.dot(place.normal).abs() <= SLAB * place.radius;
        (share < 1.0 && beside && photon.normal.dot(place.normal) > SAME_SIDE)
            .then_some(1.0 - share)
    }

    /// Learns from a photon that it hears; weights are counted in `unit`.
    pub fn take(&mut self, photon: &Photon, unit: f32, settings: &Settings) {
        let Some(kernel) = Self::hears(&self.place, photon) else {
            return;
        };
        let Some(place) = square::to_square(self.frame.to_local(photon.direction)) else {
            return;
        };
        let power = photon.power.max(Rgb::ZERO);
        let sample = Sample {
            place,
            weight: (kernel * weight(power) / unit).min(1e6),
        };
        if !(sample.is_sound() && power.is_finite()) {
            return;
        }
        for (sum, p) in self.flux.iter_mut().zip(power.to_array()) {
            *sum += f64::from(p) * f64::from(kernel);
        }
        self.pending.push(sample);
        let enough = settings.step as usize
            * match self.learning {
                None => FIRST_STEPS,
                Some(_) => 1,
            };
        if self.pending.len() >= enough {
            self.learn(settings);
        }
    }

    fn learn(&mut self, settings: &Settings) {
        match &mut self.learning {
            None => {
                self.learning = Some(Box::new(Learning::start(&self.pending, self.seed)));
                self.pending.reserve_exact(0);
            }
            Some(learning) => learning.step(&self.pending, settings.rate),
        }
        self.pending.clear();
    }

    /// What it knows, photons that wait included; `None` if it has heard nothing.
    pub fn freeze(&self, settings: &Settings) -> Option<Mixture> {
        let mut all = self.clone();
        if !all.pending.is_empty() {
            all.learn(settings);
        }
        let learning = all.learning?;
        let doubt = DOUBT / (DOUBT + learning.effective_count());
        let uniform = (doubt as f32).max(settings.defensive);
        Some(Mixture::new(learning.lobes(), uniform, Domain::Square))
    }

    /// Incident flux per area, in W/m^2, after `emitted` photons.
    pub fn irradiance(&self, emitted: u64) -> Rgb {
        // The integral of the kernel over the disk.
        let area = 0.5 * PI * f64::from(self.place.radius).powi(2);
        let scale = 1.0 / (area * emitted.max(1) as f64);
        let e = Vec3::from_array(self.flux.map(|f| (f * scale) as f32));
        if e.is_finite() { e } else { Rgb::ZERO }
    }
}
