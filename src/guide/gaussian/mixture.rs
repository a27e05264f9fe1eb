//! A frozen mixture over a [`Domain`].

use super::domain::Domain;
use super::lanes::{Eight, Lanes};
use super::lobe::{LOBES, Lobe};
use crate::math::Vec2;
use crate::math::rng::{BELOW_ONE, hash_all, hash64, unit_f32};
use std::f32::consts::TAU;

/// A lobe with less of its mass inside is left out: a mean of points inside has never so little
/// around it.
const LEAST_MASS: f32 = 0.02;
/// Draws before a lobe is given up on: with the least mass inside, one in 10^11 gets that far.
const DRAWS: u64 = 1280;

/// Gaussians cut off at the borders of a domain, each normalised over it, and a share of the
/// uniform distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    lanes: Lanes,
    /// Running sums of the lobes' probabilities; the last is 1.
    running: Eight,
    uniform: f32,
    domain: Domain,
}

impl Mixture {
    /// A mixture with a share of the uniform distribution, (0, 1]. Lobes without a usable
    /// covariance are left out; without any the mixture is uniform.
    pub fn new(lobes: &[Lobe; LOBES], uniform: f32, domain: Domain) -> Self {
        let mut lanes = Lanes::default();
        let mut weights = [0f32; LOBES];
        for (j, lobe) in lobes.iter().enumerate() {
            let Some([a, b, d]) = lobe.inverse_cholesky() else {
                continue;
            };
            let mass = domain.mass(lobe);
            let usable = mass >= LEAST_MASS && lobe.weight > 0.0 && lobe.weight.is_finite();
            if !usable {
                continue;
            }
            weights[j] = lobe.weight;
            (lanes.x[j], lanes.y[j]) = (lobe.mean.x, lobe.mean.y);
            (lanes.a[j], lanes.b[j], lanes.d[j]) = (a, b, d);
            lanes.scale[j] = a * d / (TAU * mass);
        }
        let total: f32 = weights.iter().sum();
        if total.is_nan() || total <= 0.0 {
            return Self {
                lanes: Lanes::default(),
                running: [1.0; LOBES],
                uniform: 1.0,
                domain,
            };
        }
        let mut running = [0.0; LOBES];
        let mut sum = 0.0;
        for j in 0..LOBES {
            let p = weights[j] / total;
            lanes.scale[j] *= p * (1.0 - uniform);
            sum += p;
            running[j] = sum;
        }
        running[LOBES - 1] = 1.0;
        Self {
            lanes,
            running,
            uniform,
            domain,
        }
    }

    /// Density over the domain: positive inside.
    #[inline(always)]
    pub fn density(&self, u: Vec2) -> f32 {
        self.uniform / self.domain.area() + self.lanes.density(u.x, u.y)
    }

    /// A point of the domain. `select` chooses the lobe and `u` the place in it, both uniform in
    /// the unit interval and square. A place outside is drawn again, with numbers that follow from
    /// these.
    #[inline]
    pub fn sample(&self, select: f32, u: Vec2) -> Vec2 {
        let (lobe, _) = self.choose(select);
        self.draw(lobe, u, u64::from(select.to_bits()))
    }

    /// The same from two numbers: what chooses the lobe is used again inside it.
    #[inline]
    pub fn sample_by_two(&self, u: Vec2) -> Vec2 {
        let (lobe, rest) = self.choose(u.x);
        self.draw(lobe, Vec2::new(rest, u.y), u64::from(u.x.to_bits()))
    }

    /// A lobe, or `None` for the uniform distribution, and where in its share `select` is, in [0,
    /// 1).
    #[inline]
    fn choose(&self, select: f32) -> (Option<usize>, f32) {
        if select < self.uniform || self.uniform >= 1.0 {
            return (None, (select / self.uniform).min(BELOW_ONE));
        }
        let t = (select - self.uniform) / (1.0 - self.uniform);
        let j = self.running.iter().position(|&r| r > t);
        let j = j.unwrap_or(LOBES - 1);
        let before = if j == 0 { 0.0 } else { self.running[j - 1] };
        let rest = (t - before) / (self.running[j] - before);
        // A lobe without a share is never chosen but by rounding.
        (Some(j), rest.clamp(0.0, BELOW_ONE))
    }

    #[inline]
    fn draw(&self, lobe: Option<usize>, u: Vec2, select: u64) -> Vec2 {
        let lanes = &self.lanes;
        let Some(j) = lobe.filter(|&j| lanes.a[j] > 0.0) else {
            return self.domain.uniform(u);
        };
        let stream = hash_all([select, u64::from(u.x.to_bits()), u64::from(u.y.to_bits())]);
        let mut v = u;
        for i in 0..DRAWS {
            // Box and Muller, then the Cholesky factor.
            let r = (-2.0 * (1.0 - v.x).ln()).sqrt();
            let (sin, cos) = (TAU * v.y).sin_cos();
            let dx = r * cos / lanes.a[j];
            let dy = (r * sin - lanes.b[j] * dx) / lanes.d[j];
            let place = Vec2::new(lanes.x[j] + dx, lanes.y[j] + dy);
            if self.domain.contains(place) {
                return place;
            }
            let h = hash64(stream.wrapping_add(i.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
            v = Vec2::new(unit_f32(h as u32), unit_f32((h >> 32) as u32));
        }
        self.domain.uniform(u)
    }
}
