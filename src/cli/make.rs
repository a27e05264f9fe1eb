//! `twintree make`: meshes and scenes to render.

use super::choice::{Choice, choice};
use super::{Failure, console, values};
use crate::image::atomic;
use crate::make::{Dialect, Instances, Kind, Pattern, write_ply};
use crate::report::words;
use clap::{Args, Subcommand};
use std::io;
use std::path::{Path, PathBuf};

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
    /// Write a scene of many instances of four meshes, for pbrt or for Mitsuba
    Scene(MakeSceneArgs),
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

/// Arguments of `twintree make scene`.
#[derive(Args, Debug)]
pub struct MakeSceneArgs {
    /// Instances, such as 500 or 50k
    #[arg(long, value_name = "N", default_value = "50k", value_parser = values::amount)]
    pub instances: u64,
    /// Triangles of all instances together
    #[arg(long, value_name = "N", default_value = "10M", value_parser = values::amount)]
    pub triangles: u64,
    /// Scene to write, for pbrt (.pbrt) or Mitsuba (.xml); the meshes lie beside it
    #[arg(short, long, value_name = "FILE")]
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
        MakeCommand::Scene(args) => scene(args),
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
    replace(&args.output, |path| write_ply(&pattern, path))?;
    console::print_result(&format!(
        "{}: {} triangles, {} vertices\n",
        args.output.display(),
        words::count(pattern.triangles() as f64),
        words::count(pattern.vertices() as f64)
    ))
}

fn scene(args: &MakeSceneArgs) -> Result<(), Failure> {
    let ending = args.output.extension().and_then(|e| e.to_str());
    let dialect = match ending {
        Some("pbrt") => Dialect::Pbrt,
        Some("xml") => Dialect::Mitsuba,
        _ => {
            let message = format!("{} ends with neither .pbrt nor .xml", args.output.display());
            return Err(Failure::wrong(
                message,
                "the ending says which language it is in",
            ));
        }
    };
    let stem = args
        .output
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let mut meshes = Vec::new();
    let mut triangles = 0;
    for (name, kind) in [
        ("knot", Kind::TorusKnot),
        ("flake", Kind::SphereFlake),
        ("wall", Kind::DragonCurve),
        ("terrain", Kind::Terrain),
    ] {
        let pattern = Pattern::new(kind, (args.triangles / args.instances).max(1));
        check_size(&pattern)?;
        let file = format!("{stem}-{name}.ply");
        replace(&args.output.with_file_name(&file), |path| {
            write_ply(&pattern, path)
        })?;
        triangles += pattern.triangles();
        meshes.push(file);
    }
    let instances = Instances {
        count: args.instances,
        meshes: &meshes,
    };
    replace(&args.output, |path| instances.write(dialect, path))?;
    console::print_result(&format!(
        "{}: {} instances of {} meshes, about {} triangles in all\n",
        args.output.display(),
        words::count(args.instances as f64),
        meshes.len(),
        words::count(triangles as f64 / meshes.len() as f64 * args.instances as f64)
    ))
}

/// Writes a file as a whole or not at all.
fn replace(path: &Path, write: impl FnOnce(&Path) -> io::Result<()>) -> Result<(), Failure> {
    atomic::replace(path, |file| write(file).map_err(|e| e.to_string()))
        .map_err(|e| Failure::Refused(e.to_string()))
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
