//! What camera paths tell the field: at every rough vertex, where the path went on and how much light
//! came back from there.
//!
//! While a path travels, a `Record` is opened at each vertex that could be guided and closed at the
//! next one: what the sample had come to by then is its *baseline*. When the path has ended, all that
//! came in after the baseline, divided by the throughput with which the path left the vertex, is an
//! estimate of the radiance that arrives there from that direction. Light straight from an emitter is
//! in it as far as multiple importance sampling leaves it to this direction: next-event estimation
//! finds a lamp by itself, but not a dim sky beside a bright sun.

use super::chain::Aimed;
use super::wave::Outcome;
use crate::guide::{FractionRecord, PathSample};
use crate::math::{Rgb, Vec3};

/// Watches paths while they travel. `()` watches nothing and costs nothing.
pub trait Witness {
    /// Whether [`Witness::leave`] is to be called for this path.
    #[inline]
    fn wants(&self, slot: u32) -> bool {
        let _ = slot;
        false
    }
    /// A path reached its next vertex, or left the scene; `radiance` is what it came to so far.
    #[inline]
    fn arrive(&mut self, slot: u32, radiance: Rgb, distance: f32) {
        let _ = (slot, radiance, distance);
    }
    /// A path that it wants to know of goes on from a vertex, or ends there.
    #[inline]
    fn leave(&mut self, slot: u32, departure: Departure) {
        let _ = (slot, departure);
    }
    /// The light sample of the vertex that the path has just left was not blocked and brought `radiance`.
    #[inline]
    fn lit(&mut self, slot: u32, radiance: Rgb) {
        let _ = (slot, radiance);
    }
    /// A path that came so aimed at the suns.
    #[inline]
    fn aimed(&mut self, arrival: &Arrival, aimed: &Aimed) {
        let _ = (arrival, aimed);
    }
}

impl Witness for () {}

/// What a path was when it came to a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Its throughput.
    pub throughput: Rgb,
    /// What its sample had come to, the vertex's own emission included.
    pub radiance: Rgb,
}

/// How a path left a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Departure {
    /// The vertex.
    pub position: Vec3,
    /// Unit shading normal, on the side that the path came from.
    pub normal: Vec3,
    /// How it came.
    pub arrival: Arrival,
    /// The chance with which a light was sampled; `None` if no field was asked or the path was split.
    pub light_chance: Option<f32>,
    /// Where it went; `None` if it ended here, by roulette or for want of a direction.
    pub onward: Option<Onward>,
}

/// The way on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Onward {
    /// Unit direction.
    pub direction: Vec3,
    /// Density with which it was drawn, solid angle, of the mixture.
    pub pdf: f32,
    /// Density that the field alone gives it; 0 if it was not asked.
    pub guide_pdf: f32,
    /// Density that the BSDF alone gives it.
    pub bsdf_pdf: f32,
    /// BSDF times cosine over `pdf`.
    pub weight: Rgb,
    /// Chance with which roulette let the path go on.
    pub survival: f32,
    /// Throughput after all of that.
    pub throughput: Rgb,
}

#[derive(Clone, Copy, Debug)]
struct Record {
    slot: u32,
    departure: Departure,
    /// What the light sample brought.
    light: Rgb,
    baseline: Rgb,
    distance: f32,
}

/// No record is open.
const NONE: u32 = u32::MAX;

/// The records of a wave.
pub struct Records {
    /// One sample in so many is watched.
    stride: u32,
    list: Vec<Record>,
    /// By slot, the record that waits for the path's next vertex.
    open: Vec<u32>,
}

/// What a wave's paths taught.
#[derive(Default)]
pub struct Lessons {
    /// For the field.
    pub samples: Vec<PathSample>,
    /// For the share of samples that the field draws.
    pub fractions: Vec<FractionRecord>,
}

impl Witness for Records {
    #[inline]
    fn wants(&self, slot: u32) -> bool {
        slot % self.stride == 0
    }

    fn arrive(&mut self, slot: u32, radiance: Rgb, distance: f32) {
        let Some(open) = self.open.get_mut(slot as usize) else {
            return;
        };
        if *open != NONE {
            let record = &mut self.list[*open as usize];
            record.baseline = radiance;
            record.distance = distance;
            *open = NONE;
        }
    }

    fn leave(&mut self, slot: u32, departure: Departure) {
        let slots = slot as usize + 1;
        if self.open.len() < slots {
            self.open.resize(slots, NONE);
        }
        self.open[slot as usize] = self.list.len() as u32;
        self.list.push(Record {
            slot,
            departure,
            light: Rgb::ZERO,
            baseline: Rgb::ZERO,
            distance: 0.0,
        });
    }

    fn lit(&mut self, slot: u32, radiance: Rgb) {
        let open = self.open.get(slot as usize).copied().unwrap_or(NONE);
        if let Some(record) = self.list.get_mut(open as usize) {
            record.light += radiance;
        }
    }
}

impl Default for Records {
    fn default() -> Self {
        Self::every(1)
    }
}

impl Records {
    /// Records of one sample in `stride`.
    pub fn every(stride: u32) -> Self {
        Self {
            stride: stride.max(1),
            list: Vec::new(),
            open: Vec::new(),
        }
    }

    /// Turns the records of finished paths into lessons, in the order in which they were made, and
    /// forgets them.
    pub fn conclude(&mut self, outcomes: &[Outcome], lessons: &mut Lessons) {
        for record in self.list.drain(..) {
            let outcome = &outcomes[record.slot as usize];
            lessons.add(&record, outcome.radiance);
        }
        self.open.clear();
    }
}

impl Lessons {
    fn add(&mut self, record: &Record, outcome: Rgb) {
        let Departure {
            position,
            normal,
            arrival,
            light_chance,
            onward,
        } = record.departure;
        // What a light sample and the way on brought, relative to the throughput.
        let whole = arrival.throughput.element_sum();
        let reflected = (outcome - arrival.radiance).max(Rgb::ZERO).element_sum() / whole;
        let vertex = light_chance.map(|light_chance| FractionRecord {
            position,
            normal,
            value: Rgb::ZERO,
            pdf: 0.0,
            guide_pdf: 0.0,
            bsdf_pdf: 0.0,
            light: record.light.element_sum() / whole,
            light_chance,
            reflected,
        });
        let Some(on) = onward else {
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
