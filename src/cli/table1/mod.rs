//! `twintree table1`: Table 1 of Bus and Boubekeur 2017, made anew.
//!
//! Every method renders the same scenes at the same samples a pixel. Those that guide learn from
//! the same photons and nothing else, each cut into batches as suits it: mixtures take equal ones
//! as in the paper, the double hierarchy its own doubling ones. The last one learns as a render
//! does, from fewer of them and its own first samples. The methods take turns, so that a machine
//! that gets slower gets slower for all, and medians over the repeats count.

pub mod args;
mod reference;
mod subject;

use self::args::{METHODS, Method, Table1Args};
use self::subject::{Run, Subject};
use super::{Failure, console, output, targets, threads};
use crate::image::metrics::{Pair, errors::Errors, ssim};
use crate::image::{self, Image, WriteOptions};
use crate::report::table1::{Row, SceneTable, Table1};
use std::path::{Path, PathBuf};

/// The paper's scenes, as they lie in the repository.
const SCENES: [&str; 2] = ["scenes/pool/pool.xml", "scenes/door/door.xml"];
/// Where Debian's package puts them.
const INSTALLED: &str = "/usr/share/twintree";

/// Measures and prints.
///
/// # Errors
/// When a scene or a reference cannot be used, or a file cannot be written.
pub fn run(args: &Table1Args) -> Result<(), Failure> {
    let scenes = scenes(args)?;
    if let Some(path) = &args.json {
        targets::try_target(path)?;
    }
    if let Some(directory) = &args.output {
        std::fs::create_dir_all(directory)
            .map_err(|e| Failure::Refused(format!("{}: {e}", directory.display())))?;
    }
    let mut report = Table1 {
        version: env!("CARGO_PKG_VERSION").into(),
        threads: threads::count(),
        spp: args.spp,
        batches: args.batches,
        photons_per_batch: args.photons,
        reuse: args.reuse,
        repeats: args.repeats,
        seed: args.light.seed,
        scenes: Vec::new(),
    };
    for (i, scene) in scenes.iter().enumerate() {
        let given = args.references.get(i).map(PathBuf::as_path);
        report.scenes.push(measure(args, scene, given)?);
    }
    console::print_result(&report.to_table())?;
    output::write_if_wanted(args.json.as_deref(), &report.to_json())
}

/// The scenes asked for, or the paper's.
fn scenes(args: &Table1Args) -> Result<Vec<PathBuf>, Failure> {
    let scenes = match args.scenes.is_empty() {
        false => args.scenes.clone(),
        true => SCENES.iter().map(found).collect::<Result<_, _>>()?,
    };
    let count = args.references.len();
    if count != 0 && count != scenes.len() {
        return Err(Failure::wrong(
            format!("{count} references do not fit {} scenes", scenes.len()),
            "give --reference once for each scene, in their order, or not at all",
        ));
    }
    Ok(scenes)
}

fn found(scene: &&str) -> Result<PathBuf, Failure> {
    let places = [PathBuf::from(scene), Path::new(INSTALLED).join(scene)];
    let there = places.into_iter().find(|p| p.exists());
    there.ok_or_else(|| {
        Failure::wrong(
            format!("{scene} is not here"),
            "run it where the project's scenes/ lies, or name scenes with --scene FILE",
        )
    })
}

/// All methods on one scene.
fn measure(args: &Table1Args, scene: &Path, given: Option<&Path>) -> Result<SceneTable, Failure> {
    let subject = Subject::load(args, scene)?;
    let (reference, kept) = match given {
        Some(path) => (image::read_linear(path)?, path.to_owned()),
        None => reference::rendered(args, &subject)?,
    };
    let mut runs: Vec<Vec<Row>> = vec![Vec::new(); args.methods.len()];
    for repeat in 0..args.repeats {
        for (method, rows) in args.methods.iter().zip(&mut runs) {
            let run = subject.run(*method, repeat)?;
            let row = row(*method, &run, &reference, &kept, &subject)?;
            tracing::info!(
                "{}, {} of {}: {}, RMSE {:.4}, {:.1} s and {:.1} s",
                subject.name(),
                repeat + 1,
                args.repeats,
                METHODS.word(method),
                row.rmse,
                row.preprocessing_seconds,
                row.render_seconds
            );
            rows.push(row);
            if repeat + 1 == args.repeats {
                picture(args, &subject, METHODS.word(method), &run.image)?;
            }
        }
    }
    picture(args, &subject, "reference", &reference)?;
    let film = subject.film();
    Ok(SceneTable {
        scene: scene.display().to_string(),
        name: subject.name().to_owned(),
        width: film.width,
        height: film.height,
        reference: kept.display().to_string(),
        rows: runs.iter().map(|rows| Row::median(rows)).collect(),
    })
}

fn row(
    method: Method,
    run: &Run,
    reference: &Image,
    kept: &Path,
    subject: &Subject,
) -> Result<Row, Failure> {
    let pair = Pair::new(&run.image, reference).map_err(|e| {
        let message = format!("{} does not fit: {e}", kept.display());
        Failure::wrong(message, "give a reference of the same size")
    })?;
    let errors = Errors::of(&pair);
    Ok(Row {
        method: METHODS.word(&method),
        l1: errors.l1,
        rmse: errors.rmse(),
        relmse: errors.rel_mse,
        relmse_trimmed: errors.rel_mse_trimmed,
        ssim: ssim::ssim(&pair.shown(subject.film().exposure), 1.0),
        mean_ratio: errors.mean_ratio,
        memory_bytes: run.memory_bytes,
        training_bytes: run.training_bytes,
        preprocessing_seconds: run.preprocessing.as_secs_f64(),
        render_seconds: run.rendering.as_secs_f64(),
        total_seconds: (run.preprocessing + run.rendering).as_secs_f64(),
    })
}

/// Keeps a picture, if that was asked for.
fn picture(args: &Table1Args, subject: &Subject, what: &str, image: &Image) -> Result<(), Failure> {
    let Some(directory) = &args.output else {
        return Ok(());
    };
    let path = directory.join(format!("{}-{what}.png", subject.name()));
    let options = WriteOptions {
        exposure: subject.film().exposure,
        ..WriteOptions::default()
    };
    image::write(&path, image, &options).map_err(|e| Failure::Refused(e.to_string()))
}
