//! Mesh files: collected while the scene is read, then loaded together.
//!
//! Scenes name hundreds of files. They are read in parallel, each (file, options) once, and when some are
//! missing the error lists them all.

use super::importer::Importer;
use super::shapes::{PendingGeometry, PendingShape};
use super::xml::At;
use crate::light::Emitter;
use crate::scene::import::ImportError;
use crate::scene::import::mesh::{Loaded, MeshKind, MeshOptions};
use crate::scene::{Geometry, Mesh, Shape};
use rayon::prelude::*;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh file that a shape asks for.
#[derive(Clone, Debug)]
pub(super) struct Request {
    pub path: PathBuf,
    pub kind: MeshKind,
    pub options: MeshOptions,
    /// Where the shape names the file.
    pub at: At,
}

impl Request {
    /// What two requests share when they are for the same mesh: everything but the place.
    fn key(&self) -> (PathBuf, String) {
        // `f64` in the options has no `Hash`; its shortest text that reads back the same stands for it.
        (
            self.path.clone(),
            format!("{:?} {:?}", self.kind, self.options),
        )
    }
}

/// Loads what the pending shapes ask for and makes shapes of them.
pub(super) fn load_all(
    importer: &mut Importer,
    pending: Vec<PendingShape>,
) -> Result<Vec<Shape>, ImportError> {
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
    let missing: Vec<_> = unique.iter().filter(|r| !r.path.is_file()).collect();
    if !missing.is_empty() && !importer.options.lenient {
        return Err(missing_error(importer, &missing));
    }
    let load = importer.options.load_mesh;
    let loaded: Vec<Result<Loaded, ImportError>> = unique
        .par_iter()
        .map(|r| load(&r.path, r.kind, &r.options))
        .collect();
    let mut meshes: Vec<Option<Arc<Mesh>>> = Vec::with_capacity(unique.len());
    for (result, request) in loaded.into_iter().zip(&unique) {
        meshes.push(accept(importer, result, request)?.map(Arc::new));
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
    Ok(place(importer, geometries.collect()))
}

fn missing_error(importer: &Importer, missing: &[&&Request]) -> ImportError {
    let list: Vec<String> = missing
        .iter()
        .map(|r| {
            let place = importer.document.location(r.at);
            format!("{}, asked for at {place}", r.path.display())
        })
        .collect();
    let message = match list.as_slice() {
        [one] => format!("there is no mesh {one}"),
        many => format!(
            "{} meshes are missing:\n    {}",
            many.len(),
            many.join("\n    ")
        ),
    };
    let help = "restore the files, or go on without them with --lenient".to_owned();
    let at = missing.first().map(|r| importer.document.location(r.at));
    ImportError {
        at,
        file: None,
        message,
        help: Some(help),
    }
}

/// The mesh, its repairs as warnings; `None` for a bad one that is forgiven.
fn accept(
    importer: &mut Importer,
    result: Result<Loaded, ImportError>,
    request: &Request,
) -> Result<Option<Mesh>, ImportError> {
    let place = importer.document.location(request.at);
    match result {
        Ok(loaded) => {
            for warning in loaded.warnings {
                importer.warn(format!("{}: {warning}", request.path.display()));
            }
            Ok(Some(loaded.mesh))
        }
        Err(error) if importer.options.lenient => {
            importer.warn(format!("{place}: the shape is left out: {error}"));
            Ok(None)
        }
        Err(error) => {
            let asked = format!("the mesh is asked for at {place}");
            let help = match error.help {
                Some(help) => format!("{help}\n  {asked}"),
                None => asked,
            };
            Err(ImportError {
                help: Some(help),
                ..error
            })
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
            importer.emitters.push(Emitter::Area {
                shape: out.len() as u32,
                radiance,
                both_sides: false,
            });
            (importer.emitters.len() - 1) as u32
        });
        out.push(Shape {
            name: pending.name,
            geometry,
            material: pending.material,
            emitter,
            flip_normals: pending.flip_normals,
            group: pending.group,
        });
    }
    out
}
