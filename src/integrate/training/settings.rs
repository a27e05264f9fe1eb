//! How a field is learned.

use crate::guide::ModelKind;
use crate::photon::PhotonSettings;
use crate::photon::schedule::Budget;

/// How a field is learned.
#[derive(Clone, Debug, PartialEq)]
pub struct LearnSettings {
    /// Photon paths; none of them learns from camera paths alone.
    pub photons: Budget,
    /// Camera paths in all; 0 learns from photons alone.
    pub paths: u64,
    /// Batches that paths come in, where they are not those of an image; each is twice as large as
    /// the one before.
    pub batches: u32,
    /// Most bytes that learning holds: the trees while they are trained, and the records that they
    /// learn from.
    pub memory: u64,
    /// How photons are traced.
    pub photon: PhotonSettings,
    /// The model on each link.
    pub model: ModelKind,
    /// Share of the directions that are drawn from the field everywhere; `None` learns it.
    pub mixture: Option<f32>,
    /// Whether guiding may turn out not to pay, and end.
    pub trial: bool,
}
