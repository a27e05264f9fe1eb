//! Cached Gaussian mixtures: the method that the double hierarchy competes with.
//!
//! Vorba, Karlík, Šik, Ritschel and Křivánek, "On-line Learning of Parametric Mixture Models for
//! Light Transport Simulation" (ACM Trans. Graph. 33(4), 2014). Light that arrives at a point is a
//! density over the hemisphere above it. It is kept where paths will need it, in *records* on the
//! scene's surfaces, each a mixture of [`LOBES`] Gaussians, and a path vertex asks the nearest
//! record.
//!
//! * **Square.** The hemisphere is mapped to the unit square by Shirley and Chiu's concentric map,
//!   which keeps areas: a density over the square is one over solid angle, but for 2 pi (`square`).
//! * **Records** are made once the first batch of photons is there, at points where camera paths
//!   scatter and no record serves yet. A record listens to the photons within its radius on
//!   surfaces that face the same way. The radius is such that it will hear of [`Settings::photons`]
//!   photons in all, so records stand close where light is dense; a record serves the points within
//!   half of its radius (`place`).
//! * **Learning** is weighted stepwise expectation maximisation with the paper's conjugate priors:
//!   the first photons, gathered until there are enough, start the mixture (k-means++ seeds, then a
//!   few iterations over them alone), later ones are mini-batches that move its sufficient
//!   statistics (`em`). Photons are forgotten afterwards.
//! * **Sampling.** Gaussians reach beyond the square. A sample that falls outside is drawn again,
//!   and each lobe's density is divided by its mass inside, which is integrated once when the field
//!   is frozen: mixtures integrate to one over the hemisphere (`mixture`).
//!
//! What differs from the paper: photons count less towards the rim of a record, as in density
//! estimation; the prior is weighed against the effective number of photons, which unequal powers
//! lower; the rate of the stepwise updates goes by photons instead of by batches, so that records
//! in the dark, which wait until there are enough for a step, weigh all their photons alike, and
//! forgets less (0.9 instead of 0.7), for here early photons are as good as late ones. Only
//! incident light is learned: photons are not guided by visual importance, which the paper does in
//! alternation, because the comparison is about what is made of the same photons.
//!
//! Everything about a record depends on the photons near it in their order, and records are worked
//! on side by side: the same photons give the same bits on any number of threads.

mod cover;
mod em;
mod field;
mod near;
mod place;
mod record;
mod square;
mod train;

pub use super::gaussian::{LOBES, Lobe, Mixture};
pub use em::Sample;
pub use field::{LocalMixture, Mixtures};
pub use train::GmmTrainer;

use super::settings::GuideError;
use crate::math::Vec3;

/// What shapes cached mixtures. [`Settings::new`] gives the defaults for given bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Lower corner of the scene.
    pub min: Vec3,
    /// Upper corner of the scene.
    pub max: Vec3,
    /// Batches of equal size that the photons will come in.
    pub batches: u32,
    /// Photons that a record is to hear of in all: what its radius is chosen by.
    pub photons: u32,
    /// Smallest radius of a record, as a share of the scene's diagonal.
    pub min_radius: f32,
    /// Largest radius.
    pub max_radius: f32,
    /// Share of a record's radius within which it serves: no other record is made there.
    pub validity: f32,
    /// Photons of a step of stepwise expectation maximisation.
    pub step: u32,
    /// Rate of the steps: the i-th of equal steps counts as i^-rate. 1 forgets nothing.
    pub rate: f64,
    /// Least share of the uniform distribution in a record's density.
    pub defensive: f32,
    /// Bytes that the records may take while they learn.
    pub memory: u64,
    /// Seed of the starting points of mixtures.
    pub seed: u64,
}

impl Settings {
    /// Defaults for a scene inside the box `min`..`max`.
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Self {
            min,
            max,
            batches: 30,
            photons: 1000,
            min_radius: 1e-3,
            max_radius: 0.05,
            validity: 0.5,
            step: 64,
            rate: 0.9,
            defensive: 0.01,
            memory: 256 << 20,
            seed: 0,
        }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// Names the first value that is out of range and what it may be.
    pub fn validate(&self) -> Result<(), GuideError> {
        let finite = self.min.is_finite() && self.max.is_finite();
        let diagonal = (self.max.as_dvec3() - self.min.as_dvec3()).length();
        let checks = [
            (
                finite && self.min.cmple(self.max).all() && diagonal < 3e38,
                "bounds must be finite with min <= max",
            ),
            (
                self.batches > 0 && self.photons > 0 && self.step > 0,
                "batches, photons and step must be above 0",
            ),
            (
                self.min_radius > 0.0
                    && self.min_radius <= self.max_radius
                    && self.max_radius <= 1.0,
                "radii must lie in (0, 1] with min_radius <= max_radius",
            ),
            (
                self.validity > 0.0 && self.validity <= 1.0,
                "validity must lie in (0, 1]",
            ),
            (
                self.rate > 0.5 && self.rate <= 1.0,
                "rate must lie in (0.5, 1]",
            ),
            (
                self.defensive > 0.0 && self.defensive <= 1.0,
                "defensive must lie in (0, 1]",
            ),
        ];
        match checks.iter().find(|c| !c.0) {
            Some((_, what)) => Err(GuideError::Settings((*what).to_owned())),
            None => Ok(()),
        }
    }

    /// The scene's diagonal; 1 for a scene that is a point.
    fn diagonal(&self) -> f32 {
        let d = (self.max - self.min).length();
        if d > 0.0 { d } else { 1.0 }
    }
}

#[cfg(test)]
mod tests;
