//! From batches of photons to mixtures.

use super::Settings;
use super::cover::Cover;
use super::field::Mixtures;
use super::place::{RecordPlace, places};
use super::record::Record;
use crate::guide::record::weight;
use crate::guide::{GuideError, Photon, SurfacePoint};
use crate::math::rng::hash_all;
use rayon::prelude::*;

/// Photons that are matched with records in one task.
const BLOCK: usize = 8192;

/// Records that learn.
#[derive(Clone, Debug)]
pub struct GmmTrainer {
    settings: Settings,
    /// Where camera paths scatter: what records are to serve.
    points: Vec<SurfacePoint>,
    state: Option<State>,
    emitted: u64,
}

/// What the first photons decide.
#[derive(Clone, Debug)]
struct State {
    places: Vec<RecordPlace>,
    cover: Cover,
    records: Vec<Record>,
    /// Weight of a typical photon.
    unit: f32,
}

impl GmmTrainer {
    /// A trainer whose records will serve `points`: where camera paths scatter. Points that are not
    /// finite are left out.
    ///
    /// # Errors
    /// When a setting is out of range.
    pub fn new(settings: Settings, points: &[SurfacePoint]) -> Result<Self, GuideError> {
        settings.validate()?;
        let sound = |p: &&SurfacePoint| {
            p.position.is_finite() && (p.normal.length_squared() - 1.0).abs() < 1e-3
        };
        Ok(Self {
            points: points.iter().filter(sound).copied().collect(),
            settings,
            state: None,
            emitted: 0,
        })
    }

    /// Learns from a batch: the landings of `emitted` photons. Photons that are not finite, or
    /// dark, teach nothing. The first batch with light decides where the records stand.
    pub fn train(&mut self, photons: &[Photon], emitted: u64) {
        self.emitted = self.emitted.saturating_add(emitted);
        let sound: Vec<Photon> = photons.iter().filter(|p| is_sound(p)).copied().collect();
        if sound.is_empty() {
            return;
        }
        if self.state.is_none() {
            self.state = Some(self.place(&sound));
        }
        if let Some(state) = &mut self.state {
            state.take(&sound, &self.settings);
        }
    }

    fn place(&self, photons: &[Photon]) -> State {
        let most = (self.settings.memory / Record::bytes(&self.settings)).min(u64::from(u32::MAX));
        let (places, cover) = places(&self.settings, &self.points, photons, most as usize);
        let record = |(i, p): (usize, &RecordPlace)| {
            Record::new(*p, hash_all([self.settings.seed, i as u64]))
        };
        let mean = photons
            .iter()
            .map(|p| f64::from(weight(p.power)))
            .sum::<f64>()
            / photons.len() as f64;
        State {
            records: places.iter().enumerate().map(record).collect(),
            places,
            cover,
            unit: (mean as f32).max(f32::MIN_POSITIVE),
        }
    }

    /// Records there are.
    pub fn records(&self) -> usize {
        self.state.as_ref().map_or(0, |s| s.records.len())
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> u64 {
        self.records() as u64 * Record::bytes(&self.settings)
    }

    /// What is known so far, ready to be asked.
    pub fn freeze(&self) -> Mixtures {
        let records = self.state.as_ref().map_or(&[][..], |s| &s.records);
        let known: Vec<_> = records
            .par_iter()
            .filter_map(|r| {
                let mixture = r.freeze(&self.settings)?;
                Some((r.place, r.irradiance(self.emitted), mixture))
            })
            .collect();
        Mixtures::new(known)
    }
}

fn is_sound(p: &Photon) -> bool {
    let finite = p.position.is_finite() && p.power.is_finite() && p.normal.is_finite();
    let unit = (p.direction.length_squared() - 1.0).abs() < 1e-2;
    finite && unit && weight(p.power) > 0.0
}

impl State {
    fn take(&mut self, photons: &[Photon], settings: &Settings) {
        let heard: Vec<Vec<(u32, u32)>> = photons
            .par_chunks(BLOCK)
            .enumerate()
            .map(|(block, photons)| self.heard(block * BLOCK, photons))
            .collect();
        // Sorted by record, each record's photons in their order.
        let mut ends = vec![0u32; self.records.len() + 1];
        for &(record, _) in heard.iter().flatten() {
            ends[record as usize + 1] += 1;
        }
        for i in 1..ends.len() {
            ends[i] += ends[i - 1];
        }
        let mut next = ends.clone();
        let mut sorted = vec![0u32; heard.iter().map(Vec::len).sum()];
        for &(record, photon) in heard.iter().flatten() {
            let at = &mut next[record as usize];
            sorted[*at as usize] = photon;
            *at += 1;
        }
        let unit = self.unit;
        let records = self.records.par_iter_mut().enumerate().with_min_len(16);
        records.for_each(|(i, record)| {
            for &photon in &sorted[ends[i] as usize..ends[i + 1] as usize] {
                record.take(&photons[photon as usize], unit, settings);
            }
        });
    }

    /// Pairs of records and photons of a block that starts at photon `first`.
    fn heard(&self, first: usize, photons: &[Photon]) -> Vec<(u32, u32)> {
        let mut pairs = Vec::new();
        for (i, photon) in photons.iter().enumerate() {
            self.cover.near(photon.position, |record| {
                let place = &self.places[record as usize];
                if Record::hears(place, photon).is_some() {
                    pairs.push((record, (first + i) as u32));
                }
                false
            });
        }
        pairs
    }
}
