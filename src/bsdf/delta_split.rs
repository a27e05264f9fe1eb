//! A delta lobe set apart from all other lobes.
//!
//! A path tracer that follows one lobe by lot wastes what it knows: where a path was sent to a
//! polished table because the sun shines in it, the varnish, which reflects four per cent, is
//! chosen four times in a hundred. Set apart, the delta lobe and the rest can both be followed,
//! each by a lot of its own.

use super::{Bsdf, BsdfSample, LobeFlags, Transport};
use crate::math::rng::BELOW_ONE;
use crate::math::{Vec2, Vec3};

/// One delta lobe of a material, and all the rest.
#[derive(Clone, Copy, Debug)]
pub struct DeltaSplit {
    /// What [`Bsdf::sample`] gives for the delta lobe: its `pdf` is the probability of choosing it.
    pub delta: BsdfSample,
    /// The rest.
    pub rest: Rest,
}

/// All lobes but one: an interval of the numbers that choose among lobes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rest {
    start: f32,
    /// The probability of choosing one of these lobes, (0, 1].
    pub chance: f32,
}

impl Rest {
    /// All lobes.
    pub const ALL: Self = Self {
        start: 0.0,
        chance: 1.0,
    };

    /// The number by which [`Bsdf::sample`] chooses among these lobes, for a uniform `u`. Weights
    /// are then too large by 1 / `chance`, and densities too small by `chance`.
    #[inline]
    pub fn choose(self, u: f32) -> f32 {
        (self.start + u * self.chance).min(BELOW_ONE)
    }
}

impl Bsdf {
    /// Sets a delta lobe apart: the one that the least of the numbers that choose among lobes
    /// stands for, or else the greatest. `None` if neither is a delta lobe, or if there is nothing
    /// beside it.
    #[inline]
    pub fn split_delta(&self, wo: Vec3, transport: Transport) -> Option<DeltaSplit> {
        if !self.flags().has(LobeFlags::DELTA) {
            return None;
        }
        let at = |u: f32| {
            let sample = self.sample(wo, u, Vec2::splat(0.5), transport)?;
            (sample.lobe.has(LobeFlags::DELTA) && sample.pdf < 1.0).then_some(sample)
        };
        let (delta, start) = match at(0.0) {
            Some(first) => (first, first.pdf),
            None => (at(BELOW_ONE)?, 0.0),
        };
        let chance = 1.0 - delta.pdf;
        Some(DeltaSplit {
            delta,
            rest: Rest { start, chance },
        })
    }
}
