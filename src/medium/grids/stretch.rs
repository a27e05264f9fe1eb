//! Values along a ray between the centres of voxels, exactly.
//!
//! Between eight centres trilinear interpolation along a straight line is a cubic polynomial, whose
//! integral is known: optical depths without noise, in as many steps as there are voxels in the
//! way. Where densities are so high that null collisions would be countless, this is how a ray is
//! followed: "regular tracking" (Novak, Georgiev, Hanika and Jarosz, "Monte Carlo Methods for
//! Volumetric Light Transport Simulation", 2018).

use super::grid::Grid;
use super::lookup::Filter;
use super::walk::{Lattice, Span, Step, Walk};
use crate::math::DVec3;

/// More halvings than digits.
const MAX_ITERATIONS: usize = 60;
/// Integrals closer than this, relatively, are the same.
const PRECISION: f64 = 1e-14;

/// The values of a grid along a stretch of a span, in each channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// Length along the span where it begins.
    pub from: f64,
    /// Its length.
    pub length: f64,
    /// Coefficients, constant first, of polynomials in the share of its length.
    coefficients: [DVec3; 4],
}

impl Stretch {
    /// The stretches between the lengths `from` and `to` of a span, without gaps.
    pub fn along<'a>(
        grid: &'a Grid,
        span: &'a Span,
        from: f64,
        to: f64,
    ) -> impl Iterator<Item = Self> + use<'a> {
        let (more, offset) = match grid.lookup().filter {
            Filter::Nearest => (0, 0.0),
            // From half a voxel before the first centre to half a voxel after the last.
            Filter::Trilinear => (1, 0.5),
        };
        let lattice = Lattice {
            cells: grid.resolution().map(|n| n + more),
            scale: grid.size(),
            offset,
        };
        let steps = Walk::new(span, &lattice, from, to);
        steps.map(move |step| Self::of(grid, span, &step))
    }

    fn of(grid: &Grid, span: &Span, step: &Step) -> Self {
        let length = step.to - step.from;
        let coefficients = match grid.lookup().filter {
            Filter::Nearest => {
                let value = grid.voxel(grid.index(step.cell));
                [value, DVec3::ZERO, DVec3::ZERO, DVec3::ZERO]
            }
            Filter::Trilinear => {
                let number = DVec3::from_array(step.cell.map(|i| i as f64));
                let place = span.at(step.from) * grid.size() + 0.5 - number;
                let moved = span.moved(length) * grid.size();
                cubic(grid, step.cell, place, moved)
            }
        };
        Self {
            from: step.from,
            length,
            coefficients,
        }
    }

    /// The values at a share of the length.
    #[inline]
    pub fn value(&self, share: f64) -> DVec3 {
        let [a, b, c, d] = self.coefficients;
        (a + share * (b + share * (c + share * d))).max(DVec3::ZERO)
    }

    /// The integrals over length up to a share of it.
    #[inline]
    pub fn integral(&self, share: f64) -> DVec3 {
        let [a, b, c, d] = self.coefficients;
        let mean = a + share * (b / 2.0 + share * (c / 3.0 + share * (d / 4.0)));
        (mean * (share * self.length)).max(DVec3::ZERO)
    }

    /// The share of the length where the integral of a channel reaches `target`, which lies between
    /// 0 and the whole integral. By Newton's method, kept between bounds.
    pub fn share_at(&self, channel: usize, target: f64) -> f64 {
        let (mut low, mut high) = (0.0, 1.0);
        let mut share = (target / self.integral(1.0)[channel]).clamp(0.0, 1.0);
        for _ in 0..MAX_ITERATIONS {
            let error = self.integral(share)[channel] - target;
            if error.abs() <= PRECISION * target {
                break;
            }
            if error > 0.0 {
                high = share;
            } else {
                low = share;
            }
            let slope = self.value(share)[channel] * self.length;
            share -= error / slope;
            // Not a number where the density vanishes.
            if !(low < share && share < high) {
                share = 0.5 * (low + high);
            }
        }
        share
    }
}

/// The coefficients of trilinear interpolation in a cell of the lattice of centres, on the way from
/// `place` (0 to 1 along each axis) by `moved`.
fn cubic(grid: &Grid, cell: [i64; 3], place: DVec3, moved: DVec3) -> [DVec3; 4] {
    let v = grid.corners(cell).map(|voxel| grid.voxel(voxel));
    // One axis after the other, lower and upper polynomials become one of the next degree.
    let along_x = |i: usize| {
        let difference = v[i + 1] - v[i];
        [v[i] + difference * place.x, difference * moved.x]
    };
    let along_y = |i: usize| {
        let ([a, b], [c, d]) = (along_x(i), along_x(i + 2));
        let (e, f) = (c - a, d - b);
        [a + e * place.y, b + f * place.y + e * moved.y, f * moved.y]
    };
    let ([a, b, c], [d, e, f]) = (along_y(0), along_y(4));
    let (g, h, i) = (d - a, e - b, f - c);
    [
        a + g * place.z,
        b + h * place.z + g * moved.z,
        c + i * place.z + h * moved.z,
        i * moved.z,
    ]
}
