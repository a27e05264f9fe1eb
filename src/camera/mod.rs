//! Cameras: from a place on the film and a place on the lens to a ray.

use crate::accel::Ray;
use crate::math::{DAffine3, Vec2};

/// Which extent of the film a field of view spans.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum FovAxis {
    /// Width.
    #[default]
    X,
    /// Height.
    Y,
    /// The diagonal.
    Diagonal,
    /// The shorter side.
    Smaller,
    /// The longer side.
    Larger,
}

/// How rays leave the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Pinhole.
    Perspective {
        /// Full field of view, degrees.
        fov_degrees: f64,
        /// What it spans.
        fov_axis: FovAxis,
        /// Shift of the image in units of its width and height (Mitsuba 3 `principal_point_offset_*`).
        principal_point: [f64; 2],
    },
    /// A thin lens.
    ThinLens {
        /// Full field of view, degrees.
        fov_degrees: f64,
        /// What it spans.
        fov_axis: FovAxis,
        /// Shift of the image in units of its width and height.
        principal_point: [f64; 2],
        /// Radius of the lens, world units.
        aperture_radius: f64,
        /// Distance to the plane in focus along the axis.
        focus_distance: f64,
    },
    /// Parallel rays; the film spans `[-1, 1]` in camera x.
    Orthographic,
}

/// A camera as a scene describes it. Camera space: looks along +z, +y is up, +x is *left* (Mitsuba's convention).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDescription {
    /// Camera space to world space.
    pub to_world: DAffine3,
    /// Projection.
    pub projection: Projection,
    /// Nothing closer along the axis is seen.
    pub near_clip: f64,
    /// Nothing farther along the axis is seen.
    pub far_clip: f64,
}

/// A camera for a film of a certain size.
#[derive(Clone, Copy, Debug)]
pub struct Camera {}

/// A ray from the camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// The ray.
    pub ray: Ray,
    /// Width of a pixel's cone at the origin (world units).
    pub cone_width: f32,
    /// Growth of that width per unit distance.
    pub cone_spread: f32,
}

impl Camera {
    /// Prepares a camera for a film `width` by `height` pixels.
    pub fn new(description: &CameraDescription, width: u32, height: u32) -> Self {
        let _ = (description, width, height);
        unimplemented!()
    }

    /// The ray through `film` (pixels from the upper left corner of the full film) and `lens` (unit square).
    pub fn ray(&self, film: Vec2, lens: Vec2) -> CameraRay {
        let _ = (film, lens);
        unimplemented!()
    }
}
