//! A cheap look through the camera before learning: where paths go at all.
//!
//! Photons land everywhere. Where no camera path will ever come, what they teach is of no use, and the
//! trees need not grow there.

use super::learn::lessons;
use super::render::View;
use crate::guide::SurfacePoint;

/// Camera paths of the look: some ten thousand vertices.
const PATHS: u64 = 1 << 14;
/// Vertices that a cell holds on average when the look can tell it from its neighbours.
pub const PER_CELL: usize = 16;
/// Edges of a path that is looked at, at most: longer ones have no light left, or no end.
const FAR: u32 = 128;
/// Sets the numbers of these paths apart from those that teach.
const LOOK: u64 = 0x2545_f491_4f6c_dd1d;

/// Where unguided paths of the view scatter, on the sides that light reaches them from.
pub fn met_by_camera(view: &View) -> Vec<SurfacePoint> {
    met_by(view, PATHS)
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
    let waves = lessons(&view, None, 0..paths).into_iter();
    waves
        .flat_map(|wave| wave.samples)
        .map(|s| SurfacePoint {
            position: s.position,
            normal: s.normal,
        })
        .collect()
}
