//! `twintree merge`: from the parts of an image to the image.
//!
//! Parts bring whole tiles, so that merging adds nothing and the order of the parts does not
//! matter. They are read one after the other: the film is in memory once.

use super::Failure;
use super::aov::Aov;
use super::console::Console;
use super::denoising::Denoising;
use super::file_args::FileArgs;
use super::interrupt::Interrupt;
use super::output::{self, Outputs};
use super::{aov, memory, settings};
use crate::film::Film;
use crate::film::Metadata;
use crate::film::part::{PartReader, Record};
use crate::film::shard::Deal;
use crate::report::stats::Stats;
use clap::{Args, ValueEnum};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

/// Arguments of `twintree merge`.
#[derive(Args, Debug)]
pub struct MergeArgs {
    /// Part files, in any order; checkpoints too, with --partial
    #[arg(required = true)]
    pub parts: Vec<PathBuf>,
    /// Files.
    #[command(flatten)]
    pub files: FileArgs,
    /// Write what there is: what is missing stays black
    #[arg(long)]
    pub partial: bool,
}

/// A part's name and record.
type Known = (PathBuf, Record);

/// Joins parts and writes images.
///
/// # Errors
/// When a part is damaged or of another image, parts overlap or are missing, or an image cannot be
/// written.
pub fn run(args: &MergeArgs, console: &Console, interrupt: &Interrupt) -> Result<(), Failure> {
    let start = Instant::now();
    let mut parts: Vec<Known> = Vec::new();
    for path in &args.parts {
        let record = PartReader::open(path)?.record().clone();
        if let Some(first) = parts.first() {
            compare(first, &(path.clone(), record.clone()))?;
        }
        parts.push((path.clone(), record));
    }
    let Some((_, first)) = parts.first() else {
        return Err(Failure::Wrong("there are no parts to merge".into()));
    };
    let outputs = Outputs::plan(&args.files, Path::new(&first.origin.scene), None)?;
    outputs.spare("one of the parts", &args.parts)?;
    output::load_library()?;
    let denoising = Denoising::wanted(&args.files, console, interrupt)?;
    check_layers(args, first)?;
    settings::check_memory(first.region, &first.extras)?;
    let film = read(&parts)?;
    let missing = missing(&parts, &film);
    if let Some(missing) = &missing {
        if !args.partial {
            return Err(Failure::wrong(
                format!("the image is not complete: {missing}"),
                "render what is missing, or write what there is with --partial",
            ));
        }
        tracing::warn!("the image is not complete: {missing}");
    }
    let load = start.elapsed().as_secs_f64();
    let files = (&outputs, denoising.as_ref());
    write(args, files, &parts, &film, missing, load)
}

/// Refuses a part of another image than the first one's.
fn compare((first, ours): &Known, (path, theirs): &Known) -> Result<(), Failure> {
    let (here, there) = (
        format!("in {}", first.display()),
        format!("in {}", path.display()),
    );
    let mut differences = ours.identity.differences(&here, &theirs.identity, &there);
    if differences.is_empty() && (ours.region, ours.frame) != (theirs.region, theirs.frame) {
        differences.push("the regions of the film differ".into());
    }
    if ours.goal != theirs.goal {
        let goal = |r: &Record| r.goal.map_or("not set".into(), |n| n.to_string());
        differences.push(format!(
            "--spp is {} {here} and {} {there}",
            goal(ours),
            goal(theirs)
        ));
    }
    if differences.is_empty() {
        return Ok(());
    }
    Err(Failure::wrong(
        format!(
            "{} and {} are not parts of one image: {}",
            first.display(),
            path.display(),
            differences.join("; ")
        ),
        "merge parts of one scene, rendered with the same settings by the same program",
    ))
}

/// Refuses layers that parts have only if they were asked for.
fn check_layers(args: &MergeArgs, first: &Record) -> Result<(), Failure> {
    let missing = aov::missing(&args.files.aov, &first.extras);
    let names: Vec<_> = missing.iter().filter_map(Aov::to_possible_value).collect();
    let names: Vec<&str> = names.iter().map(|name| name.get_name()).collect();
    if names.is_empty() {
        return Ok(());
    }
    let names = names.join(",");
    Err(Failure::wrong(
        format!("--aov {names}: the parts do not have it"),
        format!("render the shards with --aov {names}, too"),
    ))
}

/// Reads all parts into one film.
fn read(parts: &[Known]) -> Result<Film, Failure> {
    let first = parts.first().map(|(_, record)| record);
    let (region, extras) = first.map_or_else(Default::default, |record| {
        (record.region, record.extras.clone())
    });
    let vacant = Film::vacant_with(region, Arc::new(extras));
    let mut film = vacant.framed(first.and_then(|record| record.frame));
    let mut owners: Vec<Option<usize>> = vec![None; film.tiles().len()];
    for (k, (path, record)) in parts.iter().enumerate() {
        let mut taken = |tile: usize| {
            let Some(other) = owners[tile].replace(k) else {
                return Ok(());
            };
            let (name, shard) = (parts[other].0.display(), parts[other].1.shard);
            Err(format!(
                "the part, shard {}, overlaps with {name}, shard {shard}: leave one out",
                record.shard
            ))
        };
        PartReader::open(path)?.read_into(&mut film, &mut taken)?;
    }
    Ok(film)
}

/// What is missing, in words.
fn missing(parts: &[Known], film: &Film) -> Option<String> {
    let mut words = Vec::new();
    let tiles = film.tiles();
    let gaps: Vec<usize> = (0..tiles.len()).filter(|&i| !tiles[i].is_held()).collect();
    if let Some(&first) = gaps.first() {
        words.push(
            missing_shards(parts, &gaps, tiles.len()).unwrap_or_else(|| {
                let (x, y) = (tiles[first].x0, tiles[first].y0);
                format!(
                    "{} of {} tiles are missing, the first at pixel {x},{y}",
                    gaps.len(),
                    tiles.len()
                )
            }),
        );
    }
    let goal = parts.first().and_then(|(_, record)| record.goal);
    let done = film.spp_done();
    match goal {
        Some(goal) if done < goal => {
            words.push(format!(
                "only {done} of {goal} samples were taken somewhere"
            ));
        }
        None => words.push("the render has not come to its end".into()),
        _ => {}
    }
    (!words.is_empty()).then(|| words.join("; "))
}

/// The missing shards by number, where all parts are shards of one deal.
fn missing_shards(parts: &[Known], gaps: &[usize], tiles: usize) -> Option<String> {
    let count = parts.first()?.1.shard.count;
    if parts.iter().any(|(_, record)| record.shard.count != count) {
        return None;
    }
    let deal = Deal::new(tiles, count);
    let mut list: Vec<u32> = gaps.iter().map(|&tile| deal.owner(tile)).collect();
    list.sort_unstable();
    list.dedup();
    let names: Vec<String> = list.iter().map(|i| format!("{i}/{count}")).collect();
    let verb = if names.len() == 1 { "shard" } else { "shards" };
    Some(format!("{verb} {} missing", names.join(", ")))
}

fn write(
    args: &MergeArgs,
    (outputs, denoising): (&Outputs, Option<&Denoising>),
    parts: &[Known],
    film: &Film,
    missing: Option<String>,
    load: f64,
) -> Result<(), Failure> {
    let mut stats = measure(parts, film, missing.is_some());
    stats.load_seconds = load;
    let Some((_, first)) = parts.first() else {
        return Ok(());
    };
    let mut words = first.origin.words.clone();
    if let Some(missing) = missing {
        words += &format!(" (not complete: {missing})");
    }
    let metadata = Metadata {
        scene: first.origin.scene.clone(),
        settings: words,
        spp: stats.spp,
        seconds: stats.render_seconds,
    };
    let exposure = args.files.exposure.unwrap_or(first.origin.exposure);
    let mut picture = film.image(args.files.layers(), &metadata);
    let start = Instant::now();
    let mut denoised = Ok(());
    if let Some(denoising) = denoising {
        (picture, denoised) = denoising.apply(picture, false);
        stats.denoise_seconds = start.elapsed().as_secs_f64();
    }
    let start = Instant::now();
    let written = outputs.write_images(&picture, &args.files.exr, exposure, &args.files.view.view);
    stats.write_seconds = start.elapsed().as_secs_f64();
    stats.peak_memory_bytes = memory::peak_bytes();
    outputs.write_stats(&stats.to_json())?;
    written.and(denoised)
}

/// The measurements of all parts together: times, rays and threads are sums over the machines.
fn measure(parts: &[Known], film: &Film, partial: bool) -> Stats {
    let origins = || parts.iter().map(|(_, record)| &record.origin);
    let first = origins().next().cloned().unwrap_or_default();
    let seconds: f64 = origins().map(|o| o.seconds).sum();
    let rays: u64 = origins().map(|o| o.rays).sum();
    let settings = parts
        .first()
        .map(|(_, record)| record.identity.settings.clone());
    let settings = settings.unwrap_or_default().into_iter().collect();
    let noise = film.noise();
    let samples = film.held().flat_map(|t| &t.pixels).map(|p| p.count).sum();
    // Parts of no time at all have no rate to speak of, and must not divide by zero.
    let per_second = |n: u64| n as f64 / seconds.max(1e-9);
    Stats {
        version: env!("CARGO_PKG_VERSION").into(),
        scene: first.scene,
        width: film.width(),
        height: film.height(),
        seed: first.seed,
        settings,
        threads: origins().map(|o| o.threads).sum(),
        accel: first.accel,
        stopped_by: if partial { "interrupt" } else { "samples" },
        spp: film.spp_done(),
        samples,
        samples_per_second: per_second(samples),
        rays,
        rays_per_second: per_second(rays),
        noise: noise.map(|n| n.value),
        noise_error: noise.map(|n| n.error),
        noise_worst: noise.map(|n| n.worst),
        invalid_samples: film.invalid_samples(),
        render_seconds: seconds,
        triangles: first.triangles,
        // The parts do not tell what loading, building and learning took.
        ..Stats::default()
    }
}
