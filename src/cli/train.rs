//! `twintree train`: from a scene to a field file.

use super::console::Console;
use super::field_file::{self, Opened};
use super::guide_args::{LearnArgs, Teachers};
use super::input::Input;
use super::light_args::LightArgs;
use super::picture_args::SizeArgs;
use super::ray_args::RayArgs;
use super::scene_args::SceneArgs;
use super::waiting::Waiting;
use super::{Failure, learning, load, output, part_args, settings, targets};
use crate::camera::Camera;
use crate::film::Shard;
use crate::guide::FieldFile;
use crate::integrate::progress::Stop;
use crate::integrate::training::extend::{More, extend, to_file};
use crate::integrate::{GuidedSettings, View};
use crate::report::words;
use crate::scene::{Description, Scene};
use clap::Args;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `twintree train`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Guiding")]
pub struct TrainArgs {
    /// File to write [default: the scene's name with .field, in the current directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// Learn further: from records that this field does not know yet, over its structure as it is
    #[arg(long, value_name = "FILE",
          conflicts_with_all = ["batches", "guide_memory", "guide_model", "train"])]
    pub field: Option<PathBuf>,
    /// Learn from a share of these records, 0/4 to 3/4, into a field for "twintree merge-fields"
    #[arg(long, value_name = "I/N", value_parser = part_args::shard, requires = "field")]
    pub shard: Option<Shard>,
    /// How a field is learned.
    #[command(flatten)]
    pub learn: LearnArgs,
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Size of the picture that camera paths are for.
    #[command(flatten)]
    pub size: SizeArgs,
    /// Light transport.
    #[command(flatten)]
    pub light: LightArgs,
    /// Ray tracer.
    #[command(flatten)]
    pub rays: RayArgs,
}

/// Learns and writes.
///
/// # Errors
/// When the scene or the field to go on from cannot be used, or the file cannot be written.
pub fn run(args: &TrainArgs, console: &Console) -> Result<(), Failure> {
    let input = Input::of(&args.scene)?;
    let target = match &args.output {
        Some(path) => path.clone(),
        None => output::default_name(input.first_path(), args.shard, ".field")?,
    };
    targets::try_target(&target)?;
    let files = input.paths().into_iter();
    let files: Vec<_> = files.map(|path| ("what is learned from", path)).collect();
    targets::check_distinct(&[("-o", &target)], &files)?;
    let base = args.field.as_deref().map(Opened::read).transpose()?;
    let mut loaded = load::load(&args.scene, &input, None)?;
    settings::resize(&mut loaded.description.film, args.size);
    let fingerprint = loaded.fingerprint()?;
    if let Some(base) = &base {
        base.check(fingerprint)?;
    }
    let scene = loaded.build(&args.rays)?;
    let waiting = Waiting::for_learning(console, Some(records(args)));
    let file = learn(
        args,
        (&scene, &loaded.description),
        base.as_ref(),
        fingerprint,
        &|| false,
    )?;
    drop(waiting);
    field_file::write(&target, &file)
}

/// Learns the field of a scene with this fingerprint, or further over the structure of `base`. The
/// film of the description is of the size that is asked for. Where it is stopped, it has learned
/// from the first of the records.
///
/// # Errors
/// When nothing shines, or the base was learned with other settings.
pub fn learn(
    args: &TrainArgs,
    (scene, description): (&Scene, &Description),
    base: Option<&Opened>,
    fingerprint: u64,
    stop: Stop,
) -> Result<FieldFile, Failure> {
    if scene.lights.is_empty() {
        let help = "add an emitter to the scene";
        let message = "nothing shines: there is nothing to learn";
        return Err(Failure::wrong(message, help));
    }
    let film = &description.film;
    let mut settings =
        settings::path_settings(&args.light, &description.render, GuidedSettings::PLAIN);
    if let Some(base) = base {
        // Records follow those of the base: their numbers mean something for one seed only.
        settings.seed = base.file.trainer.settings().seed;
    }
    let view = View {
        scene,
        camera: &Camera::new(&description.camera, film.width, film.height),
        film,
        settings: &settings,
        guide: None,
    };
    match base {
        Some(base) => further(args, base, &view, stop),
        None => {
            let learned = learning::teach(&args.learn, &view, stop)?;
            let photons = settings::photons_alone(&args.learn);
            let how = settings::learn_settings(&args.learn, &settings, photons)?;
            Ok(to_file(&view, &how, learned, fingerprint))
        }
    }
}

/// Photons and paths that will be learned from.
pub fn records(args: &TrainArgs) -> u64 {
    let learn = &args.learn;
    let (photons, paths) = (learn.photons.unwrap_or(settings::PHOTONS), learn.paths);
    let all = match learn.train {
        Teachers::Photons => photons,
        Teachers::Paths => paths,
        Teachers::Both => photons.saturating_add(paths),
    };
    args.shard.map_or(all, |s| all / u64::from(s.count))
}

/// Learns further over the structure of a field.
fn further(args: &TrainArgs, base: &Opened, view: &View, stop: Stop) -> Result<FieldFile, Failure> {
    let start = Instant::now();
    let more = More {
        photons: args.learn.photons.unwrap_or(settings::PHOTONS),
        paths: args.learn.paths,
        share: args.shard.map(|s| (s.index, s.count)),
    };
    let photons = settings::photons_alone(&args.learn);
    let how = settings::learn_settings(&args.learn, view.settings, photons)?;
    let (file, counts) = extend(view, &how, &base.file, &more, stop)
        .map_err(|e| Failure::Wrong(format!("{}: {e}", base.path.display())))?;
    learning::warn_of_invalid_photons(&counts);
    tracing::info!(
        "learned further in {}",
        words::time(start.elapsed().as_secs_f64())
    );
    Ok(file)
}
