//! What a caller decides about a field, and the errors the module reports.

use super::model::ModelKind;
use crate::math::Vec3;
use serde::{Deserialize, Serialize};

/// The quantity a field is trained towards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Target {
    /// Incident radiance times cosine: what a diffuse surface of the cell's own orientation wants.
    #[default]
    Flux,
    /// Incident radiance: the cosine of the shading normal is then applied when sampling.
    Radiance,
}

/// Which records carry a field's estimates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// Photons from the lights: flux over surface area.
    #[default]
    Photons,
    /// Camera paths: the mean of radiance estimates over the vertices in a cell.
    Paths,
    /// Both: their mean where a cell has enough path vertices, else photons.
    Both,
}

/// How the shading normal shapes sampling when the caller passes one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Product {
    /// The normal is ignored.
    None,
    /// Base direction cells below the horizon are left out, those whose centre lies below damped.
    Horizon,
    /// Direction cells are weighted by their mean cosine.
    Cosine,
}

/// Everything that shapes a field. [`Settings::new`] gives the defaults for given bounds.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Lower corner of the scene.
    #[serde(with = "corner")]
    pub min: Vec3,
    /// Upper corner of the scene.
    #[serde(with = "corner")]
    pub max: Vec3,
    /// Bytes that the trainer may hold in nodes, links and accumulators. Default 256 MiB.
    pub memory: u64,
    /// Deepest level of R in space, 0 to 20; lowered so that a cell keeps 64 ulp of its
    /// coordinates.
    pub max_space_level: u8,
    /// Deepest level of Q, 0 to 10 (a cell of level 10 covers 1.2e-5 sr).
    pub max_direction_level: u8,
    /// A link is split only when this many photons (effective count) have landed in it since it was
    /// made. Default 8: significance is what guards against noise.
    pub min_photons: u32,
    /// R is split only where this many surface points lie inside the cell, so that areas are known.
    pub min_points: u32,
    /// How many standard deviations of chance a gain must exceed to count as significant. Default
    /// 5.
    pub significance: f32,
    /// Prior strength, in photons, that pulls siblings towards their common density when freezing.
    pub smoothing: f32,
    /// Share of the uniform distribution in every sample, (0, 1]. Default 1 %.
    pub defensive: f32,
    /// Records heavier than this many units (typical records) count as this many. Default 1e6.
    pub clamp: f32,
    /// The estimated quantity.
    pub target: Target,
    /// Which records are used.
    pub source: Source,
    /// What the normal does when sampling.
    pub product: Product,
    /// The model on each link.
    pub model: ModelKind,
    /// Split R by the octant of the surface normal before space.
    pub normal_split: bool,
    /// Records may lie in media: these get a cell of their own beside six for normals. Only with
    /// [`Settings::normal_split`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub media: bool,
    /// Seed of whoever makes the records; kept in the file, shards of one field share it.
    pub seed: u64,
    /// Identity of the scene; files of another scene are refused on merge.
    pub scene_hash: u64,
}

/// Vectors as three numbers.
mod corner {
    use super::Vec3;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(v: &Vec3, s: S) -> Result<S::Ok, S::Error> {
        v.to_array().serialize(s)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(d: D) -> Result<Vec3, D::Error> {
        <[f32; 3]>::deserialize(d).map(Vec3::from_array)
    }
}

impl Settings {
    /// Defaults for a scene inside the box `min`..`max`.
    pub fn new(min: Vec3, max: Vec3) -> Self {
        Self {
            min,
            max,
            memory: 256 << 20,
            max_space_level: 20,
            max_direction_level: 10,
            min_photons: 8,
            min_points: 8,
            significance: 5.0,
            smoothing: 1.0,
            defensive: 0.01,
            clamp: 1e6,
            target: Target::Flux,
            source: Source::Photons,
            product: Product::Horizon,
            model: ModelKind::default(),
            normal_split: false,
            media: false,
            seed: 0,
            scene_hash: 0,
        }
    }

    /// Checks every value against its range.
    ///
    /// # Errors
    /// Names the first value that is out of range and what it may be.
    pub fn validate(&self) -> Result<(), GuideError> {
        let fail = |what: &str| Err(GuideError::Settings(what.to_owned()));
        if !(self.min.is_finite() && self.max.is_finite() && self.min.cmple(self.max).all()) {
            return fail("bounds must be finite with min <= max");
        }
        if !(self.max.as_dvec3() - self.min.as_dvec3())
            .max_element()
            .lt(&3e38)
        {
            return fail("bounds must span less than 3e38");
        }
        if self.max_space_level > 20 || self.max_direction_level > 10 {
            return fail("max_space_level is at most 20, max_direction_level at most 10");
        }
        if self.media && !self.normal_split {
            return fail("a field of media must be split by normals");
        }
        if !(self.defensive > 0.0 && self.defensive <= 1.0) {
            return fail("defensive must lie in (0, 1]");
        }
        if !(self.clamp > 0.0 && self.clamp.is_finite()) {
            return fail("clamp must be positive and finite");
        }
        if !(self.smoothing >= 0.0 && self.smoothing.is_finite()) {
            return fail("smoothing must be finite and not negative");
        }
        if !(self.significance >= 0.0 && self.significance.is_finite()) {
            return fail("significance must be finite and not negative");
        }
        Ok(())
    }
}

/// What can go wrong; sampling and training cannot.
#[derive(Debug, thiserror::Error)]
pub enum GuideError {
    /// A setting is out of range.
    #[error("guide settings: {0}")]
    Settings(String),
    /// A field file is damaged, foreign or of another version.
    #[error("field file: {0}")]
    File(String),
    /// Two fields cannot be added.
    #[error("cannot add the fields: {0}; train both from copies of one refined field")]
    Merge(String),
    /// Two fields have learned from records that must not be added.
    #[error("cannot add the fields: {0}")]
    Records(String),
    /// A field does not belong to what it is used with.
    #[error("{0}")]
    Foreign(String),
    /// The file could not be read or written.
    #[error("field file {path}: {source}")]
    Io {
        /// Which file.
        path: std::path::PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
}
