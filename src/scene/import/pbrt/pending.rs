//! What waits for the end of the import: shapes whose meshes are not made yet.

use crate::bsdf::MaterialId;
use crate::math::DAffine3;
use crate::medium::Boundary;
use crate::scene::Geometry;
use crate::scene::import::faults::At;
use crate::scene::import::mesh::MeshOptions;
use crate::texture::Texture;
use std::path::PathBuf;

/// A shape whose mesh may not have been made yet.
pub(super) struct PendingShape<'s> {
    pub name: String,
    pub at: At,
    pub geometry: PendingGeometry<'s>,
    pub material: MaterialId,
    pub glow: Option<Glow>,
    pub flip_normals: bool,
    pub group: Option<u32>,
    pub boundary: Option<Boundary>,
}

/// Light that a shape emits.
#[derive(Clone, Debug)]
pub(super) struct Glow {
    /// Radiance; where there is a power, its colour.
    pub radiance: Texture,
    pub both_sides: bool,
    /// Power of each triangle, or of the whole of an exact shape, in units of the radiance.
    pub power: Option<f32>,
}

/// What a pending shape is made of.
pub(super) enum PendingGeometry<'s> {
    Ready(Geometry),
    File(Request),
    Inline(Inline<'s>),
}

/// A mesh file that a shape asks for.
#[derive(Clone, Debug)]
pub(super) struct Request {
    pub path: PathBuf,
    pub options: MeshOptions,
}

impl Request {
    /// What two requests share when they are for the same mesh.
    pub fn key(&self) -> (PathBuf, String) {
        // `f64` in the options has no `Hash`; its shortest text that reads back the same stands for
        // it.
        (self.path.clone(), format!("{:?}", self.options))
    }
}

/// A mesh that stands in the scene file.
#[derive(Debug)]
pub(super) struct Inline<'s> {
    pub to_world: DAffine3,
    pub reverse: bool,
    pub kind: InlineKind<'s>,
}

/// What kind of mesh.
#[derive(Debug)]
pub(super) enum InlineKind<'s> {
    /// `trianglemesh`.
    Triangles(Vertices<'s>),
    /// The same, each triangle with pbrt's texture coordinates of its own.
    Separate(Vertices<'s>),
    /// `bilinearmesh`.
    Patches(Vertices<'s>),
    /// `loopsubdiv`, with its levels.
    Subdivision(Vertices<'s>, u32),
    /// One or more `curve`s.
    Curves(Vec<Curve<'s>>),
    /// A part of a round shape.
    Round(Round),
}

/// Numbers of vertices as they stand in the file.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Vertices<'s> {
    pub indices: &'s [i32],
    pub positions: &'s [f32],
    pub normals: Option<&'s [f32]>,
    pub tangents: Option<&'s [f32]>,
    pub uvs: Option<&'s [f32]>,
}

/// A curve.
#[derive(Clone, Copy, Debug)]
pub(super) struct Curve<'s> {
    pub points: &'s [f32],
    pub degree: usize,
    pub is_spline: bool,
    pub widths: [f32; 2],
    /// Normals at the ends of segments: a ribbon.
    pub normals: Option<&'s [f32]>,
}

/// A surface of revolution around z, or a part of one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub kind: RoundKind,
    /// Angle around z that it spans, radians.
    pub phi: f64,
}

/// What is turned around z.
#[derive(Clone, Copy, Debug)]
pub(super) enum RoundKind {
    Sphere { radius: f64, z: [f64; 2] },
    Cylinder { radius: f64, z: [f64; 2] },
    Disk { height: f64, radii: [f64; 2] },
    Cone { radius: f64, height: f64 },
    Paraboloid { radius: f64, z: [f64; 2] },
}
