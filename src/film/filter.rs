//! Reconstruction filters, sampled by importance.

use crate::math::Vec2;
use crate::math::distribution::Discrete;
use glam::FloatExt;
use serde::Serialize;

/// A separable reconstruction filter. Radii in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Filter {
    /// Constant over `radius`.
    Box {
        /// Half width, 0.5 for one pixel.
        radius: f32,
    },
    /// Linear falloff.
    Tent {
        /// Half width.
        radius: f32,
    },
    /// Gaussian of standard deviation `stddev`, cut at 4 of them and lowered to reach 0 there.
    Gaussian {
        /// Standard deviation, Mitsuba's default 0.5.
        stddev: f32,
    },
    /// Mitchell and Netravali, radius 2.
    Mitchell {
        /// B.
        b: f32,
        /// C.
        c: f32,
    },
    /// Catmull and Rom, radius 2.
    CatmullRom,
    /// Windowed sinc.
    Lanczos {
        /// Half width.
        lobes: f32,
    },
}

/// A place on the film drawn from a filter.
#[derive(Clone, Copy, Debug)]
pub struct FilterSample {
    /// Offset from the pixel's centre, pixels.
    pub offset: Vec2,
    /// filter / density: 1 for filters without negative lobes, of either sign for those with.
    pub weight: f32,
}

impl Filter {
    /// Half width, pixels.
    pub fn radius(&self) -> f32 {
        match *self {
            Filter::Box { radius } | Filter::Tent { radius } => radius,
            Filter::Gaussian { stddev } => 4.0 * stddev,
            Filter::Mitchell { .. } | Filter::CatmullRom => 2.0,
            Filter::Lanczos { lobes } => lobes,
        }
    }

    /// Value at `x` pixels from the centre, not normalised; 0 outside the radius.
    pub fn eval(&self, x: f32) -> f32 {
        let x = x.abs();
        let radius = self.radius();
        if x > radius {
            return 0.0;
        }
        match *self {
            Filter::Box { .. } => 1.0,
            Filter::Tent { .. } => 1.0 - x / radius,
            Filter::Gaussian { stddev } => {
                let at = |x: f32| (-0.5 * (x / stddev).powi(2)).exp();
                at(x) - at(radius)
            }
            Filter::Mitchell { b, c } => cubic(x, b, c),
            Filter::CatmullRom => cubic(x, 0.0, 0.5),
            Filter::Lanczos { lobes } => sinc(x) * sinc(x / lobes),
        }
    }
}

/// The cubic family of Mitchell and Netravali (1988), `x` from 0 to 2.
fn cubic(x: f32, b: f32, c: f32) -> f32 {
    let (x2, x3) = (x * x, x * x * x);
    let value = if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
    } else {
        (-b - 6.0 * c) * x3
            + (6.0 * b + 30.0 * c) * x2
            + (-12.0 * b - 48.0 * c) * x
            + (8.0 * b + 24.0 * c)
    };
    value / 6.0
}

fn sinc(x: f32) -> f32 {
    let x = std::f32::consts::PI * x;
    if x.abs() < 1e-4 { 1.0 } else { x.sin() / x }
}

/// Bins of a tabulated filter over its whole width. Between their edges the filter is taken as
/// linear: 1e-4 of its peak from its formula at most.
const BINS: usize = 512;

/// Draws places from a filter.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    filter: Filter,
    table: Option<Table>,
}

#[derive(Clone, Debug)]
struct Table {
    /// Bins by the mean of |filter| over them.
    bins: Discrete,
    /// The filter at the bins' edges, its integral over the film being the bins' number.
    edges: Vec<f32>,
}

impl FilterSampler {
    /// Prepares a filter. A radius that is not positive is taken as a box of one pixel.
    pub fn new(filter: Filter) -> Self {
        let radius = filter.radius();
        if !(radius.is_finite() && radius > 0.0) {
            return Self {
                filter: Filter::Box { radius: 0.5 },
                table: None,
            };
        }
        let tabulated = !matches!(filter, Filter::Box { .. } | Filter::Tent { .. });
        Self {
            filter,
            table: tabulated.then(|| Table::new(&filter)).flatten(),
        }
    }

    /// A place around a pixel's centre.
    #[inline]
    pub fn sample(&self, u: Vec2) -> FilterSample {
        let (x, wx) = self.sample_axis(u.x);
        let (y, wy) = self.sample_axis(u.y);
        FilterSample {
            offset: Vec2::new(x, y),
            weight: wx * wy,
        }
    }

    #[inline]
    fn sample_axis(&self, u: f32) -> (f32, f32) {
        let radius = self.filter.radius();
        match &self.table {
            Some(table) => table.sample(radius, u),
            None if matches!(self.filter, Filter::Tent { .. }) => {
                // The inverse of the integral of a tent, one side at a time.
                let x = if u < 0.5 {
                    (2.0 * u).sqrt() - 1.0
                } else {
                    1.0 - (2.0 - 2.0 * u).sqrt()
                };
                (x * radius, 1.0)
            }
            None => ((2.0 * u - 1.0) * radius, 1.0),
        }
    }
}

impl Table {
    fn new(filter: &Filter) -> Option<Self> {
        let radius = filter.radius();
        let at = |i: usize| radius * (2.0 * i as f32 / BINS as f32 - 1.0);
        let edges: Vec<f64> = (0..=BINS).map(|i| f64::from(filter.eval(at(i)))).collect();
        let mean = |of: &dyn Fn(f64) -> f64| -> Vec<f64> {
            let ends = edges.windows(2);
            ends.map(|e| 0.5 * (of(e[0]) + of(e[1]))).collect()
        };
        let scale = BINS as f64 / mean(&|f| f).iter().sum::<f64>();
        Some(Self {
            bins: Discrete::new(&mean(&f64::abs))?,
            edges: edges.iter().map(|f| (f * scale) as f32).collect(),
        })
    }

    #[inline]
    fn sample(&self, radius: f32, u: f32) -> (f32, f32) {
        let bin = self
            .bins
            .sample((f64::from(u) * 18_446_744_073_709_551_616.0) as u64);
        let x = radius * (2.0 * (bin.index as f32 + bin.rest) / BINS as f32 - 1.0);
        let ends = [self.edges[bin.index], self.edges[bin.index + 1]];
        let filter = ends[0].lerp(ends[1], bin.rest);
        (x, filter / (bin.probability * BINS as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILTERS: [Filter; 6] = [
        Filter::Box { radius: 0.5 },
        Filter::Tent { radius: 1.0 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Mitchell {
            b: 1.0 / 3.0,
            c: 1.0 / 3.0,
        },
        Filter::CatmullRom,
        Filter::Lanczos { lobes: 3.0 },
    ];

    /// Weighted samples, binned, must reproduce the filter: stratified numbers make the test sharp.
    #[test]
    fn weighted_places_reproduce_every_filter() {
        for filter in FILTERS {
            let sampler = FilterSampler::new(filter);
            let radius = filter.radius();
            let (n, cells) = (1_000_000, 40);
            let mut sums = vec![0f64; cells];
            for i in 0..n {
                let (x, w) = sampler.sample_axis((i as f32 + 0.5) / n as f32);
                assert!(
                    x.abs() <= radius * 1.000_001 && w.is_finite(),
                    "{filter:?} {x} {w}"
                );
                let cell = ((x / radius * 0.5 + 0.5) * cells as f32) as usize;
                sums[cell.min(cells - 1)] += f64::from(w) / f64::from(n);
            }
            let step = 2.0 * f64::from(radius) / 40_000.0;
            let at = |k: usize| {
                f64::from(filter.eval((-f64::from(radius) + (k as f64 + 0.5) * step) as f32))
            };
            let total: f64 = (0..40_000).map(at).sum();
            for (cell, sum) in sums.iter().enumerate() {
                let truth: f64 = (cell * 1000..(cell + 1) * 1000).map(at).sum::<f64>() / total;
                assert!(
                    (sum - truth).abs() < 2e-4,
                    "{filter:?} cell {cell}: {sum} for {truth}"
                );
            }
            assert!((sums.iter().sum::<f64>() - 1.0).abs() < 1e-4, "{filter:?}");
        }
    }

    #[test]
    fn edges_of_the_unit_interval_stay_inside() {
        for filter in FILTERS {
            let sampler = FilterSampler::new(filter);
            for u in [0.0, 0.5, 1.0 - f32::EPSILON / 2.0] {
                let s = sampler.sample(Vec2::splat(u));
                assert!(s.offset.abs().max_element() <= filter.radius() && s.weight.is_finite());
            }
        }
    }
}
