//! A mixture of von Mises-Fisher lobes over the whole sphere, one mixture a cell of R, in the spirit
//! of OpenPGL's parallax-aware mixtures: each lobe knows how far away its light is, and a query
//! re-aims it from the cell's centre to the shading point.
//!
//! Training is stepwise EM. While records come in, the parameters stay fixed and only responsibilities
//! are added up, as integers, so that shards add exactly; [`Vmf::refit`] then takes one M-step, in
//! which older batches count by [`MEMORY`]. Lobes start at the heaviest of 16 direction cells of the
//! first batch.

use super::{LocalModel, Query, Region};
use crate::guide::file::{Reader, Writer};
use crate::guide::record::Deposit;
use crate::guide::settings::Product;
use crate::guide::tally::Table;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use crate::math::{DVec3, Frame, Vec2, Vec3};
use std::f32::consts::PI;

/// Lobes in a mixture.
const LOBES: usize = 8;
/// How much of the statistics of earlier batches a refit keeps.
const MEMORY: f64 = 0.5;
/// Concentration limits: nearly uniform, and a lobe of 0.2 degrees.
const MIN_KAPPA: f64 = 1e-2;
const MAX_KAPPA: f64 = 1e5;
/// Prior records of mean cosine 0 in each lobe: a single record must not make a delta.
const PRIOR: f64 = 0.5;
/// Quanta a unit in the integer sums.
const QUANTA: f64 = (1u64 << 20) as f64;

/// One lobe's weighted sums: weight, weighted direction, weighted inverse distance.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    weight: f64,
    direction: DVec3,
    inverse_distance: f64,
}

/// One lobe as it is evaluated.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Lobe {
    weight: f32,
    mean: Vec3,
    kappa: f32,
    /// 1 / distance to the light; 0: infinitely far.
    inverse_distance: f32,
}

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

    fn fit(&mut self) {
        let total: f64 = self.sums.iter().map(|s| s.weight).sum();
        for (lobe, s) in self.lobes.iter_mut().zip(&self.sums) {
            *lobe = fit_lobe(s, total);
        }
    }
}

fn fit_lobe(s: &Sums, total: f64) -> Lobe {
    if s.weight <= 1e-6 * total || !s.weight.is_finite() {
        return Lobe::default();
    }
    let length = s.direction.length();
    let mean = if length > 1e-12 * s.weight {
        s.direction / length
    } else {
        DVec3::Z
    };
    let r = (length / (s.weight + PRIOR)).clamp(0.0, 1.0 - 1e-9);
    // Banerjee et al. 2005, eq. 4.4 for the sphere.
    let kappa = r * (3.0 - r * r) / (1.0 - r * r);
    Lobe {
        weight: (s.weight / total) as f32,
        mean: mean.as_vec3().normalize_or(Vec3::Z),
        kappa: kappa.clamp(MIN_KAPPA, MAX_KAPPA) as f32,
        inverse_distance: (s.inverse_distance / s.weight).clamp(0.0, 1e30) as f32,
    }
}

/// Density of a lobe. Written with the chord, |w - mean|^2 / 2 = 1 - cos, which keeps its digits
/// where cos is near 1.
#[inline]
fn lobe_pdf(kappa: f32, mean: Vec3, w: Vec3) -> f32 {
    let norm = kappa / (2.0 * PI * -(-2.0 * kappa).exp_m1());
    norm * (-0.5 * kappa * w.distance_squared(mean)).exp()
}

fn sample_lobe(kappa: f32, mean: Vec3, u: Vec2) -> Vec3 {
    // 1 - cos = -ln(u + (1-u) e^{-2k}) / k, between 0 and 2.
    let one_minus_cos =
        (-(u.x + (1.0 - u.x) * (-2.0 * kappa).exp()).max(1e-38).ln() / kappa).clamp(0.0, 2.0);
    let sin = (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt();
    let (s, c) = (2.0 * PI * u.y).sin_cos();
    Frame::new(mean)
        .to_world(Vec3::new(sin * c, sin * s, 1.0 - one_minus_cos))
        .normalize()
}

/// A lobe's direction as seen from `to` instead of `from`.
#[inline]
fn reaim(lobe: &Lobe, from: Vec3, to: Vec3) -> Vec3 {
    // In units of the distance, so that an infinite one needs no case of its own.
    (lobe.mean + (from - to) * lobe.inverse_distance).normalize_or(lobe.mean)
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

/// The lobes as they look from the query: weight with the normal's share, mean, concentration.
#[inline]
fn aimed(m: &Mixture, query: &Query) -> ([(f32, Vec3, f32); LOBES], f32) {
    let mut total = 0.0;
    let lobes = m.lobes.map(|l| {
        if l.weight <= 0.0 {
            return (0.0, l.mean, 1.0);
        }
        let mean = reaim(&l, m.pivot, query.position);
        let w = l.weight * horizon_factor(query, mean, l.kappa);
        total += w;
        (w, mean, l.kappa)
    });
    (lobes, total)
}

impl LocalModel for Vmf {
    const BASE_LEVEL: u8 = 0;
    const TABLE_LEVELS: u8 = 2;
    const SPLITS_DIRECTIONS: bool = false;
    type Stats = VmfStats;
    type Frozen = Mixture;

    fn train(stats: &mut VmfStats, region: &Region, d: &Deposit) {
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
        let mut responsibility = [0f32; LOBES];
        let mut total = 0f32;
        for (r, l) in responsibility.iter_mut().zip(&stats.lobes) {
            if l.weight > 0.0 {
                *r = l.weight * lobe_pdf(l.kappa, l.mean, w) + 1e-12 * l.weight;
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
            stats.fit();
            return;
        }
        if stats.fresh.iter().all(|f| f[0] == 0) {
            return;
        }
        for (s, f) in stats.sums.iter_mut().zip(&mut stats.fresh) {
            let f = std::mem::take(f).map(|q| q as f64 / QUANTA);
            s.weight = s.weight * MEMORY + f[0];
            s.direction = s.direction * MEMORY + DVec3::new(f[1], f[2], f[3]);
            s.inverse_distance = s.inverse_distance * MEMORY + f[4];
        }
        stats.fit();
    }

    fn split(parent: &VmfStats, from: &Region, to: &Region) -> VmfStats {
        let mut child = VmfStats::default();
        for ((s, p), l) in child.sums.iter_mut().zip(&parent.sums).zip(&parent.lobes) {
            let mean = reaim(l, from.centre, to.centre).as_dvec3();
            *s = Sums {
                weight: p.weight / 8.0,
                direction: mean * (p.direction.length() / 8.0),
                inverse_distance: p.inverse_distance / 8.0,
            };
        }
        child.fit();
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
        for l in lobes.iter().filter(|l| l.0 > 0.0) {
            chosen = Some((l, (t / l.0).clamp(0.0, 1.0 - 1e-7)));
            if t < l.0 {
                break;
            }
            t -= l.0;
        }
        match chosen {
            Some((&(_, mean, kappa), x)) => sample_lobe(kappa, mean, Vec2::new(x, u.y)),
            None => q.direction(u),
        }
    }

    fn pdf(m: &Mixture, q: DirectionCell, query: &Query, w: Vec3) -> f32 {
        let (lobes, total) = aimed(m, query);
        if total <= 0.0 {
            return q.uniform_pdf();
        }
        let sum: f32 = lobes
            .iter()
            .filter(|l| l.0 > 0.0)
            .map(|&(weight, mean, kappa)| weight * lobe_pdf(kappa, mean, w))
            .sum();
        sum / total
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
                out.u64(v.to_bits());
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
                *x = f64::from_bits(input.u64()?);
                if !x.is_finite() || x.abs() > 1e100 {
                    return None;
                }
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
        stats.fit();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    /// The closed-form mean cosine, coth k - 1/k, and the density's integral, over seven decades.
    #[test]
    fn lobes_are_safe_from_flat_to_needle() {
        let mut rng = Pcg32::new(2, 3);
        for kappa in [1e-2f32, 1.0, 10.0, 1e3, 1e5] {
            let n = 200_000;
            let mut mean = 0f64;
            let mut inverse = 0f64;
            let cap = (8.0 / kappa).min(2.0);
            for _ in 0..n {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let w = sample_lobe(kappa, Vec3::Y, u);
                mean += 0.5 * f64::from(w.distance_squared(Vec3::Y));
                // E[1/pdf over the cap] is the cap's area.
                if 0.5 * w.distance_squared(Vec3::Y) <= cap {
                    inverse += 1.0 / f64::from(lobe_pdf(kappa, Vec3::Y, w));
                }
            }
            let k = f64::from(kappa);
            let expected = 1.0 - (1.0 / k.tanh() - 1.0 / k);
            let got = mean / f64::from(n);
            assert!(
                (got / expected - 1.0).abs() < 0.01,
                "{kappa}: {got} {expected}"
            );
            let area = inverse / f64::from(n) / f64::from(2.0 * PI * cap);
            assert!((area - 1.0).abs() < 0.15, "{kappa}: {area}");
        }
        for u in [0.0, 1.0 - 1.0 / 16_777_216.0] {
            for kappa in [1e-2f32, 1.0, 1e5] {
                let w = sample_lobe(kappa, Vec3::Z, Vec2::splat(u));
                assert!((w.length() - 1.0).abs() < 1e-5);
                assert!(lobe_pdf(kappa, Vec3::Z, w).is_finite());
            }
        }
    }
}
