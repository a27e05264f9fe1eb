//! Tests of media on grids: against Mitsuba's values, closed forms and numerical quadrature.

use super::{Albedo, Filter, Grid, Heterogeneous, Lookup, Wrap};
use crate::math::{Affine3A, DVec3, Pcg32, Quat, Rgb, Vec3};
use std::sync::Arc;

mod bounds;
mod collisions;
mod extremes;
mod lookup;
mod stretches;
mod transmittance;
mod vol;

/// Standard errors that an estimate may be off. The seeds are fixed; of independent ones, one in
/// 16 000 would be.
const SIGMAS: f64 = 4.0;

/// A grid whose values are drawn by `value`, in order.
fn grid(
    resolution: [u32; 3],
    channels: u32,
    to_world: Affine3A,
    lookup: Lookup,
    mut value: impl FnMut() -> f32,
) -> Grid {
    let count = resolution.iter().product::<u32>() * channels;
    let values = Arc::new((0..count).map(|_| value()).collect());
    Grid::new(resolution, channels, values, to_world, lookup).unwrap()
}

/// A medium of one value everywhere in the unit cube, albedo 1.
fn constant(sigma_t: f32) -> Heterogeneous {
    let density = grid([3; 3], 1, Affine3A::IDENTITY, Lookup::default(), || sigma_t);
    Heterogeneous::new(density, 1.0, Albedo::Constant(Rgb::ONE)).unwrap()
}

/// A transform that turns, stretches and moves.
fn odd_place() -> Affine3A {
    let turn = Quat::from_axis_angle(Vec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let size = Vec3::new(2.0, 3.0, 1.5);
    Affine3A::from_scale_rotation_translation(size, turn, Vec3::new(2.0, -1.0, 6.0))
}

/// Every filter with every wrap mode.
fn lookups() -> impl Iterator<Item = Lookup> + Clone {
    let wraps = [Wrap::Clamp, Wrap::Repeat, Wrap::Mirror, Wrap::Zero];
    [Filter::Trilinear, Filter::Nearest]
        .into_iter()
        .flat_map(move |filter| wraps.map(|wrap| Lookup { filter, wrap }))
}

/// A point in the unit cube.
fn point(rng: &mut Pcg32) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.next_f32()))
}

/// A ray from outside through the unit cube that `to_world` places.
fn ray(to_world: &Affine3A, rng: &mut Pcg32) -> (Vec3, Vec3) {
    let (a, b) = (point(rng), point(rng));
    let from = to_world.transform_point3(a + 3.0 * (a - b).normalize());
    (from, (to_world.transform_point3(b) - from).normalize())
}

/// The integral of `f` from 0 to `length`, by the midpoint rule.
fn quadrature(length: f64, steps: u32, f: impl Fn(f64) -> DVec3) -> DVec3 {
    let width = length / f64::from(steps);
    let terms = (0..steps).map(|i| f((f64::from(i) + 0.5) * width));
    terms.sum::<DVec3>() * width
}

/// Transmittance and the integral of albedo times extinction times transmittance, by quadrature of
/// looked-up values alone.
fn expected(medium: &Heterogeneous, org: Vec3, dir: Vec3, distance: f32) -> (DVec3, DVec3) {
    const STEPS: u32 = 40_000;
    let width = f64::from(distance) / f64::from(STEPS);
    let (mut depth, mut scattered) = (DVec3::ZERO, DVec3::ZERO);
    for i in 0..STEPS {
        let p = org + dir * ((f64::from(i) + 0.5) * width) as f32;
        let sigma_t = medium.sigma_t(p).as_dvec3();
        let middle = (-(depth + sigma_t * (0.5 * width))).exp();
        scattered += medium.albedo(p).as_dvec3() * sigma_t * middle * width;
        depth += sigma_t * width;
    }
    ((-depth).exp(), scattered)
}

/// Mean and standard error of three channels.
#[derive(Default)]
struct Mean {
    count: f64,
    sum: DVec3,
    squares: DVec3,
}

impl Mean {
    fn add(&mut self, x: Rgb) {
        let x = x.as_dvec3();
        self.count += 1.0;
        self.sum += x;
        self.squares += x * x;
    }

    fn value(&self) -> DVec3 {
        self.sum / self.count
    }

    fn error(&self) -> DVec3 {
        let variance = self.squares / self.count - self.value() * self.value();
        let root = |x: f64| (x.max(0.0) / self.count).sqrt();
        DVec3::new(root(variance.x), root(variance.y), root(variance.z))
    }

    /// Holds the mean to `expected` within [`SIGMAS`], and these to less than `power` times
    /// `expected`: an error by more than twice that share is found.
    fn check(&self, expected: DVec3, power: f64, what: &str) {
        let bound = self.error() * SIGMAS + 1e-6 * expected;
        let off = (self.value() - expected).abs();
        assert!(
            off.cmple(bound).all() && self.value().is_finite(),
            "{what}: {} for {expected}, off by {off}, allowed {bound}",
            self.value()
        );
        assert!(
            bound.cmple(expected * power).all(),
            "{what}: {bound} is too coarse for {expected}"
        );
    }
}

/// How many standard deviations a chi-square statistic lies above its mean (Wilson and Hilferty
/// 1931), for counts of which all but the last cell's share are `expected`.
fn chi_square_z(counts: &[u32], expected: &[f64]) -> f64 {
    let terms = counts.iter().zip(expected).map(|(&n, &e)| {
        assert!(e > 20.0, "a cell expects {e}");
        (f64::from(n) - e).powi(2) / e
    });
    let degrees = counts.len() as f64 - 1.0;
    let variance = 2.0 / (9.0 * degrees);
    ((terms.sum::<f64>() / degrees).cbrt() - (1.0 - variance)) / variance.sqrt()
}
