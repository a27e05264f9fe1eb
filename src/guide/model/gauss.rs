//! A mixture of eight Gaussians, one mixture a cell of R: for light that is narrow, slanted, or
//! moves as one moves, where constants need many small cells and many records.
//!
//! Directions are mapped to the plane by Lambert's azimuthal equal-area projection: a direction at
//! the angle t from the axis lands 2 sin(t/2) from the origin, so the sphere is a disk of radius 2,
//! solid angles are areas, and a Gaussian over the plane is a density. The axis is the middle of
//! the octant that the cell's normals point into, so that the one singular direction, opposite to
//! the axis, lies below every horizon.
//!
//! Training is expectation maximisation as in Vorba et al. 2014 (see [`super::super::gmm`]), with
//! two differences. Parameters stay fixed while records come in and only moments are added up, as
//! integers, so that shards add exactly; and a new cell starts from its parent's mixture instead of
//! from its first records. A lobe that has become useless is tried elsewhere between iterations, at
//! a record chosen by chance, so that a needle of light in the sky can be found: lobes that are
//! wide already would never close in on it.
//!
//! Photons and camera paths each have moments of their own; they are joined by how many records of
//! equal weight they are worth, because a few paths that met the sun by chance should not speak
//! louder than a thousand photons.

use super::moments::Moments;
use super::neighbour_lobes::{SHARE, neighbour_lobes};
use super::prior::PRIOR;
use super::{LocalModel, Neighbourhood, Query, Region};
use crate::guide::bytes::{Reader, Writer};
use crate::guide::gaussian::{Domain, LOBES, Lanes, Lobe, Mixture, Statistics, maximise};
use crate::guide::record::{Deposit, Origin, TABLE_QUANTA};
use crate::guide::tally::Table;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use crate::math::rng::{BELOW_ONE, hash64, unit_f32};
use crate::math::simd::widest;
use crate::math::{Frame, Vec2, Vec3};
use rayon::prelude::*;
use std::sync::Arc;

/// Keeps a record that all lobes find impossible from being lost.
const TRACE: f32 = 1e-12;
/// As many records' worth of the uniform distribution stand beside what a cell has met.
const DOUBT: f64 = 4.0;
/// Space is divided into so many parts.
const OCTANTS: f64 = 8.0;
/// Solid-angle density of a density of 1 over the unit square: the disk of radius 2 has diameter 1
/// in it.
const DENSITY: f32 = 1.0 / 16.0;

/// A lobe of less weight is tried elsewhere. (With 0.5 a torus in glass has 1.2 times the
/// variance.)
const USELESS: f32 = 0.05;
/// What it is tried as: one degree wide. (Half as wide or five times as heavy is the same.)
const TRIED: Lobe = Lobe {
    weight: 0.02,
    mean: Vec2::ZERO,
    covariance: [2e-5, 0.0, 2e-5],
};

/// A record chosen by chance, in proportion to weight: the one with the largest key.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Pick {
    key: f32,
    place: Vec2,
}

/// Training state of a mixture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct GaussStats {
    /// By [`Origin`].
    moments: [Moments; 2],
    /// All of weight 0 before anything was met.
    lobes: [Lobe; LOBES],
    /// The lobes, ready to be evaluated.
    lanes: Lanes,
    /// Out of what was added since the last look.
    pick: Pick,
}

/// The mixture for sampling.
#[derive(Clone, Debug)]
pub(crate) struct Frozen {
    mixture: Mixture,
    frame: Frame,
    /// What neighbours know beside that; shared by all of them.
    neighbour_lobes: Option<Arc<Mixture>>,
}

impl Frozen {
    /// Solid-angle density at the place of a direction.
    #[inline(always)]
    fn density(&self, place: Vec2) -> f32 {
        let own = self.mixture.density(place);
        let density = match &self.neighbour_lobes {
            Some(neighbour_lobes) => (1.0 - SHARE) * own + SHARE * neighbour_lobes.density(place),
            None => own,
        };
        density * DENSITY
    }
}

/// See the module.
pub(crate) struct Gauss;

/// The place in the unit square of a direction.
#[inline(always)]
fn to_place(frame: &Frame, w: Vec3) -> Vec2 {
    let d = frame.to_local(w);
    // Near the singular direction rounding may carry it over the disk's rim.
    let scale = (2.0 / (1.0 + d.z).max(1e-7)).sqrt();
    (Vec2::new(d.x, d.y) * scale).clamp_length_max(2.0) * 0.25 + 0.5
}

/// The direction of a place in the disk.
#[inline]
fn to_direction(frame: &Frame, place: Vec2) -> Vec3 {
    let p = (place - 0.5) * 4.0;
    let r2 = p.length_squared().min(4.0);
    let xy = p * (1.0 - 0.25 * r2).max(0.0).sqrt();
    frame
        .to_world(Vec3::new(xy.x, xy.y, 1.0 - 0.5 * r2))
        .normalize()
}

impl GaussStats {
    fn is_started(&self) -> bool {
        self.lobes.iter().any(|l| l.weight > 0.0)
    }

    /// The statistics of both origins, joined, and how many records they are worth.
    fn known(&self) -> (Statistics, f64) {
        let mut joined = Statistics::default();
        let mut count = 0.0;
        for moments in &self.moments {
            let known = moments.known();
            let n = known.effective_count();
            if n <= 0.0 {
                continue;
            }
            count += n;
            let scale = n / known.weight;
            for (j, s) in joined
                .iter_mut()
                .flatten()
                .zip(known.statistics.iter().flatten())
            {
                *j += scale * s;
            }
        }
        (joined, count)
    }

    /// Keeps a record if it is drawn: of keys -w / ln u, the largest belongs to a record with a
    /// probability in proportion to w (Efraimidis and Spirakis 2006). The numbers follow from
    /// record and mixture, so that the order of records does not matter and each look has its own.
    #[inline]
    fn draw(&mut self, place: Vec2, units: f32) {
        let bits = u64::from(place.x.to_bits()) << 32 | u64::from(place.y.to_bits());
        let look = u64::from(self.lobes[0].mean.x.to_bits()).rotate_left(40);
        let u = unit_f32(hash64(bits ^ look) as u32);
        let key = -units / (u + f32::MIN_POSITIVE).ln();
        if key > self.pick.key {
            self.pick = Pick { key, place };
        }
    }

    fn fit(&mut self, statistics: &Statistics, count: f64) {
        maximise(&mut self.lobes, statistics, count, &PRIOR);
        self.lanes = Lanes::unbounded(&self.lobes);
    }
}

impl LocalModel for Gauss {
    const BASE_LEVEL: u8 = 0;
    const TABLE_LEVELS: u8 = 2;
    const SPLITS_DIRECTIONS: bool = false;
    // Relative variance of a sample, 64 samples, for 400, 200, 100: veach-ajar 4.4, 4.4, 4.7;
    // kitchen 9.5, 9.0, 8.5; a torus in glass 5.5, 5.1, 3.5. Before paths were split and narrow
    // lobes shared, for 300, 100, 50, 25: veach-ajar 6.5, 6.9, 6.9, 7.4; kitchen 23.7, 12.8, 14.7,
    // 16.8; the torus 25.5, 7.9, 7.1, 7.3; lux-pool 23, 20, 23, 33.
    const SPLIT_RECORDS: u32 = 100;
    const ITERATIONS: u32 = 4;
    type Stats = GaussStats;
    type Frozen = Frozen;

    fn train(stats: &mut GaussStats, region: &Region, d: &Deposit, origin: Origin) {
        if !stats.is_started() || d.units <= 0.0 {
            return;
        }
        let place = to_place(&region.side, d.direction);
        let mut shares = stats.lanes.densities(place.x, place.y);
        let mut total = 0.0;
        for (p, lobe) in shares.iter_mut().zip(&stats.lobes) {
            *p += TRACE * lobe.weight;
            total += *p;
        }
        for p in &mut shares {
            *p /= total;
        }
        stats.moments[origin as usize].add(place, d.units, &shares);
        stats.draw(place, d.units);
    }

    fn refit(stats: &mut GaussStats, region: &Region, table: &Table) {
        if stats.is_started() {
            // The same sums have the same fit.
            if stats.moments.iter().all(Moments::is_settled) {
                return;
            }
            let (statistics, count) = stats.known();
            stats.fit(&statistics, count);
            return;
        }
        let cells = table.by_direction();
        let count = cells.iter().sum::<f64>() / f64::from(TABLE_QUANTA);
        if count > 0.0 {
            stats.fit(&seeds(&cells, &region.side), count);
        }
    }

    fn reseed(stats: &mut GaussStats) {
        if stats.pick.key <= 0.0 {
            return;
        }
        let lobes = stats.lobes.iter_mut();
        let Some(least) = lobes.reduce(|a, b| if b.weight < a.weight { b } else { a }) else {
            return;
        };
        if least.weight < USELESS {
            *least = Lobe {
                mean: stats.pick.place,
                ..TRIED
            };
            stats.lanes = Lanes::unbounded(&stats.lobes);
        }
    }

    fn settle(stats: &mut GaussStats) {
        stats.moments.iter_mut().for_each(Moments::settle);
        stats.pick = Pick::default();
    }

    fn split(parent: &GaussStats, _: &Region, _: &Region) -> GaussStats {
        GaussStats {
            moments: [0, 1].map(|o: usize| parent.moments[o].of_part(OCTANTS)),
            pick: Pick::default(),
            ..parent.clone()
        }
    }

    fn merge(into: &mut GaussStats, other: &GaussStats) -> bool {
        let alike = into.lobes == other.lobes;
        let pairs = into.moments.iter_mut().zip(&other.moments);
        pairs.fold(alike, |alike, (a, b)| alike && a.merge(b))
    }

    fn clear(stats: &mut GaussStats) {
        stats.moments.iter_mut().for_each(Moments::clear);
        stats.pick = Pick::default();
    }

    fn freeze(stats: &GaussStats, region: &Region) -> Frozen {
        let (_, count) = stats.known();
        let uniform = (DOUBT / (DOUBT + count)) as f32;
        Frozen {
            mixture: Mixture::new(&stats.lobes, uniform, Domain::Disk),
            frame: region.side,
            neighbour_lobes: None,
        }
    }

    fn exchange(
        frozen: &mut [Frozen],
        stats: &[GaussStats],
        links: &[u32],
        neighbourhoods: &dyn Fn() -> Vec<Neighbourhood>,
    ) {
        let of = |&l: &u32| {
            let stats = &stats[l as usize];
            (stats.known().1, &stats.lobes)
        };
        let known: Vec<_> = links.par_iter().map(of).collect();
        let neighbourhoods = neighbourhoods();
        let neighbour_lobes =
            |n: &Neighbourhood| neighbour_lobes(n.known.iter().map(|&c| known[c as usize]));
        let found: Vec<_> = neighbourhoods.par_iter().map(neighbour_lobes).collect();
        for (neighbourhood, neighbour_lobes) in neighbourhoods.iter().zip(found) {
            let Some(neighbour_lobes) = neighbour_lobes.map(Arc::new) else {
                continue;
            };
            for &c in &neighbourhood.learning {
                frozen[c as usize].neighbour_lobes = Some(Arc::clone(&neighbour_lobes));
            }
        }
    }

    fn bytes(frozen: &[Frozen]) -> usize {
        let shared = |f: &Frozen| {
            let part = |n: &Arc<Mixture>| size_of::<Mixture>() / Arc::strong_count(n);
            f.neighbour_lobes.as_ref().map_or(0, part)
        };
        size_of_val(frozen) + frozen.iter().map(shared).sum::<usize>()
    }

    #[inline]
    fn sample(m: &Frozen, _: DirectionCell, _: &Query, u: Vec2) -> Vec3 {
        let Some(neighbour_lobes) = &m.neighbour_lobes else {
            return to_direction(&m.frame, m.mixture.sample_by_two(u));
        };
        let place = if u.x < SHARE {
            neighbour_lobes.sample_by_two(Vec2::new((u.x / SHARE).min(BELOW_ONE), u.y))
        } else {
            let rest = (u.x - SHARE) / (1.0 - SHARE);
            m.mixture.sample_by_two(Vec2::new(rest.min(BELOW_ONE), u.y))
        };
        to_direction(&m.frame, place)
    }

    #[inline]
    fn pdf(m: &Frozen, _: DirectionCell, _: &Query, w: Vec3) -> f32 {
        widest(|| m.density(to_place(&m.frame, w)))
    }

    fn write(stats: &GaussStats, out: &mut Writer) {
        stats.moments.iter().for_each(|m| m.write(out));
        for l in &stats.lobes {
            for v in [l.weight, l.mean.x, l.mean.y] {
                out.u32(v.to_bits());
            }
            for v in l.covariance {
                out.u32(v.to_bits());
            }
        }
    }

    fn read(input: &mut Reader) -> Option<GaussStats> {
        let moments = [Moments::read(input)?, Moments::read(input)?];
        let mut lobes = [Lobe::default(); LOBES];
        for l in &mut lobes {
            let mut number = || input.u32().map(f32::from_bits).filter(|v| v.is_finite());
            *l = Lobe {
                weight: number().filter(|w| (0.0..=1.0).contains(w))?,
                mean: Vec2::new(number()?, number()?),
                covariance: [number()?, number()?, number()?],
            };
        }
        Some(GaussStats {
            moments,
            lanes: Lanes::unbounded(&lobes),
            lobes,
            pick: Pick::default(),
        })
    }
}

/// Lobes to start from, from the flux of direction cells: at cells that are bright and far from
/// each other, and every cell belongs to the nearest.
fn seeds(by_direction: &[f64], frame: &Frame) -> Statistics {
    let level = (by_direction.len().max(1).ilog2() / 2) as u8;
    let place = |cell: usize| {
        let code = (cell as u32) << (2 * u32::from(CODE_LEVELS - level));
        let centre = DirectionCell::containing(code, level).direction(Vec2::splat(0.5));
        to_place(frame, centre)
    };
    let places: Vec<Vec2> = (0..by_direction.len()).map(place).collect();
    let mut distance = vec![1f32; places.len()];
    let mut owner = vec![0usize; places.len()];
    for j in 0..LOBES {
        let merit = |&i: &usize| by_direction[i] * f64::from(distance[i]);
        let Some(seed) = (0..places.len()).max_by(|a, b| merit(a).total_cmp(&merit(b))) else {
            break;
        };
        for (i, p) in places.iter().enumerate() {
            let d = p.distance_squared(places[seed]);
            if j == 0 || d < distance[i] {
                (distance[i], owner[i]) = (d, j);
            }
        }
    }
    // The variance of a square cell.
    let spread = std::f64::consts::FRAC_PI_4 / places.len() as f64 / 12.0;
    let mut statistics = Statistics::default();
    for ((p, &flux), &j) in places.iter().zip(by_direction).zip(&owner) {
        let (x, y) = (f64::from(p.x), f64::from(p.y));
        let moments = [1.0, x, y, x * x + spread, x * y, y * y + spread];
        for (sum, m) in statistics[j].iter_mut().zip(moments) {
            *sum += flux * m;
        }
    }
    statistics
}
