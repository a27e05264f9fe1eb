//! Mesh files: collected while the scene is read, then loaded together.
//!
//! Scenes name hundreds of files. They are read in parallel, each (file, options) once, and when
//! some are missing the error lists them all.

use super::importer::Importer;
use super::pending::{PendingGeometry, PendingShape, Request};
use crate::light::Emitter;
use crate::scene::import::ImportError;
use crate::scene::import::mesh::Loaded;
use crate::scene::{Geometry, Mesh, Shape};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// Loads what the pending shapes ask for and makes shapes of them. What is missing or bad is told,
/// and the shapes are left out.
pub(super) fn load_all(importer: &mut Importer, pending: Vec<PendingShape>) -> Vec<Shape> {
    let mut unique: Vec<&Request> = Vec::new();
    let mut index_of = HashMap::new();
    for shape in &pending {
        let PendingGeometry::File(request) = &shape.geometry else {
            continue;
        };
        index_of.entry(request.key()).or_insert_with(|| {
            unique.push(request);
            unique.len() - 1
        });
    }
    let load = importer.options.load_mesh;
    let loaded: Vec<Result<Loaded, ImportError>> = unique
        .par_iter()
        .map(|r| match r.path.exists() {
            true => load(&r.path, r.kind, &r.options),
            false => Err(ImportError::no_mesh(&r.path)),
        })
        .collect();
    let mut meshes: Vec<Option<Arc<Mesh>>> = Vec::with_capacity(unique.len());
    for (result, request) in loaded.into_iter().zip(&unique) {
        meshes.push(accept(importer, result, request).map(Arc::new));
    }
    let geometries = pending.into_iter().map(|shape| {
        let geometry = match &shape.geometry {
            PendingGeometry::Ready(geometry) => Some(geometry.clone()),
            PendingGeometry::File(request) => {
                let index = index_of.get(&request.key());
                let mesh = index.and_then(|&i| meshes[i].clone());
                mesh.map(Geometry::Mesh)
            }
        };
        (shape, geometry)
    });
    place(importer, geometries.collect())
}

/// The mesh, its repairs as warnings; `None` for one that is bad, or has nothing that could be
/// seen.
fn accept(
    importer: &mut Importer,
    result: Result<Loaded, ImportError>,
    request: &Request,
) -> Option<Mesh> {
    let place = importer.document.location(request.at);
    match result {
        Ok(loaded) => {
            let is_empty = loaded.mesh.triangles.triangles().is_empty();
            let left_out = if is_empty {
                ": the shape is left out"
            } else {
                ""
            };
            for warning in loaded.warnings {
                let path = request.path.display();
                importer
                    .warnings
                    .tell(format!("{place}: {path}: {warning}{left_out}"));
            }
            (!is_empty).then_some(loaded.mesh)
        }
        Err(error) => {
            let error = error.asked_for_at(place);
            let instead = "the shape is left out";
            importer.document.faults.add(request.at, error, instead);
            None
        }
    }
}

/// Shapes and their area lights in the scene's order, without those that have no geometry.
fn place(importer: &mut Importer, shapes: Vec<(PendingShape, Option<Geometry>)>) -> Vec<Shape> {
    let mut out = Vec::with_capacity(shapes.len());
    for (pending, geometry) in shapes {
        let Some(geometry) = geometry else {
            continue;
        };
        let emitter = pending.radiance.map(|radiance| {
            let number = importer.emitters.len() as u32;
            if let Some(id) = pending.lamp_id {
                importer.emitter_names.insert(number, id);
            }
            importer.emitters.push(Emitter::Area {
                shape: out.len() as u32,
                radiance,
                both_sides: false,
            });
            number
        });
        out.push(Shape {
            name: pending.name,
            geometry,
            material: pending.material,
            emitter,
            flip_normals: pending.flip_normals,
            group: pending.group,
            boundary: pending.boundary,
        });
    }
    out
}
