//! Converged images to measure errors against.

use super::args::Table1Args;
use super::subject::{DOUBLING_BATCHES, Subject, samples};
use crate::cli::Failure;
use crate::cli::guide_args::PATHS;
use crate::film::{Layers, Metadata};
use crate::guide::ModelKind;
use crate::image::{self, Image, PixelType, WriteOptions};
use crate::integrate::training::{LearnSettings, Learner};
use crate::report::words;
use std::path::PathBuf;
use std::time::Instant;

/// Samples of a reference for each of an image.
const TIMES: u64 = 16;
/// Sets a reference's random numbers apart from those of the images.
const APART: u64 = 0xa076_1d64_78bd_642f;

/// A reference of the program's own and where it is kept: from there, if it is there already. It is
/// guided by all that the program can learn, which does not change its mean.
pub fn rendered(args: &Table1Args, subject: &Subject) -> Result<(Image, PathBuf), Failure> {
    let spp = args
        .reference_spp
        .unwrap_or_else(|| args.spp.saturating_mul(TIMES));
    let film = subject.film();
    let (width, height) = (film.width, film.height);
    let (name, identity) = (subject.name(), subject.identity());
    let file = format!("{name}-{width}x{height}-{spp}spp-{identity:016x}.exr");
    let path = args.cache.join(file);
    if path.exists() {
        tracing::info!("the reference is {}", path.display());
        return Ok((image::read_linear(&path)?, path));
    }
    crate::cli::targets::try_target(&path)?;
    let start = Instant::now();
    tracing::info!("rendering a reference of {spp} samples a pixel");
    let settings = subject.settings(subject.seed() ^ APART);
    let view = subject.view(&settings);
    let how = LearnSettings {
        paths: PATHS,
        ..subject.learning(&settings, DOUBLING_BATCHES, ModelKind::Constant)
    };
    let learner = Learner::new(&view, &how)?;
    let (film, _) = subject.draw_learning(&view, learner, &samples(spp));
    let metadata = Metadata {
        scene: name.to_owned(),
        settings: format!("reference of table1, seed {}", settings.seed),
        spp,
        seconds: start.elapsed().as_secs_f64(),
    };
    let picture = film.image(Layers::NONE, &metadata);
    let options = WriteOptions {
        pixel_type: Some(PixelType::Float),
        ..WriteOptions::default()
    };
    image::write(&path, &picture, &options).map_err(|e| Failure::Refused(e.to_string()))?;
    tracing::info!(
        "wrote {} in {}",
        path.display(),
        words::time(start.elapsed().as_secs_f64())
    );
    Ok((picture, path))
}
