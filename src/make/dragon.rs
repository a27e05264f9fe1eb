//! A wall along the dragon curve, which rises as it goes.
//!
//! The curve's n-th step goes in direction i^g, where g is the number of ones in the Gray code of
//! n; sums of them follow digit by digit from those over powers of two. The wall joins the middles
//! of the steps: so it cuts the corners at which the curve would touch itself.

use super::half_quad;
use crate::math::DVec3;
use glam::DVec2;

/// Bits of the longest curve.
const BITS: usize = 40;
/// Thickness of the wall, in steps.
const THICKNESS: f64 = 0.22;
/// Height of the wall, in steps.
const WALL: f64 = 0.6;
/// How far the wall climbs, as a share of the curve's extent.
const CLIMB: f64 = 0.4;

/// A wall of `sections` sections.
#[derive(Clone, Debug)]
pub struct Dragon {
    sections: u64,
    /// Sums over all numbers of k bits, by whether the bit above is set.
    sums: Vec<[DVec2; 2]>,
    step: f64,
}

/// i^g times v.
fn turned(v: DVec2, g: u64) -> DVec2 {
    match g % 4 {
        0 => v,
        1 => v.perp(),
        2 => -v,
        _ => -v.perp(),
    }
}

impl Dragon {
    /// Of about that many triangles.
    pub fn new(triangles: u64) -> Self {
        let sections = (triangles.saturating_sub(4) / 8).clamp(2, 1 << (BITS - 1));
        let mut sums = vec![[DVec2::X; 2]];
        for k in 0..BITS {
            let [zero, one] = sums[k];
            sums.push([0, 1].map(|above| turned(zero, above) + turned(one, 1 - above)));
        }
        Self {
            sections,
            sums,
            step: 1.0 / (sections as f64).sqrt(),
        }
    }

    pub fn vertices(&self) -> u64 {
        4 * (self.sections + 1)
    }

    pub fn triangles(&self) -> u64 {
        8 * self.sections + 4
    }

    /// The end of the first `n` steps.
    fn point(&self, n: u64) -> DVec2 {
        let (mut sum, mut factor, mut above) = (DVec2::ZERO, 0, 0);
        for k in (0..BITS).rev() {
            let bit = n >> k & 1;
            if bit == 1 {
                // All numbers that go on with 0 here come before n.
                sum += turned(self.sums[k][0], factor + above);
            }
            factor += bit ^ above;
            above = bit;
        }
        sum
    }

    pub fn vertex(&self, i: u64) -> DVec3 {
        let (n, corner) = (i / 4, i % 4);
        let direction = turned(DVec2::X, u64::from((n ^ n >> 1).count_ones()));
        let middle = self.point(n) + 0.5 * direction;
        let side = if corner % 2 == 0 { 0.5 } else { -0.5 };
        let p = (middle + direction.perp() * (side * THICKNESS)) * self.step;
        let climb = CLIMB * n as f64 / self.sections as f64;
        let top = if corner < 2 { 0.0 } else { WALL * self.step };
        DVec3::new(p.x, climb + top, -p.y)
    }

    pub fn triangle(&self, i: u64) -> [u64; 3] {
        // Corners of a cross-section: left and right below, left and right above.
        const SIDES: [[u64; 2]; 4] = [[0, 2], [2, 3], [3, 1], [1, 0]];
        let sections = self.sections;
        if i < 8 * sections {
            let (here, [a, b]) = (4 * (i / 8), SIDES[(i / 2 % 4) as usize]);
            let next = here + 4;
            return half_quad([here + a, here + b, next + a, next + b], i % 2 == 1);
        }
        let end = 4 * sections;
        match i - 8 * sections {
            0 => [0, 1, 2],
            1 => [1, 3, 2],
            2 => [end, end + 2, end + 1],
            _ => [end + 1, end + 2, end + 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_is_the_sum_of_its_steps() {
        let dragon = Dragon::new(100_000);
        let mut sum = DVec2::ZERO;
        for n in 0..5_000u64 {
            assert_eq!(dragon.point(n), sum, "{n}");
            sum += turned(DVec2::X, u64::from((n ^ n >> 1).count_ones()));
        }
        // No step is walked twice, and turns are right angles.
        let mut steps = std::collections::HashSet::new();
        for n in 0..5_000 {
            let middle = (dragon.point(n) + dragon.point(n + 1)).as_ivec2();
            assert!(steps.insert(middle), "{n}");
        }
    }
}
