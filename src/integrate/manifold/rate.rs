//! How often manifold next-event estimation is worth its rays.
//!
//! Every light that it finds tells what it would have cost to leave it to BSDF and field sampling.
//! Light `x` with density `b` there adds `x^2 / b` to the second moment of a sample; where it is
//! sampled with density `a` at rate `s` as well, it adds `x^2 / (b + s a)` (balance heuristic). So
//! one trial tells the variance, and the rays, of all rates.

use super::chains::INITIAL_RATE;
use super::sample::ManifoldSample;
use crate::integrate::observer::PathObserver;
use crate::integrate::path::Arrival;

/// The rates that are compared.
pub const RATES: [f32; 5] = [0.0, 0.0625, 0.125, 0.25, 0.5];

/// A light that a path met by itself with so small a density that its sample would be this
/// many times the image's radiance counts as one of this many times: it is so rare that it spoils
/// few pixels. (Foretold with other bounds and measured: `EXPERIMENTS.md`.)
const BRIGHTEST: f64 = 50.0;
/// No rate is expected to leave less of the variance than this.
const LEAST_LEFT: f64 = 0.25;

/// A light that was found.
#[derive(Clone, Copy, Debug)]
struct Light {
    /// What it brings, before it is divided by a density.
    brings: f64,
    /// Density with which manifold next-event estimation drew it.
    chain_pdf: f64,
    /// Density with which the path would have met it.
    path_pdf: f64,
}

/// What manifold next-event estimation brought, and what it took.
#[derive(Clone, Debug, Default)]
pub struct RateStatistics {
    lights: Vec<Light>,
    rays: u64,
}

impl PathObserver for RateStatistics {
    fn sampled_manifold(&mut self, arrival: &Arrival, sample: &ManifoldSample) {
        self.rays += u64::from(sample.rays);
        self.lights.extend(sample.found.map(|found| Light {
            brings: f64::from((arrival.throughput * found.radiance).length()) / 3f64.sqrt(),
            chain_pdf: f64::from(found.pdf),
            path_pdf: f64::from(found.path_pdf),
        }));
    }
}

impl Light {
    /// What it adds to the second moment of all samples together at this rate, where it is
    /// `brightest` at most.
    fn moment(&self, rate: f32, brightest: f64) -> f64 {
        let density = self.path_pdf + self.chain_pdf * f64::from(rate / INITIAL_RATE);
        self.brings * (self.brings / density).min(brightest) / self.chain_pdf
    }
}

impl RateStatistics {
    /// For each of [`RATES`], the second moment that the lights add to all samples of a tile whose
    /// radiance is of the order of `mean`, relative to that.
    fn moments(&self, mean: f64) -> [f64; RATES.len()] {
        let sum = |rate| -> f64 {
            let moments = self.lights.iter().map(|s| s.moment(rate, BRIGHTEST * mean));
            moments.filter(|m| m.is_finite()).sum()
        };
        RATES.map(|rate| sum(rate) / (mean * mean))
    }
}

/// A trial at the probability `INITIAL_RATE`.
#[derive(Clone, Copy, Debug, Default)]
pub struct RateTrial {
    /// What the lights add to the second moment of all samples together, for each of [`RATES`].
    moments: [f64; RATES.len()],
    /// Rays that it took.
    rays: u64,
}

impl RateTrial {
    /// Adds what was found in a tile whose radiance is of the order of `mean`.
    pub fn add(&mut self, found: &RateStatistics, mean: f64) {
        for (sum, more) in self.moments.iter_mut().zip(found.moments(mean)) {
            *sum += more;
        }
        self.rays += found.rays;
    }

    /// The rate with the least variance times rays. There were so many samples, each of so much
    /// relative variance and with so many rays in all.
    pub fn best(&self, samples: f64, variance: f64, rays: f64) -> f32 {
        let first = RATES.iter().position(|c| *c == INITIAL_RATE).unwrap_or(0);
        let of_chains = self.rays as f64 / samples;
        let cost = |i: usize| {
            let more = (self.moments[i] - self.moments[first]) / samples;
            let times = f64::from(RATES[i] / INITIAL_RATE) - 1.0;
            (variance + more).max(LEAST_LEFT * variance) * (rays + of_chains * times)
        };
        let best = (0..RATES.len()).min_by(|a, b| cost(*a).total_cmp(&cost(*b)));
        best.map_or(INITIAL_RATE, |i| RATES[i])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best rate of a thousand samples with a relative variance of 1 and 8 rays.
    fn best(moments: [f64; RATES.len()], rays: u64) -> f32 {
        RateTrial { moments, rays }.best(1000.0, 1.0, 8.0)
    }

    #[test]
    fn no_chain_is_sampled_in_vain() {
        assert_eq!(best([0.0; RATES.len()], 2000), 0.0);
        assert_eq!(best([100.0; RATES.len()], 0), 0.0);
    }

    #[test]
    fn what_is_hard_to_meet_is_sampled_and_not_more_often_than_it_is_worth() {
        // Left to paths it doubles the second moment; sampled, it adds next to nothing.
        let light = Light {
            brings: 1.0,
            chain_pdf: 1000.0,
            path_pdf: 1e-3,
        };
        let gains = RateStatistics {
            lights: vec![light; 20_000],
            rays: 0,
        };
        let moments = gains.moments(1.0);
        assert!(moments[0] > 50.0 * moments[1] && moments.is_sorted_by(|a, b| a > b));
        let dear = best(moments, 2000);
        assert!(dear > 0.0 && dear < RATES[RATES.len() - 1], "{dear}");
        // For nothing more is better.
        assert!(best(moments, 0) >= dear);
    }
}
