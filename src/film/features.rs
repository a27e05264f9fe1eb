//! What a denoiser is told of a pixel besides its colour: albedo and normal of the surface that is
//! seen there, be it behind mirrors and glass.

use crate::math::{Rgb, Vec3};

/// What one sample has seen. A path that is split sees in several places: then it is their sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// Reflectance of the first rough surface, times those of the mirrors and glass before it.
    pub albedo: Rgb,
    /// Its normal, world space, bump and normal maps included, times `weight`.
    pub normal: Vec3,
    /// How much of the path has come there: 1 where no mirror or glass is in between.
    pub weight: f32,
}

impl Features {
    /// Of a sample that has seen nothing: black mirrors, paths that are cut off behind glass.
    pub const NONE: Self = Self {
        albedo: Rgb::ZERO,
        normal: Vec3::ZERO,
        weight: 0.0,
    };

    /// Adds what another branch of the path has seen.
    pub fn add(&mut self, other: &Self) {
        self.albedo += other.albedo;
        self.normal += other.normal;
        self.weight += other.weight;
    }

    /// Whether all numbers are.
    #[inline]
    pub fn is_finite(&self) -> bool {
        self.albedo.is_finite() & self.normal.is_finite() & self.weight.is_finite()
    }
}

/// Sums over the samples of a pixel of what [`Features`] are more than albedo and normal of the
/// first surface and a weight of 1, which is what most samples have.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FeatureSums {
    /// Of reflectances.
    pub albedo: [f64; 3],
    /// Of normals.
    pub normal: [f64; 3],
    /// Of weights.
    pub weight: f64,
}

impl FeatureSums {
    /// Of samples that meet rough surfaces alone.
    pub const EMPTY: Self = Self {
        albedo: [0.0; 3],
        normal: [0.0; 3],
        weight: 0.0,
    };

    /// Adds those of a sample whose first surface has this albedo and this normal.
    pub fn add(&mut self, features: &Features, albedo: Rgb, normal: Vec3) {
        for c in 0..3 {
            self.albedo[c] += f64::from(features.albedo[c]) - f64::from(albedo[c]);
            self.normal[c] += f64::from(features.normal[c]) - f64::from(normal[c]);
        }
        self.weight += f64::from(features.weight) - 1.0;
    }
}
