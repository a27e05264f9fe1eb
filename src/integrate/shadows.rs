//! The shadow rays of one bounce of all paths of a wave.

use super::next_event::ShadowRay;
use crate::accel::Ray;
use crate::math::PathSampler;
use crate::medium::MediumId;

/// Shadow rays, and what they would bring.
#[derive(Default)]
pub(super) struct ShadowRays {
    pub rays: Vec<Ray>,
    pub offers: Vec<ShadowRay>,
    /// Where each begins, in scenes with media.
    pub media: Vec<ShadowMedium>,
}

impl ShadowRays {
    /// Forgets all.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.offers.clear();
        self.media.clear();
    }
}

/// A shadow ray's medium, and numbers for its transmittance.
#[derive(Clone, Copy)]
pub(super) struct ShadowMedium {
    pub medium: MediumId,
    pub sampler: PathSampler,
}
