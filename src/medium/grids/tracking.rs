//! Following a ray through a grid: delta tracking, ratio tracking, and from voxel to voxel.
//!
//! In most cells of the majorant grid free flights are delta tracking (Woodcock et al. 1965), where
//! a tentative collision below the cell's least density is real without a look at the grid
//! (decomposition tracking: Kutz, Habel, Li and Novak, "Spectral and Decomposition Tracking for
//! Rendering Heterogeneous Volumes", 2017). Transmittance is residual ratio tracking (Novak, Selle
//! and Jarosz, "Residual Ratio Tracking for Estimating Attenuation in Participating Media", 2014):
//! exact for the least density, estimated for the rest. Where more tentative collisions are to be
//! expected than [`PER_VOXEL`] for each voxel in the way, the ray is followed from voxel to voxel
//! instead, with exact optical depths. So the steps of a ray are bounded by the grid, whatever its
//! densities: their mean is below `PER_VOXEL * (x + y + z + 3 * 64)`. Two axes of the largest
//! resolution, which is more than memory holds, make that 2^19.1, from which 2^20 is a thousand
//! standard deviations away.

use super::balance::Balance;
use super::draw::{exponential, uniform};
use super::grid::Grid;
use super::majorant::{Bounded, Majorants};
use super::stretch::Stretch;
use super::walk::Span;
use crate::math::DVec3;

/// Expected tentative collisions per voxel beyond which voxels are the shorter way.
const PER_VOXEL: f64 = 4.0;
/// Transmittance below this goes through Russian roulette, and comes out as this.
const ROULETTE: f64 = 0.1;

/// A ray through a grid of densities.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracking<'a> {
    /// The densities.
    pub density: &'a Grid,
    /// What makes them extinction coefficients, per unit of length of the scene.
    pub scale: f64,
    /// Their upper bounds.
    pub majorants: &'a Majorants,
    /// The ray.
    pub span: &'a Span,
}

impl Tracking<'_> {
    /// The length along the span to a real collision, `None` where the ray arrives.
    pub fn fly(&self, balance: &mut Balance, u: &mut impl FnMut() -> f32) -> Option<f64> {
        let mut depth = exponential(u);
        for part in self.majorants.along(self.span) {
            let met = if self.is_dense(&part) {
                self.regular_tracking(&part, balance, u)
            } else {
                self.delta_tracking(&part, &mut depth, balance, u)
            };
            if met.is_some() {
                return met;
            }
        }
        None
    }

    /// An unbiased estimate of the transmittance of the span, 0 to 1.
    pub fn transmittance(&self, u: &mut impl FnMut() -> f32) -> DVec3 {
        let mut left = DVec3::ONE;
        let mut depth = exponential(u);
        for part in self.majorants.along(self.span) {
            if !self.is_dense(&part) {
                self.ratio_tracking(&part, &mut depth, &mut left, u);
            } else if roulette(&mut left, u) {
                left *= (-self.depth_between(part.from, part.to)).exp();
            }
            if left == DVec3::ZERO {
                break;
            }
        }
        left
    }

    /// The optical depth of the span, exact up to rounding.
    pub fn optical_depth(&self) -> DVec3 {
        self.depth_between(0.0, self.span.length)
    }

    /// Whether a stretch takes fewer steps from voxel to voxel than by tentative collisions.
    fn is_dense(&self, part: &Bounded) -> bool {
        let length = part.to - part.from;
        let moved = self.span.moved(length) * self.density.size();
        let voxels = 1.0 + moved.abs().element_sum();
        part.majorant * self.scale * length > PER_VOXEL * voxels
    }

    fn depth_between(&self, from: f64, to: f64) -> DVec3 {
        let parts = Stretch::along(self.density, self.span, from, to);
        parts.fold(DVec3::ZERO, |sum, part| sum + part.integral(1.0)) * self.scale
    }

    /// Tentative collisions in a stretch below one majorant. `depth` is the optical depth up to the
    /// next, by majorants; it outlasts the stretch.
    fn delta_tracking(
        &self,
        part: &Bounded,
        depth: &mut f64,
        balance: &mut Balance,
        u: &mut impl FnMut() -> f32,
    ) -> Option<f64> {
        let mut tentative = Tentative::new(part, part.majorant * self.scale);
        let certain = part.minorant / part.majorant;
        while let Some(at) = tentative.next(depth) {
            let number = uniform(u);
            if number < certain && balance.is_grey() {
                return Some(at);
            }
            let density = self.density.eval_local(self.span.at(at));
            let real = (density / part.majorant).min(DVec3::ONE);
            let is_real = number < real[balance.hero(u)];
            balance.take(if is_real { real } else { DVec3::ONE - real });
            if is_real {
                return Some(at);
            }
            *depth = exponential(u);
        }
        None
    }

    /// Voxel by voxel, each a decision: through, or a collision at a certain place.
    fn regular_tracking(
        &self,
        part: &Bounded,
        balance: &mut Balance,
        u: &mut impl FnMut() -> f32,
    ) -> Option<f64> {
        for stretch in Stretch::along(self.density, self.span, part.from, part.to) {
            let hero = balance.hero(u);
            let target = exponential(u);
            let whole = stretch.integral(1.0) * self.scale;
            if target >= whole[hero] {
                balance.take((-whole).exp());
                continue;
            }
            let share = stretch.share_at(hero, target / self.scale);
            let before = stretch.integral(share) * self.scale;
            balance.take(stretch.value(share) * (-before).exp());
            return Some(stretch.from + share * stretch.length);
        }
        None
    }

    /// Multiplies `left` with the estimated transmittance of a stretch between two bounds: what the
    /// lower leaves is exact, ratio tracking estimates the residual.
    fn ratio_tracking(
        &self,
        part: &Bounded,
        depth: &mut f64,
        left: &mut DVec3,
        u: &mut impl FnMut() -> f32,
    ) {
        *left *= (-part.minorant * self.scale * (part.to - part.from)).exp();
        let residual = part.majorant - part.minorant;
        let mut tentative = Tentative::new(part, residual * self.scale);
        while let Some(at) = tentative.next(depth) {
            if !roulette(left, u) {
                return;
            }
            let density = self.density.eval_local(self.span.at(at)) - part.minorant;
            *left *= (DVec3::ONE - density / residual).clamp(DVec3::ZERO, DVec3::ONE);
            *depth = exponential(u);
        }
    }
}

/// The tentative collisions of a stretch, so many per unit of length.
struct Tentative {
    rate: f64,
    at: f64,
    end: f64,
}

impl Tentative {
    fn new(part: &Bounded, rate: f64) -> Self {
        Self {
            rate,
            at: part.from,
            end: part.to,
        }
    }

    /// The length along the span of the one that `depth` leads to. Where that is beyond the
    /// stretch, `depth` is what remains of it.
    #[inline]
    fn next(&mut self, depth: &mut f64) -> Option<f64> {
        let rest = self.rate * (self.end - self.at);
        if *depth >= rest {
            *depth -= rest;
            return None;
        }
        self.at = (self.at + *depth / self.rate).min(self.end);
        Some(self.at)
    }
}

/// Ends light that has become little, or makes it more: false where it has ended.
#[inline]
fn roulette(left: &mut DVec3, u: &mut impl FnMut() -> f32) -> bool {
    let chance = left.max_element() / ROULETTE;
    if chance < 1.0 {
        let survives = uniform(u) < chance;
        *left = if survives {
            *left / chance
        } else {
            DVec3::ZERO
        };
    }
    *left != DVec3::ZERO
}
