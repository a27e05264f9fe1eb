//! `twintree make`: meshes to render.

use super::scene_args::{MakeArgs, MakeCommand, MakeMeshArgs, MeshShape};
use super::{Failure, console};
use crate::image::atomic;
use crate::make::{Kind, Pattern, write_ply};
use crate::report::words;

/// Makes what is asked for.
///
/// # Errors
/// When the file cannot be written.
pub fn run(args: &MakeArgs) -> Result<(), Failure> {
    match &args.what {
        MakeCommand::Mesh(args) => mesh(args),
    }
}

fn mesh(args: &MakeMeshArgs) -> Result<(), Failure> {
    let is_ply = args
        .output
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("ply"));
    if !is_ply {
        let message = format!("{} does not end with .ply", args.output.display());
        return Err(Failure::wrong(message, "meshes are written as PLY"));
    }
    let pattern = Pattern::new(kind_of(args.kind), args.triangles);
    check_size(&pattern)?;
    atomic::replace(&args.output, |file| {
        write_ply(&pattern, file).map_err(|e| e.to_string())
    })
    .map_err(|e| Failure::Refused(e.to_string()))?;
    console::print_result(&format!(
        "{}: {} triangles, {} vertices\n",
        args.output.display(),
        words::count(pattern.triangles() as f64),
        words::count(pattern.vertices() as f64)
    ))
}

/// The shape that a word names.
pub fn kind_of(shape: MeshShape) -> Kind {
    match shape {
        MeshShape::Terrain => Kind::Terrain,
        MeshShape::DragonCurve => Kind::DragonCurve,
        MeshShape::SphereFlake => Kind::SphereFlake,
        MeshShape::TorusKnot => Kind::TorusKnot,
    }
}

/// Refuses what 32 bits cannot number.
///
/// # Errors
/// When there are too many triangles or vertices.
pub fn check_size(pattern: &Pattern) -> Result<(), Failure> {
    let (vertices, triangles) = (pattern.vertices(), pattern.triangles());
    if vertices.max(triangles) < u64::from(u32::MAX) {
        return Ok(());
    }
    Err(Failure::wrong(
        format!("{triangles} triangles are too many for one mesh"),
        "ask for fewer than 4G",
    ))
}
