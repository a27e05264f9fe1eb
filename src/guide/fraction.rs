//! How often to trust the field: the probability of sampling the field instead of the BSDF, learned
//! for each cell of R, beside that of sampling a light (`light_chance.rs`) and which one
//! (`light_clusters.rs`).
//!
//! The mixture q = a p_field + (1 - a) p_bsdf should be proportional to f = BSDF * radiance *
//! cosine. The gradient of the KL divergence between the two is estimated from the samples
//! themselves (Mueller 2019, course notes "Path guiding in production", chapter 10): for a
//! direction sampled with density q and value f, dKL/da = -(f/q) (p_field - p_bsdf) / q. It is
//! followed by Adam on the logit of a, with a weak pull towards 1/2.

use super::cells::Cells;
use super::habits::{CellStates, Chances, FLOOR, FractionRecord, Habits};
use super::light_chance::LEAST_LIGHT;
use super::light_clusters::LightClusters;
use super::record::weight;
use crate::light::ClusterFactors;
use crate::math::rng::{hash64, unit_f32};
use rayon::prelude::*;

/// The learned fractions of one field's cells.
///
/// Updates happen in the order of the records, cell by cell, so the same records give the same
/// bits. For an unbiased image update only between passes, never from the pass that is being drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Fractions {
    cells: Vec<Habits>,
    /// What the cells come to, ready to be asked for.
    chances: Vec<Chances>,
    /// Which lights to sample in each; empty until something was learned of that.
    clusters: Vec<LightClusters>,
}

impl Fractions {
    /// One half everywhere, and always a light.
    pub fn new(field: &impl Cells) -> Self {
        Self::with(field, |_| Chances::UNKNOWN)
    }

    /// Nothing learned yet, but these chances.
    fn with(field: &impl Cells, chances: impl Fn(u32) -> Chances) -> Self {
        Self {
            cells: vec![Habits::default(); field.cell_count() as usize],
            chances: (0..field.cell_count()).map(chances).collect(),
            clusters: Vec::new(),
        }
    }

    /// Chances that know nothing of any scene, in all their range: no renderer may draw another
    /// mean with them.
    pub fn random(field: &impl Cells, seed: u64) -> Self {
        let chances = |cell| {
            let bits = hash64(seed ^ u64::from(cell));
            Chances {
                field: FLOOR + (1.0 - 2.0 * FLOOR) * unit_f32(bits as u32),
                light: LEAST_LIGHT + (1.0 - LEAST_LIGHT) * unit_f32((bits >> 32) as u32),
            }
        };
        let clusters = |cell| LightClusters::random(seed ^ u64::from(cell));
        Self {
            clusters: (0..field.cell_count()).map(clusters).collect(),
            ..Self::with(field, chances)
        }
    }

    /// The same, with the same share for the field everywhere, within [`FLOOR`] and 1 - [`FLOOR`].
    pub fn with_share(mut self, share: f32) -> Self {
        for chances in &mut self.chances {
            chances.field = share.clamp(FLOOR, 1.0 - FLOOR);
        }
        self
    }

    /// The fractions for a field that refines the one they were learned for: every cell starts with
    /// what the cell that it was part of has learned.
    pub fn carried_over<F: Cells>(&self, from: &F, to: &F) -> Self {
        let old = to.parts_of(from).into_iter().map(|part| part as usize);
        let old: Vec<usize> = old.collect();
        let mut parts = vec![0u32; self.cells.len()];
        for &c in &old {
            parts[c] += 1;
        }
        let inherit = |&c: &usize| match parts[c] {
            1 => self.cells[c],
            _ => self.cells[c].of_part(),
        };
        let clusters = |&c: &usize| {
            let clusters = self.clusters.get(c)?;
            Some(match parts[c] {
                1 => clusters.clone(),
                _ => clusters.of_part(),
            })
        };
        Self {
            cells: old.iter().map(inherit).collect(),
            chances: old.iter().map(|&c| self.chances[c]).collect(),
            clusters: old.iter().filter_map(clusters).collect(),
        }
    }

    /// The chances in a cell (see [`Cells::cell`]); those of one that has learned nothing for a
    /// cell of another field.
    #[inline]
    pub fn chances(&self, cell: u32) -> Chances {
        let known = self.chances.get(cell as usize);
        known.copied().unwrap_or(Chances::UNKNOWN)
    }

    /// Factors for the clusters of the light tree in a cell, if anything was learned of them.
    #[inline]
    pub fn light_factors(&self, cell: u32) -> Option<&ClusterFactors> {
        self.clusters.get(cell as usize)?.factors()
    }

    /// The states of some cells.
    pub(crate) fn of_cells(&self, cells: &[u32]) -> CellStates {
        let at = cells.iter().map(|&c| c as usize);
        let habits = |c: usize| self.cells.get(c).copied().unwrap_or_default();
        let clusters = |c: usize| self.clusters.get(c).cloned().unwrap_or_default();
        CellStates {
            habits: at.clone().map(habits).collect(),
            clusters: at.map(clusters).collect(),
        }
    }

    /// Sets them.
    pub(crate) fn set_cells(&mut self, cells: &[u32], states: &CellStates) {
        let states = states.habits.iter().zip(&states.clusters);
        for (&c, (habits, clusters)) in cells.iter().zip(states) {
            let c = c as usize;
            if c < self.cells.len() {
                self.cells[c] = *habits;
                self.chances[c] = habits.chances();
                self.set_clusters(c, clusters.clone());
            }
        }
    }

    fn set_clusters(&mut self, cell: usize, clusters: LightClusters) {
        if self.clusters.is_empty() && clusters.factors().is_some() {
            self.clusters = vec![LightClusters::default(); self.cells.len()];
        }
        if let Some(place) = self.clusters.get_mut(cell) {
            *place = clusters;
        }
    }

    /// Learns from a batch. Records with numbers that are not finite are ignored.
    pub fn update(&mut self, field: &impl Cells, records: &[FractionRecord]) {
        self.update_in_parts(field, &[records]);
    }

    /// The same for a batch that lies in several places; only the records' order counts.
    pub fn update_in_parts(&mut self, field: &impl Cells, parts: &[&[FractionRecord]]) {
        let batch = Parts::new(parts);
        let cell_of = |(i, r): (usize, &FractionRecord)| {
            u64::from(field.cell(r.position, r.normal)) << 32 | i as u64
        };
        let numbered = parts.par_iter().zip(&batch.starts);
        let mut order: Vec<u64> = numbered
            .flat_map_iter(|(part, &start)| (start..).zip(*part).map(cell_of))
            .collect();
        order.par_sort_unstable();
        let unit = typical(parts);
        let runs: Vec<&[u64]> = order.chunk_by(|a, b| a >> 32 == b >> 32).collect();
        let learned: Vec<(usize, Habits, LightClusters)> = runs
            .into_par_iter()
            .filter_map(|run| {
                let cell = (run[0] >> 32) as usize;
                let mut habits = *self.cells.get(cell)?;
                let records = run.iter().map(|&o| batch.record(o as u32 as usize));
                habits.learn(records.clone(), unit);
                let mut clusters = self.clusters.get(cell).cloned().unwrap_or_default();
                clusters.learn(records.map(|r| (r.light_choice, r.light)));
                Some((cell, habits, clusters))
            })
            .collect();
        for (cell, habits, clusters) in learned {
            self.cells[cell] = habits;
            self.set_clusters(cell, clusters);
        }
        for (chances, habits) in self.chances.iter_mut().zip(&self.cells) {
            *chances = habits.chances();
        }
    }
}

/// Records in several places, numbered through.
struct Parts<'a> {
    parts: &'a [&'a [FractionRecord]],
    /// The number of each part's first record.
    starts: Vec<usize>,
}

impl<'a> Parts<'a> {
    fn new(parts: &'a [&'a [FractionRecord]]) -> Self {
        let start = |next: &mut usize, part: &&[FractionRecord]| {
            let start = *next;
            *next += part.len();
            Some(start)
        };
        let starts = parts.iter().scan(0, start).collect();
        Self { parts, starts }
    }

    fn record(&self, number: usize) -> &'a FractionRecord {
        let part = self.starts.partition_point(|&start| start <= number) - 1;
        &self.parts[part][number - self.starts[part]]
    }
}

/// The power of two below the mean of value over density: what the pull towards 1/2 is weak against
/// must not depend on the unit of light. Guarded by the stability suite's `s08_emission`.
fn typical(parts: &[&[FractionRecord]]) -> f64 {
    let sum = |part: &&[FractionRecord]| {
        let worths = part
            .iter()
            .map(|r| f64::from(weight(r.value)) / f64::from(r.pdf))
            .filter(|w| w.is_finite());
        worths.fold((0.0, 0.0), |(sum, n), w| (sum + w, n + 1.0))
    };
    // A sum a part, then their sum: in this order on any number of threads.
    let sums: Vec<(f64, f64)> = parts.par_iter().map(sum).collect();
    let (sum, count) = sums
        .iter()
        .fold((0.0, 0.0), |(sum, n), part| (sum + part.0, n + part.1));
    let mean: f64 = sum / count;
    if mean > 0.0 {
        mean.log2().floor().exp2()
    } else {
        1.0
    }
}
