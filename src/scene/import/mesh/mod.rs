//! Triangle meshes from files: Wavefront OBJ, PLY, STL and Mitsuba's `serialized`.
//!
//! ```text
//!  file --mapped--> bytes --obj, ply, serialized--> Raw --clean--> Mesh
//! ```
//!
//! A reader (`obj`, `ply`, `stl`, `serialized`) only knows its format: it leaves a `Raw` mesh with
//! positions already in world space (transformed in `f64`, then rounded once) and indices that are
//! in range. `clean` makes of it what the renderer may rely on: finite positions, no triangle
//! without area, unit normals. What it repairs it counts in [`Loaded::warnings`].
//!
//! Which side is the front is decided here, once for all who ask (materials, lamps, photons, AOVs):
//! the geometric normal follows the order of a triangle's corners in the finished mesh. That order
//! is the file's, unless the file's own normals point to the other side: those win. A mirroring
//! `to_world` changes nothing of it, as it changes nothing of exact shapes and of instances.

mod clean;
mod crease;
mod normals;
mod obj;
mod ply;
mod polygon;
mod repeated;
mod serialized;
mod split;
mod stl;
#[cfg(test)]
mod tests;
mod text;

use super::{ImportError, encoding, gzip, named};
use crate::image::decoded::DecodeLimit;
use crate::image::foreign;
use crate::math::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use crate::scene::description::Mesh;
use crate::texture::MeshAttribute;
use std::path::Path;

pub use split::split;

/// What a scene says about a mesh beside its file.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshOptions {
    /// Object space to world (or group) space.
    pub to_world: DAffine3,
    /// Flat shading: normals of the file are dropped and none are computed.
    pub face_normals: bool,
    /// Flat shading where the file has no normals, instead of normals that are computed.
    pub flat_without_normals: bool,
    /// Turn the surface around: normals are negated and the winding is reversed.
    pub flip_normals: bool,
    /// Replace v by 1 - v. Mitsuba's default is true for OBJ and false for the others.
    pub flip_tex_coords: bool,
    /// Rebuild the normals with creases where faces meet at more than this angle, in degrees.
    /// Normals of the file are dropped.
    pub max_smooth_angle: Option<f32>,
    /// Which mesh of a `serialized` file, from 0.
    pub shape_index: usize,
    /// Drop what cannot be used (triangles at vertices that are not finite, meshes left without
    /// triangles) with a warning instead of an error.
    pub lenient: bool,
    /// Of an OBJ file, keep which material each face has: as the attribute [`FACE_MATERIAL`] and
    /// [`Loaded::face_materials`].
    pub face_materials: bool,
    /// What a file that is compressed may unpack to.
    pub decode: DecodeLimit,
}

/// Name of the attribute of faces that numbers their materials.
pub const FACE_MATERIAL: &str = "face_material";

/// The materials that an OBJ file names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FaceMaterials {
    /// Names, in the order of their numbers; empty for faces before the first.
    pub names: Vec<String>,
    /// Files that define them, relative to the OBJ file.
    pub libraries: Vec<String>,
}

impl Default for MeshOptions {
    fn default() -> Self {
        Self {
            to_world: DAffine3::IDENTITY,
            face_normals: false,
            flat_without_normals: false,
            flip_normals: false,
            flip_tex_coords: false,
            max_smooth_angle: None,
            shape_index: 0,
            lenient: false,
            face_materials: false,
            decode: DecodeLimit::default(),
        }
    }
}

/// Format of a mesh file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshKind {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, ASCII or binary.
    Ply,
    /// Mitsuba's `serialized`.
    Serialized,
    /// Stereolithography, ASCII or binary.
    Stl,
}

impl MeshKind {
    /// The format a file name's extension stands for, if it is one of ours.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "ply" => Some(Self::Ply),
            "serialized" => Some(Self::Serialized),
            "stl" => Some(Self::Stl),
            _ => None,
        }
    }
}

/// A mesh, and what had to be repaired in it.
#[derive(Debug, Default)]
pub struct Loaded {
    /// The mesh. Positions are finite, every triangle has an area, normals are of unit length.
    pub mesh: Mesh,
    /// Repairs in words, each with how often and where first; without the file's name.
    pub warnings: Vec<String>,
    /// Materials of an OBJ file, if they were asked for.
    pub face_materials: FaceMaterials,
    /// Images that a PLY file names in comments (`comment TextureFile NAME`).
    pub images: Vec<String>,
}

/// Reads a mesh. Uses rayon's threads; the result does not depend on their number.
///
/// Errors name the file with line and column (text) or byte (binary): a file that cannot be opened,
/// is not of the format, ends early, names vertices that it does not have, holds a position that is
/// not finite, or has no triangle.
pub fn load(path: &Path, kind: MeshKind, options: &MeshOptions) -> Result<Loaded, ImportError> {
    read(&open(path, options)?, kind, options, path)
}

/// [`load`] of bytes in memory; `path` is for messages.
///
/// # Errors
/// Those of [`load`], but for files that cannot be opened.
pub fn read(
    data: &[u8],
    kind: MeshKind,
    options: &MeshOptions,
    path: &Path,
) -> Result<Loaded, ImportError> {
    let raw = raw(data, kind, options, path)?;
    clean::finish(raw, options).map_err(|e| e.in_file(path))
}

/// What a file holds and no more: indices are in range, nothing else is certain.
///
/// # Errors
/// When the file cannot be opened or is not of the format, ends early, or names vertices that it
/// does not have.
pub fn buffers(path: &Path, kind: MeshKind, options: &MeshOptions) -> Result<Buffers, ImportError> {
    let raw = raw(&open(path, options)?, kind, options, path)?;
    Ok(Buffers {
        positions: raw.positions,
        normals: raw.normals,
        tangents: raw.tangents,
        uvs: raw.uvs,
        triangles: raw.triangles,
        attributes: raw.attributes,
    })
}

fn open(path: &Path, options: &MeshOptions) -> Result<gzip::Bytes, ImportError> {
    gzip::open(path, options.decode).map_err(|message| ImportError {
        at: None,
        file: Some(path.to_owned()),
        message: format!("{message}{}", named::hint_of(path)),
        help: None,
    })
}

fn raw(
    data: &[u8],
    kind: MeshKind,
    options: &MeshOptions,
    path: &Path,
) -> Result<Raw, ImportError> {
    if let Some(foreign) = foreign::by_head(data) {
        return Err(ImportError {
            at: None,
            file: Some(path.to_owned()),
            message: format!("is no mesh but {}", foreign.what),
            help: Some(foreign.help.into()),
        });
    }
    let is_text = matches!(kind, MeshKind::Obj | MeshKind::Ply);
    if let Some(wrong) = encoding::wide(data).filter(|_| is_text) {
        return Err(Fault::new(0, wrong).in_text(data, path));
    }
    match kind {
        MeshKind::Obj => {
            let data = &encoding::lines(data);
            obj::read(data, options).map_err(|e| e.in_text(data, path))
        }
        MeshKind::Ply => ply::read(data, options, path),
        MeshKind::Serialized => serialized::read(data, options).map_err(|e| e.in_binary(path)),
        MeshKind::Stl => stl::read(data, options, path),
    }
}

/// A mesh in memory: as a reader of another format has it, in object space and with indices not
/// checked, or as [`buffers`] leaves it.
#[derive(Debug, Default)]
pub struct Buffers {
    /// Positions.
    pub positions: Vec<Vec3>,
    /// Normals of any length, one for each position.
    pub normals: Option<Vec<Vec3>>,
    /// Tangents of any length and the side of the texture, one for each position; without normals
    /// they count for nothing.
    pub tangents: Option<Vec<Vec4>>,
    /// Texture coordinates, one for each position.
    pub uvs: Option<Vec<Vec2>>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Named values.
    pub attributes: Vec<MeshAttribute>,
}

/// Makes of buffers what [`load`] makes of a file; `path` is for messages.
///
/// # Errors
/// As [`load`].
pub fn from_buffers(
    buffers: Buffers,
    options: &MeshOptions,
    path: &Path,
) -> Result<Loaded, ImportError> {
    let count = buffers.positions.len();
    let beyond = |t: &[u32; 3]| t.iter().any(|&i| i as usize >= count);
    if let Some(at) = buffers.triangles.iter().position(beyond) {
        let names = buffers.triangles[at];
        return Err(ImportError {
            at: None,
            file: Some(path.to_owned()),
            message: format!("triangle {at} names vertices {names:?}, but there are {count}"),
            help: None,
        });
    }
    let mut positions = buffers.positions;
    for p in &mut positions {
        *p = place(&options.to_world, p.x.into(), p.y.into(), p.z.into());
    }
    let raw = Raw {
        positions,
        normals: buffers.normals,
        tangents: buffers.tangents,
        uvs: buffers.uvs,
        triangles: buffers.triangles,
        attributes: buffers.attributes,
        ..Raw::default()
    };
    clean::finish(raw, options).map_err(|e| e.in_file(path))
}

/// A mesh as its reader leaves it. Indices are in range; nothing else is certain.
#[derive(Default)]
struct Raw {
    /// World space.
    positions: Vec<Vec3>,
    /// Object space, of any length; zero where the file gives none. One for each position.
    normals: Option<Vec<Vec3>>,
    /// Object space, of any length. One for each position.
    tangents: Option<Vec<Vec4>>,
    /// One for each position.
    uvs: Option<Vec<Vec2>>,
    triangles: Vec<[u32; 3]>,
    attributes: Vec<MeshAttribute>,
    /// The file asks for flat shading.
    flat: bool,
    face_materials: FaceMaterials,
    /// Images that the file names.
    images: Vec<String>,
    /// What the reader met and left out.
    warnings: Vec<String>,
}

/// Something wrong at a byte of a file.
#[derive(Debug)]
struct Fault {
    offset: usize,
    message: String,
}

impl Fault {
    fn new(offset: usize, message: impl Into<String>) -> Self {
        Self {
            offset,
            message: message.into(),
        }
    }

    fn in_text(self, data: &[u8], path: &Path) -> ImportError {
        ImportError {
            at: Some(text::location(data, self.offset, path)),
            file: None,
            message: self.message,
            help: None,
        }
    }

    fn in_binary(self, path: &Path) -> ImportError {
        ImportError {
            at: None,
            file: Some(path.to_owned()),
            message: format!("byte {}: {}", self.offset, self.message),
            help: None,
        }
    }
}

/// A point of the file in world space: one rounding, from `f64` to `f32`.
#[inline]
fn place(to_world: &DAffine3, x: f64, y: f64, z: f64) -> Vec3 {
    to_world.transform_point3(DVec3::new(x, y, z)).as_vec3()
}
