//! Model files without a scene: PLY, OBJ (with MTL), STL, Mitsuba's `serialized` and glTF, several
//! at once, each placed where it is wanted.
//!
//! A mesh file that is named more than once, with the same words but for its placement, is loaded
//! once and instanced.

mod colors;
mod mtl;
mod numbers;
pub mod palette;
mod source;
#[cfg(test)]
mod tests;

pub(super) use numbers::numbers;
pub use source::ModelSource;

use super::gltf::{self, GltfOptions, Show};
use super::mesh::{self, FACE_MATERIAL, Loaded, MeshKind, MeshOptions};
use super::parts::Parts;
use super::{ImportError, ImportOptions};
use crate::accel::TriangleMesh;
use crate::bsdf::MaterialId;
use crate::light::Emitter;
use crate::math::{DAffine3, Rgb, Vec3};
use crate::medium::Boundary;
use crate::scene::{Geometry, Mesh, Shape};
use crate::texture::Texture;
use mtl::Library;
use palette::Paint;
use rayon::prelude::*;
use std::path::Path;
use std::sync::Arc;

/// What a model file holds, by the end of its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ModelKind {
    /// One mesh.
    Mesh(MeshKind),
    /// A tree of meshes with materials, lights and cameras.
    Gltf,
}

impl ModelKind {
    /// The kind of a file, if it is a model.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "gltf" | "glb" => Some(Self::Gltf),
            _ => MeshKind::from_path(path).map(Self::Mesh),
        }
    }
}

/// How models are loaded.
#[derive(Clone, Debug)]
pub struct ModelOptions {
    /// Material of all models whose source names none; it then also replaces the files' own.
    pub material: Option<Paint>,
    /// Turns what has +y up by its definition (glTF) so that +z is up.
    pub z_up: bool,
    /// What is shown of glTF files.
    pub show: Show,
}

/// A mesh file to load, and everywhere it stands.
struct Unique<'a> {
    source: &'a ModelSource,
    kind: MeshKind,
    places: Vec<DAffine3>,
}

/// Loads all `sources` into one scene's parts, after those that there are.
///
/// # Errors
/// When a file cannot be used, or is no model.
pub fn load(
    sources: &[ModelSource],
    models: &ModelOptions,
    options: &ImportOptions,
    mut parts: Parts,
) -> Result<Parts, ImportError> {
    let mut meshes: Vec<Unique> = Vec::new();
    let turn = match models.z_up {
        true => DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2),
        false => DAffine3::IDENTITY,
    };
    for source in sources {
        match ModelKind::from_path(&source.path) {
            Some(ModelKind::Gltf) => {
                let paint = source.material.as_ref().or(models.material.as_ref());
                let gltf = GltfOptions {
                    to_world: source.to_world * turn,
                    material: paint.map(|p| p.add(&mut parts.materials, None)),
                    boundary: paint.and_then(|p| p.boundary(&mut parts.media)),
                    show: models.show.clone(),
                };
                gltf::load(&source.path, &gltf, options, &mut parts)?;
            }
            Some(ModelKind::Mesh(kind)) => gather(&mut meshes, source, kind),
            None => return Err(unknown(&source.path)),
        }
    }
    let loaded: Vec<Result<Loaded, ImportError>> = meshes
        .par_iter()
        .map(|m| (options.load_mesh)(&m.source.path, m.kind, &m.options(models)))
        .collect();
    for (unique, loaded) in meshes.iter().zip(loaded) {
        let mut adder = Adder {
            parts: &mut parts,
            models,
            options,
        };
        adder.add(unique, loaded?)?;
    }
    Ok(parts)
}

fn unknown(path: &Path) -> ImportError {
    ImportError {
        at: None,
        file: Some(path.to_owned()),
        message: "is no model: its name ends with none of .ply .obj .stl .gltf .glb .serialized"
            .into(),
        help: Some("a scene (.xml) is rendered by itself, not together with models".into()),
    }
}

fn gather<'a>(meshes: &mut Vec<Unique<'a>>, source: &'a ModelSource, kind: MeshKind) {
    match meshes.iter_mut().find(|m| m.source.same_mesh(source)) {
        Some(known) => known.places.push(source.to_world),
        None => meshes.push(Unique {
            source,
            kind,
            places: vec![source.to_world],
        }),
    }
}

impl Unique<'_> {
    /// What covers all of the mesh, instead of its own materials.
    fn paint<'a>(&'a self, models: &'a ModelOptions) -> Option<&'a Paint> {
        self.source.material.as_ref().or(models.material.as_ref())
    }

    fn options(&self, models: &ModelOptions) -> MeshOptions {
        MeshOptions {
            to_world: match self.places.as_slice() {
                [only] => *only,
                _ => DAffine3::IDENTITY,
            },
            face_normals: self.source.flat,
            flip_normals: self.source.flip,
            flip_tex_coords: self.kind == MeshKind::Obj,
            lenient: true,
            face_materials: self.kind == MeshKind::Obj && self.paint(models).is_none(),
            ..MeshOptions::default()
        }
    }
}

/// Adds meshes to parts.
struct Adder<'a> {
    parts: &'a mut Parts,
    models: &'a ModelOptions,
    options: &'a ImportOptions,
}

impl Adder<'_> {
    fn add(&mut self, unique: &Unique, loaded: Loaded) -> Result<(), ImportError> {
        let path = &unique.source.path;
        for warning in &loaded.warnings {
            self.parts.warn(format!("{}: {warning}", path.display()));
        }
        if loaded.mesh.triangles.triangles().is_empty() {
            return Err(ImportError {
                at: None,
                file: Some(path.clone()),
                message: "has no triangle with an area".into(),
                help: None,
            });
        }
        let paint = unique.paint(self.models);
        let image = match paint {
            Some(_) => None,
            None => self.image(path, &loaded)?,
        };
        let library = match paint {
            Some(_) => Library::default(),
            None => Library::read(path, &loaded.face_materials, self.parts),
        };
        let boundary = paint.and_then(|p| p.boundary(&mut self.parts.media));
        let mut pieces = Vec::new();
        for (index, mut mesh) in by_material(loaded) {
            if let Some(warning) = colors::prepare(&mut mesh) {
                self.parts.warn(format!("{}: {warning}", path.display()));
            }
            let colors = colors::of(&mesh);
            let parts = &mut *self.parts;
            let (material, radiance) = match (&paint, &image) {
                (Some(paint), _) => (paint.add(&mut parts.materials, colors), None),
                (None, Some(image)) => (colors::painted(image.clone(), colors, parts), None),
                (None, None) => library.material(index, colors, self.options, parts)?,
            };
            pieces.push(Piece {
                mesh,
                material,
                radiance,
                boundary,
            });
        }
        self.place(unique, pieces);
        Ok(())
    }

    /// The image that a PLY file names for its surface.
    fn image(&mut self, path: &Path, loaded: &Loaded) -> Result<Option<Texture>, ImportError> {
        let Some(name) = loaded.images.first() else {
            return Ok(None);
        };
        let mut warn = |message: String| {
            self.parts.warn(format!("{}: {message}", path.display()));
        };
        if loaded.mesh.uvs.is_none() {
            warn(format!(
                "the texture {name} is left out: the vertices have no texture coordinates"
            ));
            return Ok(None);
        }
        let more = loaded.images.len() - 1;
        if more > 0 {
            warn(format!(
                "of {} textures the first alone is laid on, {name}",
                more + 1
            ));
        }
        colors::open(name, path, self.options, self.parts)
    }

    /// Puts the pieces where they are to stand. What glows is copied, as light is not instanced.
    fn place(&mut self, unique: &Unique, pieces: Vec<Piece>) {
        let path = unique.source.path.display().to_string();
        if unique.places.len() < 2 {
            return pieces.into_iter().for_each(|p| self.shape(&path, p, None));
        }
        if pieces.iter().any(|p| p.radiance.is_some()) {
            for place in &unique.places {
                let moved = pieces.iter().map(|p| p.moved(place));
                moved.for_each(|p| self.shape(&path, p, None));
            }
            return;
        }
        let group = self.parts.groups;
        self.parts.groups += 1;
        let places = unique.places.iter().map(|place| (group, *place));
        self.parts.instances.extend(places);
        for piece in pieces {
            self.shape(&path, piece, Some(group));
        }
    }

    fn shape(&mut self, name: &str, piece: Piece, group: Option<u32>) {
        let shape = self.parts.shapes.len() as u32;
        let emitter = piece.radiance.map(|radiance| {
            self.parts.emitters.push(Emitter::Area {
                shape,
                radiance,
                both_sides: false,
            });
            (self.parts.emitters.len() - 1) as u32
        });
        self.parts.shapes.push(Shape {
            name: name.to_owned(),
            geometry: Geometry::Mesh(Arc::new(piece.mesh)),
            material: piece.material,
            emitter,
            flip_normals: false,
            group,
            boundary: piece.boundary,
        });
    }
}

/// A mesh of one material.
struct Piece {
    mesh: Mesh,
    material: MaterialId,
    radiance: Option<Texture>,
    /// The media on its sides.
    boundary: Option<Boundary>,
}

impl Piece {
    /// A copy elsewhere.
    fn moved(&self, to_world: &DAffine3) -> Self {
        let mesh = &self.mesh;
        let inverse = to_world.matrix3.inverse().transpose();
        let turn = |n: &Vec3| (inverse * n.as_dvec3()).normalize_or_zero().as_vec3();
        let place = |p: &Vec3| to_world.transform_point3(p.as_dvec3()).as_vec3();
        let positions = mesh.triangles.positions().iter().map(place).collect();
        let mut corners = mesh.triangles.triangles().to_vec();
        if to_world.matrix3.determinant() < 0.0 {
            // A mirror turns nothing inside out.
            corners.iter_mut().for_each(|t| t.swap(1, 2));
        }
        let triangles = TriangleMesh::new(positions, corners);
        Self {
            mesh: Mesh {
                // The indices are those of a mesh with as many vertices.
                triangles: Arc::new(triangles.unwrap_or_default()),
                normals: mesh.normals.as_ref().map(|n| n.iter().map(turn).collect()),
                // Mesh files give none.
                tangents: None,
                uvs: mesh.uvs.clone(),
                attributes: mesh.attributes.clone(),
            },
            material: self.material,
            radiance: self.radiance.clone(),
            boundary: self.boundary,
        }
    }
}

/// The pieces of a mesh, each with the number of its material.
fn by_material(loaded: Loaded) -> Vec<(u32, Mesh)> {
    let mut mesh = loaded.mesh;
    let list = &mut mesh.attributes.list;
    let Some(at) = list.iter().position(|a| a.name == FACE_MATERIAL) else {
        return vec![(0, mesh)];
    };
    let numbers = list.swap_remove(at).values;
    mesh::split(mesh, |triangle| {
        numbers.get(triangle).map_or(0, |n| n.x as u32)
    })
}

/// The linear value of an sRGB colour (IEC 61966-2-1).
pub(super) fn linear(color: Rgb) -> Rgb {
    let one = |x: f32| {
        if x <= 0.04045 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    };
    Rgb::from(color.to_array().map(one))
}
