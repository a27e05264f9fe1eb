//! A medium that is the same everywhere.

use super::{ChannelWeights, Flight, Segment};
use crate::math::Rgb;

/// Extinction that is the same everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homogeneous {
    /// Extinction coefficient sigma_t, per unit length, at least 0.
    pub extinction: Rgb,
    /// Share of that which scatters, 0 to 1.
    pub albedo: Rgb,
}

/// The darkest colour that light can be left in: the logarithm of 0 is infinite.
const DARKEST: f32 = 1e-6;

impl Homogeneous {
    /// What absorbs white light so that `color`, each channel 0 to 1, is left after a distance.
    pub fn absorbing(color: Rgb, distance: f32) -> Self {
        let color = color.clamp(Rgb::splat(DARKEST), Rgb::ONE);
        Self {
            // Not -0 for 1.
            extinction: color.map(|c| (-c.ln() / distance).max(0.0)),
            albedo: Rgb::ZERO,
        }
    }

    /// Transmittance exp(-sigma_t s) of a distance (Beer's law).
    #[inline]
    pub fn transmittance(&self, distance: f32) -> Rgb {
        self.extinction.map(|sigma| match sigma > 0.0 {
            true => (-sigma * distance).exp(),
            // Of an infinite distance, too.
            false => 1.0,
        })
    }

    /// Draws a collision with density sigma_t exp(-sigma_t s) of one channel. Where nothing
    /// scatters there is none, and the transmittance is exact.
    #[inline]
    pub fn sample(
        &self,
        segment: &Segment,
        weights: &mut ChannelWeights,
        u: &mut impl FnMut() -> f32,
    ) -> Flight {
        if self.albedo == Rgb::ZERO {
            return Flight {
                factor: self.transmittance(segment.length),
                collision: None,
            };
        }
        let channel = weights.channel(u());
        let distance = -(-u()).ln_1p() / self.extinction[channel];
        // A channel without extinction gives infinity, or no number: both come through.
        let collides = distance < segment.length;
        if !collides {
            let passed = self.transmittance(segment.length);
            return Flight {
                factor: weights.update(passed, passed),
                collision: None,
            };
        }
        let density = self.extinction * self.transmittance(distance);
        Flight {
            factor: weights.update(density * self.albedo, density),
            collision: Some(distance),
        }
    }
}
