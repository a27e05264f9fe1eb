//! Emitters: what shines, how it is sampled from a point (next-event estimation) and how photons leave it.

use crate::accel::{Bounds, Shape};
use crate::math::{Affine3A, Rgb, Vec2, Vec3};
use crate::texture::{SurfacePoint, Texture};
use std::sync::Arc;

/// Index of an emitter in [`Lights`].
pub type EmitterId = u32;

/// A direction towards light, sampled from a point.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit direction from the point to the light.
    pub dir: Vec3,
    /// Distance to the sampled light point; infinite for environments and directional lights.
    pub distance: f32,
    /// Incident radiance along `dir` if nothing is in between. For delta lights the incident
    /// irradiance on a surface facing them (intensity over squared distance).
    pub radiance: Rgb,
    /// Density in solid angle, including the probability of choosing this emitter; for delta lights
    /// that probability alone.
    pub pdf: f32,
    /// The light has no extent (point, spot, directional): no BSDF sample can meet it.
    pub delta: bool,
}

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

/// An emitter as a scene file describes it. Positions and directions are in world space.
#[derive(Clone, Debug)]
pub enum Emitter {
    /// A shape that glows on the side of its normal.
    Area {
        /// Index into the shapes given to [`Lights::build`].
        shape: u32,
        /// Emitted radiance.
        radiance: Texture,
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
        /// Half-angle where it begins to fall off (linearly in the angle), degrees.
        beam_degrees: f32,
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
        /// The file (read through [`crate::image`]).
        path: std::path::PathBuf,
        /// Factor on the values.
        scale: f32,
        /// Local to world; local +y is up, the image's centre is at local +z (Mitsuba's convention).
        to_world: Affine3A,
        /// Exponent that overrides the file's own curve.
        gamma: Option<f32>,
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
    /// A slide projector.
    Projector {
        /// Local to world: projects along local +z.
        to_world: Affine3A,
        /// The slide.
        irradiance: Texture,
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
    /// The normal is turned around.
    pub flip_normals: bool,
}

/// All emitters of a scene, ready to sample.
#[derive(Debug)]
pub struct Lights {}

/// A photon at the moment it leaves its light.
#[derive(Clone, Copy, Debug)]
pub struct Emission {
    /// Where it starts.
    pub org: Vec3,
    /// Unit direction it travels in.
    pub dir: Vec3,
    /// Unit normal of the emitting surface; zero for emitters without one.
    pub ng: Vec3,
    /// Power it carries: the emitter's radiance times cosine over the density of (emitter, position, direction).
    pub power: Rgb,
    /// Which emitter.
    pub emitter: EmitterId,
}

impl Lights {
    /// Prepares emitters for sampling. `shapes` are the glowing shapes in the order [`Emitter::Area`]
    /// numbers them; `bounds` holds the whole scene.
    pub fn build(
        emitters: Vec<Emitter>,
        shapes: &[EmitterShape],
        bounds: Bounds,
    ) -> Result<Self, crate::image::ImageError> {
        let _ = (emitters, shapes, bounds);
        unimplemented!()
    }

    /// Samples a direction towards light from the point `p`. `n` is the surface normal there (zero
    /// where light from all sides counts). `u[0]` chooses the emitter, `u[1..3]` a point on it.
    /// `None` where no light can arrive.
    pub fn sample(&self, p: Vec3, n: Vec3, u: [f32; 3]) -> Option<LightSample> {
        let _ = (p, n, u);
        unimplemented!()
    }

    /// Density (solid angle, selection included) with which [`Lights::sample`] at `p`, `n` draws the
    /// direction to the point `q` of triangle `prim` of area emitter `emitter`; `ng` is the unit geometric normal at `q`.
    pub fn pdf_area(
        &self,
        p: Vec3,
        n: Vec3,
        emitter: EmitterId,
        prim: u32,
        q: Vec3,
        ng: Vec3,
    ) -> f32 {
        let _ = (p, n, emitter, prim, q, ng);
        unimplemented!()
    }

    /// Density (solid angle, selection included) with which [`Lights::sample`] at `p`, `n` draws `dir`
    /// from environments (maps, skies, suns, constants) together.
    pub fn pdf_environment(&self, p: Vec3, n: Vec3, dir: Vec3) -> f32 {
        let _ = (p, n, dir);
        unimplemented!()
    }

    /// Radiance that area emitter `emitter` sends from `point` along `wo` (unit, away from the surface); 0 from its dark side.
    pub fn emitted(&self, emitter: EmitterId, point: &SurfacePoint, wo: Vec3) -> Rgb {
        let _ = (emitter, point, wo);
        unimplemented!()
    }

    /// Radiance arriving from outside the scene along the ray direction `dir` (the sum over environments).
    pub fn environment(&self, dir: Vec3) -> Rgb {
        let _ = dir;
        unimplemented!()
    }

    /// Whether any light comes from outside the scene in a way that a ray can meet.
    pub fn has_environment(&self) -> bool {
        unimplemented!()
    }

    /// Starts a photon: chooses an emitter by power, a position and a direction. `None` if nothing shines.
    pub fn emit(&self, u: [f32; 5]) -> Option<Emission> {
        let _ = u;
        unimplemented!()
    }

    /// How many emitters there are (a mesh that glows counts once).
    pub fn len(&self) -> usize {
        unimplemented!()
    }

    /// Whether nothing shines.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
