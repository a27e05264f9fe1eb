//! Emitters as a scene file describes them.

use super::EnvironmentImage;
use crate::accel::Shape;
use crate::math::{Affine3A, Rgb, Vec2, Vec3};
use crate::texture::{MeshAttributes, Texture};
use std::sync::Arc;

/// How a sky or sun is described: Mitsuba's `sun`, `sky` and `sunsky`.
#[derive(Clone, Debug, PartialEq)]
pub struct SunSky {
    /// Include the sky dome.
    pub sky: bool,
    /// Include the sun.
    pub sun: bool,
    /// Unit direction towards the sun in the emitter's own coordinates.
    pub sun_direction: Vec3,
    /// Atmospheric turbidity, 1 to 10.
    pub turbidity: f32,
    /// Albedo of the ground.
    pub albedo: Rgb,
    /// Factor on the sky's radiance.
    pub sky_scale: f32,
    /// Factor on the sun's radiance.
    pub sun_scale: f32,
    /// Angular radius of the sun's disk in degrees (`sunRadiusScale` / `sun_aperture` applied).
    pub sun_radius_degrees: f32,
    /// Extend the horizon below (Mitsuba 0.x `stretch`), 1 to 2.
    pub stretch: f32,
    /// Which program's conventions: +Y is up in Mitsuba 0.x, +Z in Mitsuba 3.
    pub z_up: bool,
}

/// How a spot light fades from its beam to its cutoff.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Falloff {
    /// Linearly in the angle (Mitsuba).
    #[default]
    Linear,
    /// Along 3 t^2 - 2 t^3 in the cosine of the angle (pbrt).
    Smooth,
}

/// What the values of a projector's slide are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Slide {
    /// Irradiance over pi on the plane one unit away (Mitsuba).
    #[default]
    Irradiance,
    /// Power per solid angle (pbrt).
    Intensity,
}

/// An emitter as a scene file describes it. Positions and directions are in world space.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A shape that glows.
    Area {
        /// Index into the shapes given to [`super::Lights::build`].
        shape: u32,
        /// Emitted radiance.
        radiance: Texture,
        /// Glows on both sides, not on that of its normal alone.
        both_sides: bool,
    },
    /// A point.
    Point {
        /// Where.
        position: Vec3,
        /// Power per solid angle.
        intensity: Rgb,
    },
    /// A point with a cone.
    Spot {
        /// Local to world: shines along local +z.
        to_world: Affine3A,
        /// Power per solid angle on the axis.
        intensity: Rgb,
        /// Half-angle where the light ends, degrees.
        cutoff_degrees: f32,
        /// Half-angle where it begins to fall off, degrees.
        beam_degrees: f32,
        /// How it falls off.
        falloff: Falloff,
        /// Image projected through the cone.
        texture: Option<Texture>,
    },
    /// Parallel light from far away.
    Directional {
        /// Unit direction the light travels in.
        direction: Vec3,
        /// Irradiance on a surface facing it.
        irradiance: Rgb,
    },
    /// The same radiance from everywhere around.
    Constant {
        /// Radiance.
        radiance: Rgb,
    },
    /// A latitude-longitude image around the scene.
    EnvironmentMap {
        /// The image.
        image: Arc<EnvironmentImage>,
        /// Factor on the values.
        scale: f32,
        /// Local to world; local +y is up, the image's centre is at local +z (Mitsuba's
        /// convention).
        to_world: Affine3A,
    },
    /// A sky after Hosek and Wilkie, with or without a sun.
    SunSky {
        /// Parameters.
        settings: SunSky,
        /// Factor `scale` on both.
        scale: f32,
        /// Emitter's coordinates to world.
        to_world: Affine3A,
    },
    /// A point whose intensity follows an image over directions.
    Goniometric {
        /// Local to world; the light stands at the origin. The image's directions are those of
        /// [`Emitter::EnvironmentMap`], seen from the light.
        to_world: Affine3A,
        /// The image.
        image: Arc<EnvironmentImage>,
        /// Power per solid angle where the image is 1.
        intensity: Rgb,
    },
    /// A slide projector.
    Projector {
        /// Local to world: projects along local +z.
        to_world: Affine3A,
        /// The slide.
        slide: Texture,
        /// What its values are.
        values: Slide,
        /// Factor.
        scale: f32,
        /// Full horizontal field of view, degrees.
        fov_degrees: f32,
        /// Slide width over height.
        aspect: f32,
    },
}

/// The geometry of a shape that glows.
#[derive(Clone, Debug)]
pub struct EmitterShape {
    /// Triangles or an exact shape, in world space.
    pub shape: Shape,
    /// Texture coordinates of a mesh's vertices, if it has any.
    pub uvs: Option<Arc<Vec<Vec2>>>,
    /// Attributes of the mesh, for a radiance that comes from them.
    pub attributes: Option<Arc<MeshAttributes>>,
    /// The normal is turned around.
    pub flip_normals: bool,
}
