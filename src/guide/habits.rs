//! What a cell of R has learned of how to sample there, as it is kept in files.

use super::adam::Adam;
use super::bytes::{Reader, Writer};
use super::light_chance::LightChance;
use super::light_clusters::{LightChoice, LightClusters};
use super::record::weight;
use crate::math::{Rgb, Vec3};

/// Bounds of the fraction: neither strategy may vanish.
pub const FLOOR: f32 = 0.1;

/// The fraction before anything was learned.
const UNKNOWN: f32 = 0.5;

/// What one vertex, met during rendering or training, tells about the mixture and about light
/// samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FractionRecord {
    /// The shading point.
    pub position: Vec3,
    /// Its normal.
    pub normal: Vec3,
    /// BSDF times cosine times the estimate of incident radiance along the direction.
    pub value: Rgb,
    /// Density with which it was sampled (the mixture's); 0 if no direction was.
    pub pdf: f32,
    /// The field's density for it.
    pub guide_pdf: f32,
    /// The BSDF's density for it.
    pub bsdf_pdf: f32,
    /// What the light sample brought, as it counted in the image, for the throughput 1.
    pub light: f32,
    /// The chance with which there was a light sample.
    pub light_probability: f32,
    /// Out of which clusters it came, if there was one.
    pub light_choice: LightChoice,
    /// All light that the vertex sent on, for the throughput 1.
    pub reflected: f32,
}

/// The probabilities of what a vertex does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chances {
    /// To draw the next direction from the field instead of the BSDF, within [`FLOOR`] and 1 -
    /// [`FLOOR`].
    pub field: f32,
    /// To sample a light, within [`super::LEAST_LIGHT`] and 1.
    pub light: f32,
}

impl Chances {
    /// Before anything was learned: the field half of the time, and always a light.
    pub const UNKNOWN: Self = Self {
        field: UNKNOWN,
        light: 1.0,
    };
}

/// What a cell has learned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Habits {
    adam: Adam,
    light: LightChance,
}

impl Habits {
    /// Size in a file.
    pub const BYTES: usize = Adam::BYTES + LightChance::BYTES;

    pub fn write(&self, w: &mut Writer) {
        self.adam.write(w);
        self.light.write(w);
    }

    /// Reads what `write` wrote, if it is sound.
    pub fn read(r: &mut Reader) -> Option<Self> {
        Some(Self {
            adam: Adam::read(r)?,
            light: LightChance::read(r)?,
        })
    }

    /// Takes records in, one after the other; light is counted in `unit`.
    pub fn learn<'a>(&mut self, records: impl Iterator<Item = &'a FractionRecord>, unit: f64) {
        let mut lacking = self.adam.lacking();
        for record in records {
            self.learn_one(record, unit, &mut lacking);
        }
    }

    fn learn_one(&mut self, r: &FractionRecord, unit: f64, lacking: &mut [f64; 2]) {
        self.light.add(r.light, r.light_probability, r.reflected);
        let f = f64::from(weight(r.value)) / unit;
        let [p, guide, bsdf] = [r.pdf, r.guide_pdf, r.bsdf_pdf].map(f64::from);
        if !(p > 0.0 && f >= 0.0 && (guide + bsdf + f + p).is_finite()) {
            return;
        }
        let a = self.adam.fraction();
        let mixture = a * guide + (1.0 - a) * bsdf;
        if mixture <= 0.0 {
            return;
        }
        let gradient = -(f / p) * (guide - bsdf) / mixture;
        self.adam.step(gradient * a * (1.0 - a), lacking);
    }

    /// What a part of the cell starts with.
    pub fn of_part(self) -> Self {
        Self {
            light: self.light.of_part(),
            ..self
        }
    }

    /// What it comes to.
    pub fn chances(&self) -> Chances {
        Chances {
            field: (self.adam.fraction() as f32).clamp(FLOOR, 1.0 - FLOOR),
            light: self.light.chance(),
        }
    }
}

/// What some cells have learned, in an order of theirs.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CellStates {
    /// How often to ask the field, and how often to sample a light.
    pub habits: Vec<Habits>,
    /// Which light to sample.
    pub clusters: Vec<LightClusters>,
}

impl CellStates {
    pub fn write(&self, w: &mut Writer) {
        w.varint(self.habits.len() as u128);
        self.habits.iter().for_each(|h| h.write(w));
        let mut before = None;
        for clusters in &self.clusters {
            clusters.write(w, before);
            before = Some(clusters);
        }
    }

    /// Reads what `write` wrote, if it is sound.
    pub fn read(r: &mut Reader) -> Option<Self> {
        let n = r.count(Habits::BYTES)?;
        let habits = (0..n).map(|_| Habits::read(r)).collect::<Option<_>>()?;
        let mut clusters: Vec<LightClusters> = Vec::with_capacity(n);
        for _ in 0..n {
            let next = LightClusters::read(r, clusters.last())?;
            clusters.push(next);
        }
        Some(Self { habits, clusters })
    }
}
