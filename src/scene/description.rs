//! A scene as data: what an importer produces and the renderer consumes.

use crate::accel::{AnalyticShape, TriangleMesh};
use crate::bsdf::{MaterialId, Materials};
use crate::camera::CameraDescription;
use crate::film::FilmDescription;
use crate::light::Emitter;
use crate::math::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use crate::medium::{Boundary, Media, MediumId};
use crate::texture::MeshAttributes;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A triangle mesh with everything that belongs to its vertices.
#[derive(Debug, Default)]
pub struct Mesh {
    /// Positions and indices, shared with the ray tracer. World (or group) space.
    pub triangles: Arc<TriangleMesh>,
    /// Unit shading normals, one for each vertex; `None` for flat shading.
    pub normals: Option<Vec<Vec3>>,
    /// Tangents that a file gives, one for each vertex, instead of those that follow from texture
    /// coordinates: unit directions along u, and 1, or -1 where the texture is laid on back to
    /// front.
    pub tangents: Option<Vec<Vec4>>,
    /// Texture coordinates, one for each vertex.
    pub uvs: Option<Arc<Vec<Vec2>>>,
    /// Named values.
    pub attributes: MeshAttributes,
}

/// What a shape is made of.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// Triangles.
    Mesh(Arc<Mesh>),
    /// An exact shape.
    Analytic(AnalyticShape),
}

/// A shape with its material.
#[derive(Clone, Debug)]
pub struct Shape {
    /// For messages: the scene's id, or the mesh's file name, or the plugin's name.
    pub name: String,
    /// What it is made of.
    pub geometry: Geometry,
    /// Its material.
    pub material: MaterialId,
    /// Index into [`Description::emitters`] of the [`Emitter::Area`] it carries.
    pub emitter: Option<u32>,
    /// Turn normals around. Meshes are turned by their loader; this is for exact shapes.
    pub flip_normals: bool,
    /// Group it belongs to; `None` stands in the world.
    pub group: Option<u32>,
    /// The media on its sides; `None` where it divides nothing: both sides are as around it.
    pub boundary: Option<Boundary>,
}

/// Which numbers drive the samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplerKind {
    /// Independent random numbers.
    #[default]
    Independent,
    /// Owen-scrambled Sobol points.
    Sobol,
}

/// What a scene says about how to render it. Everything here can be overridden on the command line.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDescription {
    /// Path edges seen from the camera, Mitsuba's meaning: 1 is emission only, 2 adds direct light;
    /// `None` is unlimited.
    pub max_depth: Option<u32>,
    /// Russian roulette starts at this depth (Mitsuba's `rr_depth`).
    pub rr_depth: u32,
    /// Emitters are not seen by the camera itself.
    pub hide_emitters: bool,
    /// The film has an alpha channel, which is of use where emitters are hidden.
    pub alpha: bool,
    /// Light that crosses a surface only by its shading normal is dropped.
    pub strict_normals: bool,
    /// Samples a pixel.
    pub spp: u32,
    /// Sampler.
    pub sampler: SamplerKind,
}

impl Default for RenderDescription {
    fn default() -> Self {
        Self {
            max_depth: None,
            rr_depth: 5,
            hide_emitters: false,
            alpha: false,
            strict_normals: false,
            spp: 64,
            sampler: SamplerKind::Independent,
        }
    }
}

/// A whole scene as data. Copies share the meshes.
#[derive(Clone, Debug)]
pub struct Description {
    /// All shapes, of the world and of groups.
    pub shapes: Vec<Shape>,
    /// Number of groups.
    pub groups: u32,
    /// Where groups stand: group, group space to world space.
    pub instances: Vec<(u32, DAffine3)>,
    /// Materials.
    pub materials: Materials,
    /// Emitters. [`Emitter::Area::shape`] is an index into `shapes`.
    pub emitters: Vec<Emitter>,
    /// What the scene calls them, by number, those that it has a name for. An area emitter goes by
    /// its shape's name as well.
    pub emitter_names: BTreeMap<u32, String>,
    /// Media that shapes have on their sides.
    pub media: Media,
    /// The medium that the camera is in; `None` where the scene does not say: then boundaries
    /// around the camera do.
    pub camera_medium: Option<MediumId>,
    /// Camera.
    pub camera: CameraDescription,
    /// Film.
    pub film: FilmDescription,
    /// How to render.
    pub render: RenderDescription,
    /// The file's coordinates of what is the origin here: scenes far from theirs are moved.
    pub origin: DVec3,
    /// What was odd but not fatal, each with its place.
    pub warnings: Vec<String>,
}

#[cfg(test)]
impl Description {
    /// Nothing, seen by a plain camera: for tests that put something in.
    pub(crate) fn empty() -> Self {
        Self {
            shapes: Vec::new(),
            groups: 0,
            instances: Vec::new(),
            materials: Materials::default(),
            emitters: Vec::new(),
            emitter_names: BTreeMap::new(),
            media: Media::default(),
            camera_medium: None,
            camera: CameraDescription {
                to_world: DAffine3::IDENTITY,
                projection: crate::camera::Projection::Orthographic,
                near_clip: 1e-2,
                far_clip: 1e4,
            },
            film: FilmDescription {
                width: 4,
                height: 4,
                crop: None,
                filter: crate::film::filter::Filter::Box { radius: 0.5 },
                kind: crate::film::FilmKind::Hdr,
                exposure: 0.0,
                extras: Default::default(),
            },
            render: RenderDescription::default(),
            origin: DVec3::ZERO,
            warnings: Vec::new(),
        }
    }
}
