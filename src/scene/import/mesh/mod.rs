//! Mesh files.

use super::ImportError;
use crate::math::DAffine3;
use crate::scene::Mesh;
use std::path::Path;

/// Which format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshKind {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY.
    Ply,
    /// Mitsuba's `serialized`.
    Serialized,
}

/// How to load a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// File coordinates to world (or group) coordinates.
    pub to_world: DAffine3,
    /// Drop vertex normals: flat shading.
    pub face_normals: bool,
    /// Turn normals around.
    pub flip_normals: bool,
    /// v becomes 1 - v.
    pub flip_tex_coords: bool,
    /// Split normals at edges sharper than this, degrees.
    pub max_smooth_angle: Option<f32>,
    /// Which mesh of a file that holds several.
    pub shape_index: usize,
}

/// Loads a mesh.
pub fn load(path: &Path, kind: MeshKind, options: &MeshOptions) -> Result<Mesh, ImportError> {
    let _ = options;
    Err(ImportError {
        at: None,
        file: Some(path.to_owned()),
        message: format!("cannot read {kind:?} meshes"),
        help: None,
    })
}
