//! How cost grows with the size of a mesh: `twintree bench scale` makes one shape at sizes four
//! times apart, reads each from its file, builds the ray tracers over it and traces.
//!
//! The floor that reading is held to is what nobody can do without: the file read from one end to
//! the other, and arrays of the mesh's size filled. Loading then looks for triangles without area
//! and makes the normals that the file does not have.

use super::args::BenchScaleArgs;
use super::rays::{Kind, RaySets};
use super::subject::Subject;
use super::{backends, rate};
use crate::accel::{self, Backend, BuildSettings, World};
use crate::cli::budget::{self, Load};
use crate::cli::input::Input;
use crate::cli::make::{SHAPES, check_size};
use crate::cli::ray_args::AccelBuild;
use crate::cli::scene_args::{ReadArgs, SceneArgs};
use crate::cli::{Failure, console, load, memory, output, targets, threads};
use crate::image::passing::Passing;
use crate::make::{Pattern, write_ply};
use crate::report::scale::{ScaleBench, SizeRow, TracerRow};
use crate::report::scale_plot;
use crate::scene::import::mesh::{self, MeshKind, MeshOptions};
use std::hint::black_box;
use std::io::Read;
use std::path::Path;
use std::time::Instant;

/// Each size is so many times the one before.
const STEP: u64 = 4;
/// Bytes that are read at once, as `cat` does.
const PIECE: usize = 128 << 10;
/// Loads of small files are repeated until they took so long; the fastest counts.
const REPEAT_SECONDS: f64 = 0.2;

/// Measures every size, prints the table, writes the files.
///
/// # Errors
/// When a directory cannot be written to, or memory does not suffice.
pub fn run(args: &BenchScaleArgs) -> Result<(), Failure> {
    for path in [&args.rates.json, &args.svg].into_iter().flatten() {
        targets::try_target(path)?;
    }
    let make = || match &args.directory {
        Some(path) => tempfile::tempdir_in(path),
        None => tempfile::tempdir(),
    };
    let (directory, _passing) = Passing::make(make).map_err(|e| {
        Failure::refused(
            format!("no directory can be made for the meshes: {e}"),
            "--directory names one with room for 20 bytes a triangle",
        )
    })?;
    let mut report = ScaleBench {
        version: env!("CARGO_PKG_VERSION").into(),
        shape: SHAPES.word(&args.kind).into(),
        threads: threads::count(),
        sizes: Vec::new(),
    };
    let file = directory.path().join("mesh.ply");
    for triangles in sizes(args.least, args.most) {
        report.sizes.push(measure(args, triangles, &file)?);
        tracing::info!("{} of {} triangles", triangles, args.most);
    }
    console::print_result(&report.to_table())?;
    output::write_if_wanted(args.rates.json.as_deref(), &report.to_json())?;
    let Some(path) = &args.svg else {
        return Ok(());
    };
    let drawn = scale_plot::draw(&report).map_err(Failure::Refused)?;
    output::write_file(path, &drawn)
}

/// From `least` in steps of [`STEP`], and `most` at the end.
fn sizes(least: u64, most: u64) -> Vec<u64> {
    let steps = std::iter::successors(Some(least), |n| n.checked_mul(STEP));
    let mut list: Vec<u64> = steps.take_while(|n| *n < most).collect();
    list.push(most);
    list
}

fn measure(args: &BenchScaleArgs, triangles: u64, file: &Path) -> Result<SizeRow, Failure> {
    let pattern = Pattern::new(args.kind, triangles);
    check_size(&pattern)?;
    write_ply(&pattern, file).map_err(|e| {
        Failure::refused(
            format!("{} cannot be written: {e}", file.display()),
            "--directory names another place",
        )
    })?;
    let file_bytes = std::fs::metadata(file).map_or(0, |m| m.len());
    let scene = SceneArgs::of(file, &ReadArgs::default());
    let input = Input::of(&scene)?;
    let floor_seconds = fastest(|| floor(file, &pattern))?;
    let read_seconds = fastest(|| timed(|| arrays(file)))?;
    let load_seconds = fastest(|| timed(|| load::load_unlit(&scene, &input).map(drop)))?;
    let subject = Subject::load(&scene)?;
    let sets = RaySets::of(&subject, args.rates.rays)?;
    let mesh_bytes = subject.geometry_bytes;
    // The tree that told where rays begin makes room for those that are measured.
    let world = subject.world;
    drop(subject.scene);
    let mut row = SizeRow {
        triangles: pattern.triangles(),
        vertices: pattern.vertices(),
        file_bytes,
        mesh_bytes,
        floor_seconds,
        read_seconds,
        load_seconds,
        tracers: Vec::new(),
    };
    for backend in backends(&args.rates.accel) {
        let tracer = tracer(args, backend, &world, &sets, row.triangles)?;
        row.tracers.extend(tracer);
    }
    Ok(row)
}

/// A ray tracer over the mesh; `None` where memory does not suffice for it.
fn tracer(
    args: &BenchScaleArgs,
    backend: Backend,
    world: &World,
    sets: &RaySets,
    triangles: u64,
) -> Result<Option<TracerRow>, Failure> {
    let load = Load {
        triangles,
        instances: 0,
    };
    let way = Some(AccelBuild::Balanced);
    if let Err(refusal) = budget::choose(way, backend, load, memory::available_bytes()) {
        tracing::warn!("{}", refusal.text().unwrap_or_default());
        return Ok(None);
    }
    let settings = BuildSettings {
        threads: threads::count(),
        ..BuildSettings::default()
    };
    let start = Instant::now();
    let tracer = accel::build(world.clone(), settings, None, backend)?;
    let build_seconds = start.elapsed().as_secs_f64();
    let of = |kind| rate(&*tracer, sets.of_kind(kind), kind, args.rates.seconds, true);
    Ok(Some(TracerRow {
        name: tracer.name(),
        build_seconds,
        memory_bytes: tracer.memory_bytes() as u64,
        camera: of(Kind::Camera),
        shadow: of(Kind::Shadow),
        diffuse: of(Kind::Diffuse),
    }))
}

/// Runs `job` again while it is quick; the fewest seconds.
fn fastest(mut job: impl FnMut() -> Result<f64, Failure>) -> Result<f64, Failure> {
    let mut least = job()?;
    let mut total = least;
    while total < REPEAT_SECONDS {
        let seconds = job()?;
        least = least.min(seconds);
        total += seconds;
    }
    Ok(least)
}

fn timed(job: impl FnOnce() -> Result<(), Failure>) -> Result<f64, Failure> {
    let start = Instant::now();
    job()?;
    Ok(start.elapsed().as_secs_f64())
}

/// Brings the file's arrays into memory.
fn arrays(file: &Path) -> Result<(), Failure> {
    let read = mesh::buffers(file, MeshKind::Ply, &MeshOptions::default());
    black_box(read.map_err(|e| Failure::Refused(e.to_string()))?);
    Ok(())
}

/// Seconds to read the file in pieces and to fill new arrays with as much as the mesh has.
fn floor(file: &Path, pattern: &Pattern) -> Result<f64, Failure> {
    let source = vec![1u8; PIECE];
    timed(|| {
        let mut piece = vec![0u8; PIECE];
        read_through(file, &mut piece).map_err(|e| Failure::Refused(e.to_string()))?;
        for rows in [pattern.vertices(), pattern.triangles()] {
            let bytes = 12 * rows as usize;
            let mut array = Vec::with_capacity(bytes);
            while array.len() < bytes {
                array.extend_from_slice(&source[..PIECE.min(bytes - array.len())]);
            }
            black_box(&array);
        }
        Ok(())
    })
}

fn read_through(file: &Path, piece: &mut [u8]) -> std::io::Result<()> {
    let mut open = crate::image::regular::open(file)?;
    while open.read(piece)? > 0 {
        black_box(&piece);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_go_up_by_fours_and_end_where_asked() {
        assert_eq!(sizes(1000, 64_000), [1000, 4000, 16_000, 64_000]);
        assert_eq!(sizes(1000, 50_000), [1000, 4000, 16_000, 50_000]);
        assert_eq!(sizes(1000, 1000), [1000]);
        assert_eq!(sizes(5000, 1000), [1000]);
    }
}
