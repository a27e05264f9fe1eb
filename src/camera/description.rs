//! A camera as a scene describes it.

use crate::math::DAffine3;

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
        /// Shift of the image in units of its width and height (Mitsuba 3
        /// `principal_point_offset_*`).
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
    /// All directions, latitude by longitude, as in an environment map (Mitsuba 0.x `spherical`):
    /// +y of the camera is at the top, -z at the left and right edges.
    Spherical,
    /// A circle in which the distance from the middle is the angle to the axis (an equidistant
    /// fisheye). Outside of it the picture is black.
    Fisheye {
        /// Angle that the circle's diameter spans, degrees; up to 360.
        fov_degrees: f64,
        /// Which extent of the film that diameter is.
        fov_axis: FovAxis,
    },
}

/// A camera as a scene describes it. Camera space: looks along +z, +y is up, +x is *left*
/// (Mitsuba's convention).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraDescription {
    /// Camera space to world space.
    pub to_world: DAffine3,
    /// Projection.
    pub projection: Projection,
    /// Nothing closer is seen: along the axis, or along the ray where the film is one of angles.
    pub near_clip: f64,
    /// Nothing farther is seen, measured likewise.
    pub far_clip: f64,
}
