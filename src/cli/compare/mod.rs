//! `twintree compare`: how far images are from a reference.

pub mod args;
mod drawings;

use self::args::{CompareArgs, LimitArgs};
use self::drawings::Drawings;
use super::{Failure, console, output, targets};
use crate::image::file::ImageFile;
use crate::image::metrics::blocks::KnownNoise;
use crate::image::metrics::{Pair, errors, fireflies, flip, ssim, ztest};
use crate::image::windows::same_part;
use crate::image::{self, Image, PixelType};
use crate::report::compare::{Comparison, ImageErrors, Z};
use std::borrow::Cow;
use std::path::Path;

/// Compares, prints the table, writes what was asked for.
///
/// # Errors
/// When an image cannot be read or is of another size, a file cannot be written, or a limit is
/// passed.
pub fn run(args: &CompareArgs) -> Result<(), Failure> {
    let mut drawings = args.output.as_deref().map(Drawings::plan).transpose()?;
    if let Some(path) = &args.json {
        targets::try_target(path)?;
    }
    check_files(args)?;
    let reference = image::read_linear(&args.reference)?;
    let mut report = Comparison {
        version: env!("CARGO_PKG_VERSION").into(),
        reference: args.reference.display().to_string(),
        width: reference.width,
        height: reference.height,
        reference_not_finite: 0,
        flip_kind: flip_kind(&args.reference)?,
        data_range: args.data_range,
        exposure: args.exposure,
        images: Vec::new(),
        passed: Vec::new(),
    };
    for path in &args.images {
        let image = image::read_linear(path)?;
        let (image, reference) =
            same_part(&image, &reference).map_err(|e| incomparable(path, &args.reference, &e))?;
        for cut in [&image, &reference] {
            if let Cow::Owned(part) = cut {
                tracing::info!("{}: compared are {}", path.display(), part.place());
            }
        }
        let pair =
            Pair::new(&image, &reference).map_err(|e| incomparable(path, &args.reference, &e))?;
        report.reference_not_finite = pair.reference_not_finite();
        let (errors, flip) = measure(path, &pair, args, report.flip_kind);
        let z = z_test(&pair, &image, &reference);
        let errors = ImageErrors { z, ..errors };
        report.passed.extend(passed(&errors, &args.limits));
        report.images.push(errors);
        if let Some(drawings) = &mut drawings {
            drawings.add(path, &pair.shown(args.exposure), &pair, &flip)?;
        }
    }
    console::print_result(&report.to_table())?;
    warn_of_numbers(&report);
    output::write_if_wanted(args.json.as_deref(), &report.to_json())?;
    drawings.map_or(Ok(()), Drawings::finish)?;
    if report.passed.is_empty() {
        return Ok(());
    }
    Err(Failure::Passed(report.passed.join("\nerror: ")))
}

/// Refuses files that would replace each other, or what is compared.
fn check_files(args: &CompareArgs) -> Result<(), Failure> {
    let written = targets::named(&[
        ("--json", args.json.as_deref()),
        ("-o", args.output.as_deref()),
    ]);
    let images = args.images.iter();
    let mut read: Vec<_> = images
        .map(|path| ("one of the images", path.as_path()))
        .collect();
    read.push(("the reference", &args.reference));
    targets::check_distinct(&written, &read)
}

/// Pictures of integers are made for a screen; floats are high dynamic range.
fn flip_kind(reference: &Path) -> Result<&'static str, Failure> {
    let stored = ImageFile::open(reference)?.header().pixel_type;
    Ok(match stored {
        PixelType::U8 | PixelType::U16 => "ldr",
        PixelType::Half | PixelType::Float => "hdr",
    })
}

fn incomparable(path: &Path, reference: &Path, why: &dyn std::error::Error) -> Failure {
    let (image, reference) = (path.display(), reference.display());
    Failure::wrong(
        format!("{image} cannot be compared with {reference}: {why}"),
        "render both at the same --width and --crop",
    )
}

/// All numbers but the z-test, and the map of FLIP errors. `kind` is `hdr` or `ldr`, whichever FLIP is
/// to be computed.
pub fn measure(
    path: &Path,
    pair: &Pair,
    args: &CompareArgs,
    kind: &str,
) -> (ImageErrors, Vec<f32>) {
    let shown = pair.shown(args.exposure);
    let (subject, range) = match args.data_range {
        Some(range) => (pair, range),
        None => (&shown, 1.0),
    };
    let map = if kind == "ldr" {
        flip::ldr(&shown)
    } else {
        flip::hdr(pair)
    };
    let plain = errors::Errors::of(pair);
    let [relmse_4x4, relmse_16x16] = plain.rel_mse_of_blocks;
    let errors = ImageErrors {
        image: path.display().to_string(),
        l1: plain.l1,
        mse: plain.mse,
        rmse: plain.rmse(),
        relmse: plain.rel_mse,
        relmse_trimmed: plain.rel_mse_trimmed,
        relmse_4x4,
        relmse_16x16,
        ssim: ssim::ssim(subject, range),
        psnr: errors::psnr(subject, range),
        flip: flip::mean(&map),
        mean_ratio: plain.mean_ratio,
        mean_ratio_rgb: plain.mean_ratio_rgb,
        fireflies: fireflies::count(pair),
        not_finite: pair.not_finite(),
        z: None,
    };
    (errors, map)
}

/// The z-test, where both images carry the variance of their pixels.
pub fn z_test(pair: &Pair, image: &Image, reference: &Image) -> Option<Z> {
    let known = [KnownNoise::of(image)?, KnownNoise::of(reference)?];
    let test = ztest::ztest(pair, [&known[0], &known[1]])?;
    Some(Z {
        inside: test.inside,
        of_mean: test.of_mean,
        deviations: test.deviations,
    })
}

/// A sentence for each limit that the image passes.
fn passed(of: &ImageErrors, limits: &LimitArgs) -> Vec<String> {
    let mut found = Vec::new();
    let above = [
        ("relMSE", of.relmse, limits.max_relmse),
        ("RMSE", of.rmse, limits.max_rmse),
        ("FLIP", of.flip, limits.max_flip),
    ];
    for (name, value, limit) in above {
        if let Some(limit) = limit.filter(|limit| value > *limit) {
            found.push(format!("{}: {name} {value} is above {limit}", of.image));
        }
    }
    if let Some(limit) = limits.min_ssim {
        match of.ssim {
            Some(value) if value >= limit => {}
            Some(value) => found.push(format!("{}: SSIM {value} is below {limit}", of.image)),
            None => found.push(format!(
                "{}: has no SSIM, it is below 7 x 7 pixels",
                of.image
            )),
        }
    }
    let asked = above.iter().any(|a| a.2.is_some()) || limits.min_ssim.is_some();
    if asked && of.not_finite > 0 {
        found.push(format!(
            "{}: {} pixels are not finite",
            of.image, of.not_finite
        ));
    }
    found
}

fn warn_of_numbers(report: &Comparison) {
    for image in report.images.iter().filter(|i| i.not_finite > 0) {
        let (name, n) = (&image.image, image.not_finite);
        tracing::warn!("{name}: {n} pixels have a NaN or an infinity and count as black");
    }
    if report.reference_not_finite > 0 {
        let (name, n) = (&report.reference, report.reference_not_finite);
        tracing::warn!("{name}: {n} pixels have a NaN or an infinity; no error is counted there");
    }
}
