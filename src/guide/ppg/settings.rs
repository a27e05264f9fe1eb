//! What shapes an SD-tree.

use crate::guide::GuideError;
use crate::math::Vec3;

/// What densities are in proportion to (see [`super`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Target {
    /// Incident radiance, as in 2017.
    Radiance,
    /// The root of the second moment of what is sent on, as in 2020.
    #[default]
    SecondMoment,
}

/// What shapes an SD-tree. [`Settings::new`] gives the defaults for given bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Lower corner of the scene.
    pub min: Vec3,
    /// Upper corner of the scene.
    pub max: Vec3,
    /// What densities are in proportion to.
    pub target: Target,
    /// Whether surfaces that face different ways have trees of their own.
    pub normals: bool,
    /// Records that divide a spatial leaf, in an iteration of 2^20.
    pub threshold: f64,
    /// Share of a leaf's energy that divides a cell of directions.
    pub share: f32,
    /// Most levels of a tree of directions.
    pub max_level: u32,
    /// Whether records are spread over neighbouring spatial leaves, by chance.
    pub spatial_filter: bool,
    /// Whether they are spread over neighbouring directions.
    pub directional_filter: bool,
    /// What the sums of earlier iterations count for in the next.
    pub kept: f32,
    /// Share of the uniform distribution in the density.
    pub defensive: f32,
    /// Bytes that the trees may take while they learn.
    pub memory: u64,
}

impl Settings {
    /// Defaults for a scene inside the box `min`..`max`.
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Self {
            min,
            max,
            target: Target::default(),
            normals: true,
            threshold: 2000.0,
            share: 0.02,
            max_level: 16,
            spatial_filter: false,
            directional_filter: true,
            kept: 0.5,
            defensive: 0.01,
            memory: 256 << 20,
        }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// Names the first value that is out of range and what it may be.
    pub fn validate(&self) -> Result<(), GuideError> {
        let finite = self.min.is_finite() && self.max.is_finite();
        let checks = [
            (
                finite && self.min.cmple(self.max).all(),
                "bounds must be finite with min <= max",
            ),
            (self.threshold > 0.0, "threshold must be above 0"),
            (
                self.share > 0.0 && self.share <= 1.0,
                "share must lie in (0, 1]",
            ),
            (
                (1..=20).contains(&self.max_level),
                "max_level must lie in 1..=20",
            ),
            ((0.0..=1.0).contains(&self.kept), "kept must lie in [0, 1]"),
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
}
