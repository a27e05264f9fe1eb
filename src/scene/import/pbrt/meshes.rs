//! Meshes: collected while the scene is read, then made together, side by side.
//!
//! A file that several shapes name with the same options is read once. What is missing or wrong is
//! told, and its shapes are left out.

use super::importer::Importer;
use super::pending::{Glow, PendingGeometry, PendingShape, Request};
use super::{inline, power};
use crate::light::Emitter;
use crate::scene::import::faults::At;
use crate::scene::import::mesh::{Loaded, MeshKind};
use crate::scene::import::{ImportError, ImportOptions, gzip};
use crate::scene::{Geometry, Mesh, Shape};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Makes the meshes of the pending shapes, and shapes of them.
pub(super) fn make_all(importer: &mut Importer, pending: Vec<PendingShape>) -> Vec<Shape> {
    let mut unique: Vec<(&Request, At)> = Vec::new();
    let mut index_of = HashMap::new();
    for shape in &pending {
        if let PendingGeometry::File(request) = &shape.geometry {
            index_of.entry(request.key()).or_insert_with(|| {
                unique.push((request, shape.at));
                unique.len() - 1
            });
        }
    }
    let options = importer.options;
    let loaded: Vec<_> = unique.par_iter().map(|(r, _)| load(r, options)).collect();
    let made: Vec<_> = pending
        .par_iter()
        .map(|shape| match &shape.geometry {
            PendingGeometry::Inline(inline) => Some(inline::make(inline, options)),
            _ => None,
        })
        .collect();
    let files: Vec<_> = loaded
        .into_iter()
        .zip(&unique)
        .map(|(result, (_, at))| accept(importer, result, *at).map(Arc::new))
        .collect();
    let mut geometries = Vec::with_capacity(pending.len());
    for (shape, made) in pending.iter().zip(made) {
        geometries.push(match &shape.geometry {
            PendingGeometry::Ready(geometry) => Some(geometry.clone()),
            PendingGeometry::File(request) => {
                let file = index_of.get(&request.key());
                let mesh = file.and_then(|&i| files[i].clone());
                mesh.map(Geometry::Mesh)
            }
            PendingGeometry::Inline(_) => made
                .and_then(|made| accept(importer, made, shape.at))
                .map(|mesh| Geometry::Mesh(Arc::new(mesh))),
        });
    }
    drop(unique);
    for (shape, geometry) in pending.iter().zip(&geometries) {
        let bare = matches!(geometry, Some(Geometry::Mesh(mesh)) if mesh.uvs.is_none());
        if bare && importer.reads_uvs(shape.material, shape.glow.as_ref()) {
            importer.warn_at(
                shape.at,
                "this mesh has no texture coordinates: a single place of its textures is seen \
                 (pbrt lays each face on the whole texture)",
            );
        }
    }
    place(importer, pending, geometries)
}

fn load(request: &Request, options: &ImportOptions) -> Result<Loaded, ImportError> {
    let path = &request.path;
    if !path.exists() {
        return Err(ImportError::no_mesh(path));
    }
    let kind = MeshKind::from_path(&gzip::unpacked_name(path)).unwrap_or(MeshKind::Ply);
    (options.load_mesh)(path, kind, &request.options)
}

/// The mesh, its repairs as warnings; `None` for one that is bad, or has nothing that could be
/// seen.
fn accept(importer: &mut Importer, result: Result<Loaded, ImportError>, at: At) -> Option<Mesh> {
    match result {
        Ok(loaded) => {
            for warning in loaded.warnings {
                importer.warn_at(at, &warning);
            }
            let seen = !loaded.mesh.triangles.triangles().is_empty();
            seen.then_some(loaded.mesh)
        }
        Err(error) => {
            let error = error.asked_for_at(importer.source.location(at));
            importer.source.fault_of(at, error, "the shape is left out");
            None
        }
    }
}

/// Shapes and their area lights in the scene's order, without those that have no geometry.
fn place(
    importer: &mut Importer,
    pending: Vec<PendingShape>,
    geometries: Vec<Option<Geometry>>,
) -> Vec<Shape> {
    let mut out = Vec::with_capacity(pending.len());
    for (shape, geometry) in pending.into_iter().zip(geometries) {
        let Some(mut geometry) = geometry else {
            continue;
        };
        let emitter = shape.glow.map(|glow| {
            let radiance = radiance(&glow, &mut geometry);
            let number = importer.emitters.len() as u32;
            importer.emitters.push(Emitter::Area {
                shape: out.len() as u32,
                radiance,
                both_sides: glow.both_sides,
            });
            number
        });
        let is_exact = matches!(geometry, Geometry::Analytic(_));
        out.push(Shape {
            name: shape.name,
            geometry,
            material: shape.material,
            emitter,
            // Meshes were turned when they were made.
            flip_normals: shape.flip_normals && is_exact,
            group: shape.group,
            boundary: shape.boundary,
        });
    }
    out
}

/// What a shape emits: where a power is given, as much of it as the area asks for.
fn radiance(glow: &Glow, geometry: &mut Geometry) -> crate::texture::Texture {
    match glow.power {
        None => glow.radiance.clone(),
        Some(watts) => power::spread(glow, watts, geometry),
    }
}
