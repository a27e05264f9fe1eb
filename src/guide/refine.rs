//! *Refine*: split links where a split lowers the KL divergence between flux and model the most.
//!
//! A leaf link is modelled as uniform over its area and solid angle. If its flux phi is spread over
//! the parts of a split by shares p_c where uniformity would expect m_c, splitting lowers the
//! divergence by phi * D with D = sum_c p_c ln(p_c / m_c). From n records, D comes out too large by
//! (k - 1) / 2n on average (2 n D is chi-square distributed with k - 1 degrees of freedom when
//! there is nothing to gain), which is subtracted, and a gain counts only where 2 n D exceeds its
//! mean by `significance` standard deviations. n is the *effective* count (sum w)^2 / sum w^2.
//!
//! Three gains are compared per byte: dividing space, dividing directions, and both at once (a
//! light that wanders across a cell as one moves shows in neither marginal); a joint gain is
//! realised by dividing space first. The best are taken until memory is used up. (Where it is
//! short, a cell's share of the camera paths' vertices instead of its share of the flux chooses no
//! better: the door with mixtures in a twentieth and an eighth of what they would take, RMSE 0.355
//! and 0.355, 0.346 and 0.345, beside 0.312 without a limit.)

use super::links::Split;
use super::record::Origin;
use super::space::Space;
use super::train::{NODE_BYTES, SPACE_BYTES, Trainer};
use rayon::prelude::*;
use smallvec::SmallVec;

/// A mixture with this many times the records that a split needs is divided in any case. (With 64
/// times, relative variance is 4.5 instead of 4.7 in veach-ajar, but 5.1 instead of 4.2 in a torus
/// in glass.)
const PLENTY: f64 = 4.0;

/// What a round of refining did.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Refined {
    /// Links divided in space.
    pub space: u64,
    /// Links divided in direction.
    pub direction: u64,
    /// Significant splits that did not fit into the memory any more.
    pub refused: u64,
    /// Gain of the splits made: the expected fall of the KL divergence, as a share of all flux.
    pub gain: f64,
}

struct Candidate {
    link: u32,
    split: Split,
    per_byte: f64,
    gain: f64,
    /// The link's place, independent of the order in which links were made.
    name: (u64, u8, u32, u8),
}

/// A divergence and its degrees of freedom.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Divergence {
    nats: f64,
    freedom: f64,
}

impl Divergence {
    /// D without its bias, or 0 where chance explains it.
    fn significant(self, n: f64, z: f64) -> f64 {
        if self.freedom <= 0.0 || n <= 0.0 {
            return 0.0;
        }
        let statistic = 2.0 * n * self.nats;
        if statistic <= self.freedom + z * (2.0 * self.freedom).sqrt() {
            return 0.0;
        }
        self.nats - self.freedom / (2.0 * n)
    }
}

/// D between flux shares and measure shares. Parts without measure take no part unless flux was met
/// there; then half of the smallest other measure stands in.
fn divergence(flux: &[f64], measure: &[f64]) -> Divergence {
    let smallest = measure
        .iter()
        .copied()
        .filter(|m| *m > 0.0)
        .fold(f64::INFINITY, f64::min);
    let fallback = if smallest.is_finite() {
        0.5 * smallest
    } else {
        1.0
    };
    let used = |f: f64, m: f64| {
        if m > 0.0 {
            m
        } else if f > 0.0 {
            fallback
        } else {
            0.0
        }
    };
    let (mut f_sum, mut m_sum, mut parts) = (0.0, 0.0, 0.0);
    for (&f, &m) in flux.iter().zip(measure) {
        let m = used(f, m);
        f_sum += f;
        m_sum += m;
        parts += f64::from(u8::from(m > 0.0));
    }
    if f_sum <= 0.0 {
        return Divergence {
            nats: 0.0,
            freedom: 0.0,
        };
    }
    let nats = flux
        .iter()
        .zip(measure)
        .filter(|(f, _)| **f > 0.0)
        .map(|(&f, &m)| f / f_sum * (f / f_sum * (m_sum / used(f, m))).ln())
        .sum();
    Divergence {
        nats,
        freedom: parts - 1.0,
    }
}

impl Trainer {
    /// *Refine*: one round. Models take in what was trained since the last round, then links are
    /// split. The outcome depends on the accumulated sums alone.
    pub fn refine(&mut self) -> Refined {
        self.intakes.rounds += 1;
        self.refit();
        self.stats.settle();
        self.divide(None)
    }

    /// Models take in what was trained since the last time.
    pub(crate) fn refit(&mut self) {
        let (space, links) = (&self.space, &self.product.links);
        let regions = |l: u32| super::train::region(space, &links[l as usize]);
        self.stats.refit(&regions, &self.table);
    }

    /// The splits of a round, without refitting models; of the links `only`, if there are any.
    pub(crate) fn divide(&mut self, only: Option<&[u32]>) -> Refined {
        let mut candidates = self.candidates(only);
        candidates
            .sort_unstable_by(|a, b| b.per_byte.total_cmp(&a.per_byte).then(a.name.cmp(&b.name)));
        let mut done = Refined::default();
        let mut bytes = self.bytes();
        for c in &candidates {
            let cost = self.cost(c.link, c.split) as u64;
            if bytes + cost > self.settings.memory {
                done.refused += 1;
                continue;
            }
            self.split(c.link, c.split);
            bytes += cost;
            done.gain += c.gain;
            match c.split {
                Split::Space => done.space += 1,
                _ => done.direction += 1,
            }
        }
        done
    }

    /// Bytes that a split adds.
    fn cost(&self, link: u32, split: Split) -> usize {
        let r = self.product.links[link as usize].r as usize;
        match split {
            Split::Leaf => 0,
            Split::Direction => 3 * self.link_bytes() + 4 * NODE_BYTES,
            Split::Space => {
                let cells = if self.space.nodes[r].first == 0 { 8 } else { 0 };
                7 * self.link_bytes() + 8 * NODE_BYTES + cells * SPACE_BYTES
            }
        }
    }

    fn candidates(&self, only: Option<&[u32]>) -> Vec<Candidate> {
        let totals = [Origin::Photon, Origin::Path].map(|origin| {
            let flux = self.tallies.iter().map(|t| self.flux(t, origin));
            flux.sum::<f64>()
        });
        let best = |i: u32| {
            let offers = self.origins().iter().map(|&o| {
                let flux = self.flux(&self.tallies[i as usize], o);
                self.candidate(i, o, flux / totals[o as usize])
            });
            offers
                .flatten()
                .reduce(|a, b| if b.per_byte > a.per_byte { b } else { a })
        };
        match only {
            Some(links) => links.par_iter().filter_map(|&i| best(i)).collect(),
            None => (0..self.tallies.len() as u32)
                .into_par_iter()
                .filter_map(best)
                .collect(),
        }
    }

    fn flux(&self, t: &super::tally::Tally, origin: Origin) -> f64 {
        let flux = match origin {
            Origin::Photon => &t.photons,
            Origin::Path => &t.paths,
        };
        let sum = |unit| flux.rgb(unit).element_sum() / 3.0;
        self.unit(origin).map_or(0.0, sum)
    }

    /// The best of a link's possible splits by the records of one origin, if any is worth it.
    /// `share` is the link's share of all flux of that origin.
    fn candidate(&self, number: u32, origin: Origin, share: f64) -> Option<Candidate> {
        let link = self.product.links[number as usize];
        let table = self.table(number, origin);
        let squares = self.tallies[number as usize].squares[origin as usize];
        if squares == 0 || share <= 0.0 || share.is_nan() || !self.space.is_seen(link.r) {
            return None;
        }
        let n = table.total() * table.total() / squares as f64;
        if n < f64::from(self.settings.min_photons.max(self.traits.split_records)) {
            return None;
        }
        let z = f64::from(self.settings.significance);
        let offer = |split: Split, d: f64, cost: usize| Candidate {
            link: number,
            split,
            per_byte: share * d / cost as f64,
            gain: share * d,
            name: self.name(number),
        };
        let mut offers: SmallVec<[Candidate; 3]> = SmallVec::new();
        let quadrant_cost = self.cost(number, Split::Direction);
        let directs = self.traits.splits_directions;
        if directs && link.q.level() < self.settings.max_direction_level {
            let d = divergence(&table.quadrants(), &[1.0; 4]).significant(n, z);
            offers.push(offer(Split::Direction, d, quadrant_cost));
        }
        if self.can_split_space(&self.space, link.r) {
            let measure = self.octant_measure(link.r, origin);
            let cost = self.cost(number, Split::Space);
            let d = divergence(&table.octants(), &measure).significant(n, z);
            offers.push(offer(Split::Space, d, cost));
            let joint = joint_divergence(&table, &measure, directs);
            // Parts that are equal only as a whole, such as two rooms built alike, show no gain: a
            // mixture with plenty of records is divided as if it had the least that could be
            // noticed.
            let plenty = !directs && n > PLENTY * f64::from(self.traits.split_records);
            let least = if plenty {
                joint.freedom.max(1.0) / (2.0 * n)
            } else {
                0.0
            };
            let joint = joint.significant(n, z).max(least);
            let joint_cost = cost + 8 * quadrant_cost * usize::from(directs);
            offers.push(offer(Split::Space, joint, joint_cost));
        }
        offers
            .into_iter()
            .filter(|c| c.gain > 0.0)
            .reduce(|a, b| if b.per_byte > a.per_byte { b } else { a })
    }

    fn can_split_space(&self, space: &Space, r: u32) -> bool {
        space.nodes[r as usize].level < space.grid.max_level
            && (space.measure.keys.is_empty()
                || space.point_count(r) >= self.settings.min_points as usize)
    }

    fn name(&self, number: u32) -> (u64, u8, u32, u8) {
        let link = &self.product.links[number as usize];
        let r = &self.space.nodes[link.r as usize];
        (r.prefix, r.level, link.q.start(), link.q.level())
    }
}

/// Divergence over octant and direction at once: from uniform in both where directions can be split
/// too, else from the same directional distribution in every octant.
fn joint_divergence(table: &super::tally::Table, measure: &[f64; 8], uniform: bool) -> Divergence {
    // At most eight octants of 16 direction cells; on the stack, as every link passes here.
    const MAX_CELLS: usize = 8 * 16;
    let directions = table.directions().min(MAX_CELLS / 8);
    let (mut flux, mut expected, mut marginal) =
        ([0f64; MAX_CELLS], [0f64; MAX_CELLS], [0f64; MAX_CELLS / 8]);
    for (i, &e) in table.entries.iter().enumerate().take(MAX_CELLS) {
        flux[i] = f64::from(e);
        marginal[i % directions] += f64::from(e);
    }
    if uniform {
        marginal = [1.0; MAX_CELLS / 8];
    }
    for (i, e) in expected.iter_mut().enumerate().take(8 * directions) {
        *e = measure[i / directions] * marginal[i % directions];
    }
    let marginal = &marginal[..directions];
    let mut d = divergence(&flux[..8 * directions], &expected[..8 * directions]);
    if !uniform {
        let used = marginal.iter().filter(|m| **m > 0.0).count() as f64;
        d.freedom = (d.freedom - (used - 1.0)).max(0.0);
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divergence_is_kl_and_ignores_empty_parts() {
        let d = divergence(&[3.0, 1.0, 0.0, 0.0], &[1.0; 4]);
        let expected = 0.75 * 3f64.ln();
        assert!((d.nats - expected).abs() < 1e-12 && d.freedom == 3.0);
        // Flux in proportion to measure: nothing to gain, and empty octants do not count.
        let d = divergence(&[2.0, 0.0, 6.0], &[1.0, 0.0, 3.0]);
        assert!(d.nats.abs() < 1e-12 && d.freedom == 1.0);
        assert_eq!(divergence(&[0.0; 4], &[1.0; 4]).significant(10.0, 3.0), 0.0);
    }

    #[test]
    fn chance_alone_is_rarely_significant() {
        let mut rng = crate::math::Pcg32::new(8, 8);
        let mut positives = 0;
        for _ in 0..2000 {
            let mut counts = [0f64; 8];
            for _ in 0..500 {
                counts[(rng.next_u32() >> 29) as usize] += 1.0;
            }
            let d = divergence(&counts, &[1.0; 8]);
            positives += u32::from(d.significant(500.0, 3.0) > 0.0);
        }
        // Chi-square with 7 degrees beyond 7 + 3 sqrt(14) = 18.2: probability 1.1 %.
        assert!(positives < 45, "{positives}");
    }
}
