//! A mixture of von Mises-Fisher lobes over the whole sphere, one mixture a cell of R, in the
//! spirit of OpenPGL's parallax-aware mixtures: each lobe knows how far away its light is, and a
//! query re-aims it from the cell's centre to the shading point.
//!
//! Training is stepwise EM. While records come in, the parameters stay fixed and only
//! responsibilities are added up, as integers, so that shards add exactly; [`Vmf::refit`] then
//! takes an M-step, in which older batches count by [`MEMORY`]. Lobes start at the heaviest of 16
//! direction cells of the first batch.

use super::lobe::{Lobe, Sums};
use super::{LocalModel, Query, Region};
use crate::guide::bytes::{Reader, Writer};
use crate::guide::record::{Deposit, Origin};
use crate::guide::settings::Product;
use crate::guide::tally::Table;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use crate::math::{DVec3, Vec2, Vec3};

/// Lobes in a mixture.
const LOBES: usize = 8;
/// How much of the statistics of earlier batches a refit keeps.
const MEMORY: f64 = 0.5;
/// Weight of new records, in units, below which earlier batches count in full.
const ENOUGH: f64 = 128.0;
/// A cell of eight lobes with parallax explains a lot of space, but not all: on veach-ajar, 320
/// wide at 64 samples, the relative error is 0.338 with 16 000 records, 0.220 with 4000 and 0.171
/// with 1000, with one look at a batch (`twintree render --guide double --guide-model vmf
/// --reference R.exr`). `constant` has 0.148.
const SPLIT_RECORDS: u32 = 1000;
/// Quanta a unit in the integer sums.
const QUANTA: f64 = (1u64 << 20) as f64;

/// Training state of a mixture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct VmfStats {
    sums: [Sums; LOBES],
    lobes: [Lobe; LOBES],
    fresh: [[i64; 5]; LOBES],
}

/// The mixture for sampling.
#[derive(Clone, Debug)]
pub(crate) struct Mixture {
    lobes: [Lobe; LOBES],
    pivot: Vec3,
}

/// See the module.
pub(crate) struct Vmf;

impl VmfStats {
    fn is_started(&self) -> bool {
        self.lobes.iter().any(|l| l.weight > 0.0)
    }

    fn fit(&mut self, sums: &[Sums; LOBES]) {
        let total: f64 = sums.iter().map(|s| s.weight).sum();
        for (lobe, s) in self.lobes.iter_mut().zip(sums) {
            *lobe = Lobe::fit(s, total);
        }
    }

    /// What is remembered, and what was added since; earlier batches count less once there is
    /// enough.
    fn known(&self) -> [Sums; LOBES] {
        let fresh: f64 = self.fresh.iter().map(|f| f[0] as f64).sum();
        let keep = if fresh < ENOUGH * QUANTA { 1.0 } else { MEMORY };
        let mut sums = self.sums;
        for (s, f) in sums.iter_mut().zip(&self.fresh) {
            let f = f.map(|q| q as f64 / QUANTA);
            s.weight = s.weight * keep + f[0];
            s.direction = s.direction * keep + DVec3::new(f[1], f[2], f[3]);
            s.inverse_distance = s.inverse_distance * keep + f[4];
        }
        sums
    }
}

/// How much the normal leaves of a lobe: its mean cosine or share above the horizon, roughly; never
/// zero, because tails reach over the horizon.
#[inline]
fn horizon_factor(query: &Query, mean: Vec3, kappa: f32) -> f32 {
    let Some(n) = query.normal else { return 1.0 };
    let spread = (2.0 / kappa).sqrt().min(1.0);
    let t = n.dot(mean);
    let share = ((t + spread) / (2.0 * spread)).clamp(0.0, 1.0);
    match query.product {
        Product::None => 1.0,
        Product::Horizon => share.max(0.01),
        Product::Cosine => (share * t.max(0.5 * (t + spread))).max(0.01),
    }
}

/// The lobes as they look from the query, weighted by what the normal leaves, and their total
/// weight.
#[inline]
fn aimed(m: &Mixture, query: &Query) -> ([Lobe; LOBES], f32) {
    let mut lobes = m.lobes;
    let mut total = 0.0;
    for l in lobes.iter_mut().filter(|l| l.weight > 0.0) {
        l.mean = l.reaimed(m.pivot, query.position);
        l.weight *= horizon_factor(query, l.mean, l.kappa);
        total += l.weight;
    }
    (lobes, total)
}

impl LocalModel for Vmf {
    const BASE_LEVEL: u8 = 0;
    const TABLE_LEVELS: u8 = 2;
    const SPLITS_DIRECTIONS: bool = false;
    const SPLIT_RECORDS: u32 = SPLIT_RECORDS;
    const ITERATIONS: u32 = 4;
    type Stats = VmfStats;
    type Frozen = Mixture;

    fn train(stats: &mut VmfStats, region: &Region, d: &Deposit, _: Origin) {
        if !stats.is_started() || d.units <= 0.0 {
            return;
        }
        // As it would be seen from the cell's centre.
        let inverse = if d.distance > 0.0 {
            1.0 / d.distance
        } else {
            0.0
        };
        let toward = d.direction + (d.position - region.centre) * inverse;
        let w = toward.normalize_or(d.direction);
        // The distance from the centre, not from where the record lies.
        let inverse = inverse / toward.length().max(1e-6);
        let mut responsibility = [0f32; LOBES];
        let mut total = 0f32;
        for (r, l) in responsibility.iter_mut().zip(&stats.lobes) {
            if l.weight > 0.0 {
                *r = l.weight * l.pdf(w) + 1e-12 * l.weight;
            }
            total += *r;
        }
        for (sum, r) in stats.fresh.iter_mut().zip(responsibility) {
            let g = f64::from(r / total) * f64::from(d.units) * QUANTA;
            let terms = [
                1.0,
                f64::from(w.x),
                f64::from(w.y),
                f64::from(w.z),
                f64::from(inverse),
            ];
            for (s, t) in sum.iter_mut().zip(terms) {
                *s = s.saturating_add((g * t).round() as i64);
            }
        }
    }

    fn refit(stats: &mut VmfStats, _: &Region, table: &Table) {
        if !stats.is_started() {
            stats.sums = initial_sums(&table.by_direction());
            stats.fit(&{ stats.sums });
            return;
        }
        let known = stats.known();
        stats.fit(&known);
    }

    fn settle(stats: &mut VmfStats) {
        stats.sums = stats.known();
        stats.fresh = Default::default();
    }

    fn split(parent: &VmfStats, from: &Region, to: &Region) -> VmfStats {
        let mut child = VmfStats::default();
        for ((s, p), l) in child.sums.iter_mut().zip(&parent.sums).zip(&parent.lobes) {
            let mean = l.reaimed(from.centre, to.centre).as_dvec3();
            let moved = (l.mean + (from.centre - to.centre) * l.inverse_distance).length();
            *s = Sums {
                weight: p.weight / 8.0,
                direction: mean * (p.direction.length() / 8.0),
                inverse_distance: p.inverse_distance / 8.0 / f64::from(moved.max(1e-6)),
            };
        }
        child.fit(&{ child.sums });
        child
    }

    fn merge(into: &mut VmfStats, other: &VmfStats) -> bool {
        if into.sums != other.sums {
            return false;
        }
        for (a, b) in into.fresh.iter_mut().zip(&other.fresh) {
            for (x, y) in a.iter_mut().zip(b) {
                *x = x.saturating_add(*y);
            }
        }
        true
    }

    fn clear(stats: &mut VmfStats) {
        stats.fresh = Default::default();
    }

    fn freeze(stats: &VmfStats, region: &Region) -> Mixture {
        Mixture {
            lobes: stats.lobes,
            pivot: region.centre,
        }
    }

    fn sample(m: &Mixture, q: DirectionCell, query: &Query, u: Vec2) -> Vec3 {
        let (lobes, total) = aimed(m, query);
        if total <= 0.0 {
            return q.direction(u);
        }
        let mut t = u.x * total;
        let mut chosen = None;
        for l in lobes.iter().filter(|l| l.weight > 0.0) {
            chosen = Some((l, (t / l.weight).clamp(0.0, 1.0 - 1e-7)));
            if t < l.weight {
                break;
            }
            t -= l.weight;
        }
        match chosen {
            Some((lobe, x)) => lobe.sample(Vec2::new(x, u.y)),
            None => q.direction(u),
        }
    }

    fn pdf(m: &Mixture, q: DirectionCell, query: &Query, w: Vec3) -> f32 {
        let (lobes, total) = aimed(m, query);
        if total <= 0.0 {
            return q.uniform_pdf();
        }
        let present = lobes.iter().filter(|l| l.weight > 0.0);
        present.map(|l| l.weight * l.pdf(w)).sum::<f32>() / total
    }

    fn write(stats: &VmfStats, out: &mut Writer) {
        for s in &stats.sums {
            for v in [
                s.weight,
                s.direction.x,
                s.direction.y,
                s.direction.z,
                s.inverse_distance,
            ] {
                out.f64(v);
            }
        }
        for q in stats.fresh.iter().flatten() {
            out.u64(*q as u64);
        }
    }

    fn read(input: &mut Reader) -> Option<VmfStats> {
        let mut stats = VmfStats::default();
        for s in &mut stats.sums {
            let mut v = [0f64; 5];
            for x in &mut v {
                *x = input.f64().filter(|x| x.is_finite() && x.abs() <= 1e100)?;
            }
            *s = Sums {
                weight: v[0].max(0.0),
                direction: DVec3::new(v[1], v[2], v[3]),
                inverse_distance: v[4],
            };
        }
        for q in stats.fresh.iter_mut().flatten() {
            *q = input.u64()? as i64;
        }
        stats.fit(&{ stats.sums });
        Some(stats)
    }
}

/// Lobes at the heaviest of the table's direction cells, as wide as the cells, the rest of the flux
/// shared among them.
fn initial_sums(by_direction: &[f64]) -> [Sums; LOBES] {
    let mut order: Vec<usize> = (0..by_direction.len()).collect();
    order.sort_by(|&a, &b| by_direction[b].total_cmp(&by_direction[a]).then(a.cmp(&b)));
    let level = (by_direction.len().max(1).ilog2() / 2) as u8;
    let mut sums = [Sums::default(); LOBES];
    for (s, &cell) in sums.iter_mut().zip(&order) {
        let weight = by_direction[cell] / f64::from(crate::guide::record::TABLE_QUANTA);
        if weight <= 0.0 {
            continue;
        }
        let code = (cell as u32) << (2 * u32::from(CODE_LEVELS - level));
        let centre = DirectionCell::containing(code, level).cap().0.as_dvec3();
        *s = Sums {
            weight,
            // Mean cosine of a cell of 0.8 sr.
            direction: centre * (0.87 * weight),
            inverse_distance: 0.0,
        };
    }
    sums
}
