//! A cheap look through the camera before learning: where paths go at all.
//!
//! Photons land everywhere. Where no camera path will ever come, what they teach is of no use, and
//! the trees need not grow there.

use super::camera_paths::training_samples;
use crate::guide::SurfacePoint;
use crate::integrate::context::View;
use crate::photon::schedule::Budget;

/// Camera paths of the look: some ten thousand vertices.
const PATHS: u64 = 1 << 14;
/// A small image is worth fewer: one for so many of its samples, but no fewer than these.
const SAMPLES_A_PATH: u64 = 256;
const FEWEST: u64 = 1 << 10;
/// Vertices that a cell holds on average when the look can tell it from its neighbours.
pub const PER_CELL: usize = 16;
/// Edges of a path that is looked at, at most: longer ones have no light left, or no end.
pub(super) const FAR: u32 = 128;
/// Sets the numbers of these paths apart from those that teach.
const LOOK: u64 = 0x2545_f491_4f6c_dd1d;

/// What a look through the camera has met.
#[derive(Clone, Debug, Default)]
pub struct Look {
    /// Where paths scatter.
    pub points: Vec<SurfacePoint>,
    /// How many paths there were.
    pub paths: u64,
}

impl Look {
    /// Vertices of a path where a field could be asked.
    pub fn vertices_a_path(&self) -> f64 {
        self.points.len() as f64 / self.paths.max(1) as f64
    }
}

/// Where unguided paths of the view scatter, on the sides that light reaches them from: as many as
/// a render of this budget is worth.
pub fn look(view: &View, budget: Budget) -> Look {
    let paths = match budget {
        Budget::AsNeeded { samples, .. } => (samples / SAMPLES_A_PATH).clamp(FEWEST, PATHS),
        Budget::Exactly { .. } => PATHS,
    };
    Look {
        points: met_by(view, paths),
        paths,
    }
}

/// The same by a number of paths.
pub fn met_by(view: &View, paths: u64) -> Vec<SurfacePoint> {
    let mut settings = view.settings.clone();
    settings.seed ^= LOOK;
    settings.max_depth = settings.max_depth.min(FAR);
    let view = View {
        settings: &settings,
        ..*view
    };
    let waves = training_samples(&view, None, 0..paths, &|| false);
    let waves = waves.into_iter().flatten();
    waves
        .flat_map(|wave| wave.samples)
        .map(|s| SurfacePoint {
            position: s.position,
            normal: s.normal,
        })
        .collect()
}
