//! Weighted stepwise expectation maximisation of a mixture (Vorba et al. 2014, sections 4 and 5).
//!
//! The sufficient statistics of lobe j are means over photons of g, g x and g x x^T, where x is the
//! photon's place in the square and g its weight times the lobe's responsibility. A step of n
//! photons moves them by a rate: u <- (1 - eta) u + eta u_step. The mixture is then the maximum a
//! posteriori (see [`maximise`]).

use crate::guide::gaussian::{LOBES, Lanes, Lobe, Prior, Statistics, maximise};
use crate::math::rng::{hash64, unit_f32};
use crate::math::{Pcg32, Vec2};

/// The paper's b, and half a degree.
const PRIOR: Prior = Prior {
    spread: 5e-4,
    least_variance: 1e-5,
};
/// Keeps a photon that all lobes find impossible from being lost.
const TRACE: f32 = 1e-12;
/// Iterations over the first photons.
const FIRST_ITERATIONS: usize = 8;

/// A photon as a record sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Its direction in the unit square.
    pub place: Vec2,
    /// Its weight, above 0.
    pub weight: f32,
}

/// A mixture that learns.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Learning {
    statistics: Statistics,
    lobes: [Lobe; LOBES],
    /// Photons seen.
    count: f64,
    /// Sum of their weights, and of the squares.
    weight: f64,
    square: f64,
}

impl Learning {
    /// Starts from the first photons, of which there must be one at least. `seed` picks the
    /// starting points.
    pub fn start(samples: &[Sample], seed: u64) -> Self {
        let mut new = Self {
            statistics: seeds(samples, seed),
            lobes: [Lobe::default(); LOBES],
            count: 0.0,
            weight: 0.0,
            square: 0.0,
        };
        new.count_in(samples);
        new.maximise();
        for _ in 0..FIRST_ITERATIONS {
            new.statistics = new.expect(samples);
            new.maximise();
        }
        new
    }

    /// A step with further photons.
    pub fn step(&mut self, samples: &[Sample], rate: f64) {
        if samples.is_empty() {
            return;
        }
        let found = self.expect(samples);
        self.count_in(samples);
        let eta = (samples.len() as f64 / self.count).powf(rate);
        for (old, new) in self.statistics.iter_mut().zip(&found) {
            for (old, new) in old.iter_mut().zip(new) {
                *old += eta * (new - *old);
            }
        }
        self.maximise();
    }

    /// The mixture as it is.
    pub fn lobes(&self) -> &[Lobe; LOBES] {
        &self.lobes
    }

    /// How many photons of equal weight would tell as much.
    pub fn effective_count(&self) -> f64 {
        if self.square > 0.0 {
            self.weight * self.weight / self.square
        } else {
            0.0
        }
    }

    fn count_in(&mut self, samples: &[Sample]) {
        self.count += samples.len() as f64;
        for s in samples {
            let w = f64::from(s.weight);
            self.weight += w;
            self.square += w * w;
        }
    }

    /// Means over photons under the responsibilities of the lobes as they are.
    fn expect(&self, samples: &[Sample]) -> Statistics {
        let lanes = Lanes::unbounded(&self.lobes);
        // Offsets from the lobes' means keep f32 exact enough for narrow lobes.
        let mut sums = [[0f32; LOBES]; 6];
        for s in samples {
            let mut p = lanes.densities(s.place.x, s.place.y);
            let mut total = 0.0;
            for (p, lobe) in p.iter_mut().zip(&self.lobes) {
                *p += TRACE * lobe.weight;
                total += *p;
            }
            let scale = s.weight / total;
            for j in 0..LOBES {
                let g = p[j] * scale;
                let (dx, dy) = (s.place.x - lanes.x[j], s.place.y - lanes.y[j]);
                sums[0][j] += g;
                sums[1][j] += g * dx;
                sums[2][j] += g * dy;
                sums[3][j] += g * dx * dx;
                sums[4][j] += g * dx * dy;
                sums[5][j] += g * dy * dy;
            }
        }
        let n = samples.len().max(1) as f64;
        std::array::from_fn(|j| {
            let [g, x, y, xx, xy, yy] = std::array::from_fn(|i| f64::from(sums[i][j]) / n);
            let (mx, my) = (f64::from(lanes.x[j]), f64::from(lanes.y[j]));
            [
                g,
                x + g * mx,
                y + g * my,
                xx + 2.0 * mx * x + g * mx * mx,
                xy + mx * y + my * x + g * mx * my,
                yy + 2.0 * my * y + g * my * my,
            ]
        })
    }

    /// The most likely mixture for the statistics.
    fn maximise(&mut self) {
        let n = self.effective_count();
        maximise(&mut self.lobes, &self.statistics, n, &PRIOR);
    }
}

/// Statistics to start from: photons chosen as by k-means++ (Arthur and Vassilvitskii 2007), far
/// from each other and by weight; every photon belongs to the nearest.
fn seeds(samples: &[Sample], seed: u64) -> Statistics {
    let mut rng = Pcg32::new(hash64(seed), 0x0067_6d6d);
    let mut distance = vec![1f32; samples.len()];
    let mut owner = vec![0usize; samples.len()];
    for j in 0..LOBES {
        let total: f64 = weighted(samples, &distance).sum();
        let mut t = f64::from(unit_f32(rng.next_u32())) * total;
        let chosen = weighted(samples, &distance).position(|w| {
            t -= w;
            t < 0.0
        });
        let Some(centre) = chosen.map(|i| samples[i].place) else {
            break;
        };
        for (i, s) in samples.iter().enumerate() {
            let d = s.place.distance_squared(centre);
            if j == 0 || d < distance[i] {
                (distance[i], owner[i]) = (d, j);
            }
        }
    }
    let mut statistics = [[0.0; 6]; LOBES];
    for (s, &j) in samples.iter().zip(&owner) {
        let (x, y) = (f64::from(s.place.x), f64::from(s.place.y));
        let g = f64::from(s.weight) / samples.len() as f64;
        let moments = [1.0, x, y, x * x, x * y, y * y];
        for (sum, m) in statistics[j].iter_mut().zip(moments) {
            *sum += g * m;
        }
    }
    statistics
}

fn weighted<'a>(samples: &'a [Sample], distance: &'a [f32]) -> impl Iterator<Item = f64> + 'a {
    let pairs = samples.iter().zip(distance);
    pairs.map(|(s, d)| f64::from(s.weight) * f64::from(*d))
}

impl Sample {
    /// Whether it can be learned from.
    pub(super) fn is_sound(&self) -> bool {
        self.place.is_finite() && self.weight > 0.0 && self.weight.is_finite()
    }
}
