//! What camera paths tell the field: at every rough vertex, where the path went on and how much
//! light came back from there.
//!
//! While a path travels, a `Record` is opened at each vertex that could be guided and closed at the
//! next one: what the sample had come to by then is its *baseline*. When the path has ended, all
//! that came in after the baseline, divided by the throughput with which the path left the vertex,
//! is an estimate of the radiance that arrives there from that direction. Light straight from an
//! emitter is in it as far as multiple importance sampling leaves it to this direction: next-event
//! estimation finds a lamp by itself, but not a dim sky beside a bright sun.

use crate::guide::{FractionRecord, PathSample};
use crate::integrate::observer::{Departure, PathObserver};
use crate::math::Rgb;

#[derive(Clone, Copy, Debug)]
struct Record {
    accumulator: u32,
    departure: Departure,
    /// What the light sample brought.
    light: Rgb,
    baseline: Rgb,
    distance: f32,
}

/// No record is open.
const NONE: u32 = u32::MAX;

/// The records of a wave.
pub struct PathRecords {
    /// One sample in so many is watched.
    stride: u32,
    list: Vec<Record>,
    /// By slot, the record that waits for the path's next vertex.
    open: Vec<u32>,
}

/// What a wave's paths taught.
#[derive(Default)]
pub struct TrainingSamples {
    /// For the field.
    pub samples: Vec<PathSample>,
    /// For the share of samples that the field draws.
    pub fractions: Vec<FractionRecord>,
}

impl PathObserver for PathRecords {
    #[inline]
    fn wants(&self, accumulator: u32) -> bool {
        accumulator % self.stride == 0
    }

    fn arrive(&mut self, accumulator: u32, radiance: Rgb, distance: f32) {
        let Some(open) = self.open.get_mut(accumulator as usize) else {
            return;
        };
        if *open != NONE {
            let record = &mut self.list[*open as usize];
            record.baseline = radiance;
            record.distance = distance;
            *open = NONE;
        }
    }

    fn depart(&mut self, accumulator: u32, departure: Departure) {
        let slots = accumulator as usize + 1;
        if self.open.len() < slots {
            self.open.resize(slots, NONE);
        }
        self.open[accumulator as usize] = self.list.len() as u32;
        self.list.push(Record {
            accumulator,
            departure,
            light: Rgb::ZERO,
            baseline: Rgb::ZERO,
            distance: 0.0,
        });
    }

    fn lit(&mut self, accumulator: u32, radiance: Rgb) {
        let open = self.open.get(accumulator as usize).copied().unwrap_or(NONE);
        if let Some(record) = self.list.get_mut(open as usize) {
            record.light += radiance;
        }
    }
}

impl Default for PathRecords {
    fn default() -> Self {
        Self::every(1)
    }
}

impl PathRecords {
    /// Records of one sample in `stride`.
    pub fn every(stride: u32) -> Self {
        Self {
            stride: stride.max(1),
            list: Vec::new(),
            open: Vec::new(),
        }
    }

    /// Turns the records of finished paths into training samples, in the order in which they were
    /// made, and forgets them.
    pub fn conclude(&mut self, radiances: &[Rgb], training_samples: &mut TrainingSamples) {
        for record in self.list.drain(..) {
            training_samples.add(&record, radiances[record.accumulator as usize]);
        }
        self.open.clear();
    }
}

impl TrainingSamples {
    fn add(&mut self, record: &Record, outcome: Rgb) {
        let Departure {
            position,
            normal,
            arrival,
            light_probability,
            light_choice,
            direction,
        } = record.departure;
        // What a light sample and the way on brought, relative to the throughput.
        let whole = arrival.throughput.element_sum();
        let reflected = (outcome - arrival.radiance).max(Rgb::ZERO).element_sum() / whole;
        let vertex = light_probability.map(|light_probability| FractionRecord {
            position,
            normal,
            value: Rgb::ZERO,
            pdf: 0.0,
            guide_pdf: 0.0,
            bsdf_pdf: 0.0,
            light: record.light.element_sum() / whole,
            light_probability,
            light_choice,
            reflected,
        });
        let Some(on) = direction else {
            self.fractions.extend(vertex);
            self.samples.push(PathSample {
                position,
                direction: normal,
                radiance: Rgb::ZERO,
                pdf: 1.0,
                distance: 0.0,
                normal,
            });
            return;
        };
        let came = (outcome - record.baseline).max(Rgb::ZERO);
        let radiance = Rgb::select(
            on.throughput.cmpgt(Rgb::ZERO),
            came / on.throughput,
            Rgb::ZERO,
        );
        // Towards the side of the surface that the light falls on, as photons have it.
        let side = if normal.dot(on.direction) < 0.0 {
            -normal
        } else {
            normal
        };
        self.samples.push(PathSample {
            position,
            direction: on.direction,
            radiance,
            pdf: on.pdf * on.survival,
            distance: record.distance,
            normal: side,
        });
        self.fractions.extend(vertex.map(|v| FractionRecord {
            value: on.weight * on.pdf * radiance,
            pdf: on.pdf * on.survival,
            guide_pdf: on.guide_pdf,
            bsdf_pdf: on.bsdf_pdf,
            ..v
        }));
    }

    /// Forgets all, but keeps the memory.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.fractions.clear();
    }
}
