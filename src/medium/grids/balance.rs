//! Decisions that are made for three channels at once (Miller, Georgiev and Jarosz, "A
//! null-scattering path integral formulation of light transport", 2019).
//!
//! A decision, such as whether a collision is real, has a probability for each channel. One
//! channel, the hero, decides; it is drawn with the densities that the path has so far in the
//! channels. The path is then divided by the mean of all three densities: multiple importance
//! sampling of channels with the balance heuristic, one decision after the other. The factors stay
//! bounded where a single deciding channel would be divided by a vanishing density.

use super::draw::uniform;
use crate::math::{DVec3, Rgb};

/// Relative densities below this are 0: products with their inverse stay in the range of `f32`.
const VANISHING: f64 = f32::MIN_POSITIVE as f64;

/// What decisions have made of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Balance {
    /// Contribution over density since the path came here.
    factor: DVec3,
    /// Relative densities of the channels, with mean 1.
    weights: DVec3,
    /// All channels decide alike: nothing changes.
    is_grey: bool,
}

impl Balance {
    /// Before the first decision; `weights` as the path brings them. Where it `is_grey`, every
    /// decision has the same density in all channels.
    pub fn new(weights: Rgb, is_grey: bool) -> Self {
        Self {
            factor: DVec3::ONE,
            weights: weights.as_dvec3(),
            is_grey,
        }
    }

    /// Whether every decision has the same density in all channels.
    #[inline]
    pub fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// The channel that decides.
    #[inline]
    pub fn hero(&self, u: &mut impl FnMut() -> f32) -> usize {
        if self.is_grey {
            return 0;
        }
        let [red, green, blue] = self.weights.to_array();
        let place = uniform(u) * (red + green + blue);
        if place < red {
            0
        } else if place < red + green {
            1
        } else {
            // Where rounding leads beyond the sum: the last that has a chance at all.
            (0..3).rev().find(|&c| self.weights[c] > 0.0).unwrap_or(0)
        }
    }

    /// Takes an outcome that has the density `p` in each channel and contributes as much.
    #[inline]
    pub fn take(&mut self, p: DVec3) {
        if self.is_grey {
            return;
        }
        let mean = (self.weights * p).element_sum() / 3.0;
        // Never below 0 nor NaN; 0 only where the caller's weights were no densities.
        let ratio = if mean > 0.0 { p / mean } else { DVec3::ZERO };
        self.factor *= ratio;
        self.weights *= ratio;
    }

    /// The factor and the weights. A channel without density has no contribution left.
    pub fn finish(&self) -> (Rgb, Rgb) {
        let alive = self.weights.cmpge(DVec3::splat(VANISHING));
        let keep = |v: DVec3| DVec3::select(alive, v, DVec3::ZERO).as_vec3();
        (keep(self.factor), keep(self.weights))
    }
}
