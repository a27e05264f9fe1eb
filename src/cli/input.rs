//! What the words of the command line name: a scene file, or models, and whether the options beside
//! them have a meaning there.

use super::Failure;
use super::scene_args::{SceneArgs, StudioArgs, UpAxis};
use crate::scene::import::models::{ModelKind, ModelSource};
use std::path::{Path, PathBuf};

/// What the words of the command line name.
#[derive(Debug)]
pub enum Input {
    /// A scene file.
    Scene(PathBuf),
    /// Models.
    Models(Vec<ModelSource>),
}

impl Input {
    /// Decides what is to be loaded.
    ///
    /// # Errors
    /// When scenes and models are mixed, options do not go with what is named, or the steps behind
    /// a model make no sense.
    pub fn of(args: &SceneArgs) -> Result<Self, Failure> {
        let mut sources = Vec::new();
        for word in &args.files {
            // A name that is no text has no steps behind it.
            let source = match word.to_str() {
                Some(text) => text.parse().map_err(|e| {
                    Failure::wrong(
                        format!("{text}: {e}"),
                        "steps are as in a.ply@translate=1,0,0;scale=2",
                    )
                })?,
                None => ModelSource::new(PathBuf::from(word)),
            };
            sources.push(source);
        }
        let is_model = |s: &ModelSource| ModelKind::from_path(&s.path).is_some();
        match (args.files.as_slice(), sources.as_slice()) {
            ([scene], [source]) if !is_model(source) => {
                check_no_studio(&args.studio, Path::new(scene))?;
                Ok(Self::Scene(scene.into()))
            }
            _ => {
                check_no_defines(args)?;
                Ok(Self::Models(sources))
            }
        }
    }

    /// The files that are named.
    pub fn paths(&self) -> Vec<&Path> {
        match self {
            Self::Scene(path) => vec![path],
            Self::Models(sources) => sources.iter().map(|s| s.path.as_path()).collect(),
        }
    }

    /// The file that outputs are named after.
    pub fn first_path(&self) -> &Path {
        match self {
            Self::Scene(path) => path,
            Self::Models(sources) => sources.first().map_or(Path::new(""), |s| &s.path),
        }
    }
}

/// A scene has its own camera and light.
fn check_no_studio(args: &StudioArgs, scene: &Path) -> Result<(), Failure> {
    let options = [
        ("--camera", args.camera.is_some()),
        ("--look-at", args.look_at.is_some()),
        ("--fov", args.fov.is_some()),
        ("--projection", args.projection.is_some()),
        ("--aperture", args.aperture.is_some()),
        ("--sky", args.sky.is_some()),
        ("--envmap", args.envmap.is_some()),
        ("--ground", args.ground.is_some()),
        ("--material", args.material.is_some()),
        ("--variant", args.variant.is_some()),
        ("--at", args.at.is_some()),
        ("--up", args.up != UpAxis::Y),
    ];
    let Some((name, _)) = options.iter().find(|o| o.1) else {
        return Ok(());
    };
    Err(Failure::wrong(
        format!("{name} is for models, and {} is a scene", scene.display()),
        "models end with .ply .obj .stl .gltf .glb; in a scene, the camera and the lights are its own",
    ))
}

/// Models have no keys to define.
///
/// # Errors
/// When there are any.
pub(super) fn check_no_defines(args: &SceneArgs) -> Result<(), Failure> {
    match args.read.define.first() {
        None => Ok(()),
        Some(first) => Err(Failure::wrong(
            format!(
                "-D {}: only Mitsuba's scenes have keys to define",
                first.name
            ),
            "-D goes with a scene (.xml)",
        )),
    }
}
