//! `twintree make`: meshes to render.

use super::choice::{Choice, choice};
use super::{Failure, console, values};
use crate::image::atomic;
use crate::make::{Kind, Pattern, write_ply};
use crate::report::words;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// Arguments of `twintree make`.
#[derive(Args, Debug)]
pub struct MakeArgs {
    /// What to make.
    #[command(subcommand)]
    pub what: MakeCommand,
}

/// What can be made.
#[derive(Subcommand, Debug)]
pub enum MakeCommand {
    /// Write a mesh of any size as binary PLY, always the same for the same words
    Mesh(MakeMeshArgs),
}

/// Arguments of `twintree make mesh`.
#[derive(Args, Debug)]
pub struct MakeMeshArgs {
    /// Shape
    #[arg(long, value_name = "SHAPE", value_parser = SHAPES)]
    pub kind: Kind,
    /// Triangles, such as 20k, 5M or 1G; the mesh comes as near to it as its shape allows
    #[arg(long, value_name = "N", default_value = "1M", value_parser = values::amount)]
    pub triangles: u64,
    /// File to write
    #[arg(short, long, value_name = "FILE.ply")]
    pub output: PathBuf,
}

/// Shapes that can be made.
pub const SHAPES: Choice<Kind> = choice! {
    /// Mountains
    "terrain" => Kind::Terrain,
    /// A wall along Heighway's dragon curve
    "dragon-curve" => Kind::DragonCurve,
    /// Spheres on spheres
    "sphere-flake" => Kind::SphereFlake,
    /// A tube tied to a knot
    "torus-knot" => Kind::TorusKnot,
};

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
    let pattern = Pattern::new(args.kind, args.triangles);
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
