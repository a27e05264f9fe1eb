//! The state of a path, and what a sample meets first.

use crate::camera::CameraRay;
use crate::film::Features;
use crate::math::{PathSampler, Rgb, Vec3};

/// No cell of a field.
pub const NO_CELL: u32 = u32::MAX;

/// What a path carries from one vertex to the next.
#[derive(Clone, Copy, Debug)]
pub struct Path {
    /// Product of BSDF weights so far.
    pub throughput: Rgb,
    /// Density with which the last direction was drawn, solid angle; infinite after a delta lobe
    /// and at the camera.
    pub pdf: f32,
    /// The vertex the ray left.
    pub from: Vec3,
    /// The normal that light sampling was given there (zero: light from all sides).
    pub from_normal: Vec3,
    /// The probability with which a light was sampled there: 1 unless a field chose it.
    pub light_probability: f32,
    /// The field's cell there, by which the light was chosen; [`NO_CELL`] if it was not.
    pub light_cell: u32,
    /// Product of relative indices of refraction.
    pub eta: f32,
    /// Edges so far.
    pub depth: u32,
    /// Index of its accumulator among the wave's accumulators: its sample's, or one of its own once
    /// the path was split.
    pub accumulator: u32,
    /// Width of the ray's cone at its origin.
    pub cone_width: f32,
    /// Growth of that width per unit distance.
    pub cone_spread: f32,
    /// Numbers to come.
    pub sampler: PathSampler,
}

impl Path {
    /// A path that begins at the camera.
    #[inline]
    pub fn new(camera: &CameraRay, sampler: PathSampler, accumulator: u32) -> Self {
        let throughput = if camera.sees { Rgb::ONE } else { Rgb::ZERO };
        Self {
            throughput,
            pdf: f32::INFINITY,
            from: camera.ray.org,
            from_normal: Vec3::ZERO,
            light_probability: 1.0,
            light_cell: NO_CELL,
            eta: 1.0,
            depth: 0,
            accumulator,
            cone_width: camera.cone_width,
            cone_spread: camera.cone_spread,
            sampler,
        }
    }
}

impl AsRef<Path> for Path {
    #[inline]
    fn as_ref(&self) -> &Path {
        self
    }
}

impl AsMut<Path> for Path {
    #[inline]
    fn as_mut(&mut self) -> &mut Path {
        self
    }
}

/// What the camera sees first along a sample, and behind mirrors and glass: for the AOVs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstHit {
    /// Reflectance.
    pub albedo: Rgb,
    /// Shading normal, world space.
    pub normal: Vec3,
    /// Distance; 0 where nothing was met.
    pub depth: f32,
    /// What a denoiser is told, if that is more than albedo and normal.
    pub features: Option<Features>,
    /// A plain path meets nothing but mirrors and glass on so many edges, at most.
    pub specular_edges: u32,
}

impl FirstHit {
    /// Of a sample that meets nothing.
    pub const NOTHING: Self = Self {
        albedo: Rgb::ZERO,
        normal: Vec3::ZERO,
        depth: 0.0,
        features: Some(Features {
            albedo: Rgb::ONE,
            normal: Vec3::ZERO,
            weight: 1.0,
        }),
        specular_edges: 0,
    };
}

/// What a path was when it came to a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// Its throughput.
    pub throughput: Rgb,
    /// What its sample had come to, the vertex's own emission included.
    pub radiance: Rgb,
}
