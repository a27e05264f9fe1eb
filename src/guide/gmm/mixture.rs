//! A frozen mixture over the unit square.

use super::em::Lobe;
use super::lanes::{Eight, LOBES, Lanes};
use super::mass;
use crate::math::rng::{hash_all, unit_f32};
use crate::math::{Vec2, rng::hash64};
use std::f32::consts::TAU;

/// A lobe with less of its mass inside the square is left out: a mean of points in the square has never so
/// little around it.
const LEAST_MASS: f32 = 0.02;
/// Draws before a lobe is given up on: with the least mass inside, one in 10^11 gets that far.
const DRAWS: u64 = 1280;

/// Gaussians cut off at the borders of the unit square, each normalised over it, and a share of the uniform
/// distribution.
#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    lanes: Lanes,
    /// Running sums of the lobes' probabilities; the last is 1.
    running: Eight,
    uniform: f32,
}

impl Mixture {
    /// A mixture with a share of the uniform distribution, (0, 1]. Lobes without a usable covariance are left
    /// out; without any the mixture is uniform.
    pub fn new(lobes: &[Lobe; LOBES], uniform: f32) -> Self {
        let mut lanes = Lanes::default();
        let mut weights = [0f32; LOBES];
        for (j, lobe) in lobes.iter().enumerate() {
            let Some([a, b, d]) = lobe.inverse_cholesky() else {
                continue;
            };
            let mass = mass::inside(lobe);
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
        }
    }

    /// Density over the square: positive inside.
    #[inline]
    pub fn density(&self, u: Vec2) -> f32 {
        self.uniform + self.lanes.density(u.x, u.y)
    }

    /// A point of the square. `select` chooses the lobe and `u` the place in it, both uniform in the unit
    /// interval and square. A place outside the square is drawn again, with numbers that follow from these.
    #[inline]
    pub fn sample(&self, select: f32, u: Vec2) -> Vec2 {
        if select < self.uniform || self.uniform >= 1.0 {
            return u;
        }
        let t = (select - self.uniform) / (1.0 - self.uniform);
        let j = self.running.iter().position(|&r| r > t);
        let j = j.unwrap_or(LOBES - 1);
        let lanes = &self.lanes;
        if lanes.a[j] <= 0.0 {
            return u;
        }
        let stream = hash_all([
            u64::from(select.to_bits()),
            u64::from(u.x.to_bits()),
            u64::from(u.y.to_bits()),
        ]);
        let mut v = u;
        for i in 0..DRAWS {
            // Box and Muller, then the Cholesky factor.
            let r = (-2.0 * (1.0 - v.x).ln()).sqrt();
            let (sin, cos) = (TAU * v.y).sin_cos();
            let dx = r * cos / lanes.a[j];
            let dy = (r * sin - lanes.b[j] * dx) / lanes.d[j];
            let place = Vec2::new(lanes.x[j] + dx, lanes.y[j] + dy);
            if place.cmpge(Vec2::ZERO).all() && place.cmple(Vec2::ONE).all() {
                return place;
            }
            let h = hash64(stream.wrapping_add(i.wrapping_mul(0x9e37_79b9_7f4a_7c15)));
            v = Vec2::new(unit_f32(h as u32), unit_f32((h >> 32) as u32));
        }
        u
    }
}
