//! The layers of an EXR beside the picture, as they can be typed.

use crate::film::Layers;
use clap::ValueEnum;

/// A layer beside the picture.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Reflectance of the first rough surface, behind mirrors and glass: for denoisers
    Albedo,
    /// Its normal, world space
    Normal,
    /// Reflectance of the first surface
    #[value(name = "albedo.first")]
    FirstAlbedo,
    /// Its shading normal, world space
    #[value(name = "normal.first")]
    FirstNormal,
    /// Its distance
    Depth,
    /// Variance of each pixel's mean
    Variance,
    /// Noise like that of the picture, by which `compare` tells how wrong means over blocks may be
    Noise,
    /// Samples of each pixel
    Samples,
    /// Every layer
    All,
    /// The picture alone
    None,
}

/// The layers that were asked for.
pub fn layers(asked: &[Aov]) -> Layers {
    let has = |aov| asked.contains(&aov) || asked.contains(&Aov::All);
    Layers {
        albedo: has(Aov::Albedo),
        normal: has(Aov::Normal),
        first_albedo: has(Aov::FirstAlbedo),
        first_normal: has(Aov::FirstNormal),
        depth: has(Aov::Depth),
        variance: has(Aov::Variance),
        noise: has(Aov::Noise),
        samples: has(Aov::Samples),
    }
}
