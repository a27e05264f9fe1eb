//! `twintree info`: what is in a scene.

use super::input::Input;
use super::load;
use super::scene_args::SceneArgs;
use super::{Failure, console};
use crate::report::left_out::left_out;
use crate::report::scene::SceneReport;
use clap::Args;

/// Arguments of `twintree info`.
#[derive(Args, Debug)]
pub struct InfoArgs {
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Print JSON
    #[arg(long)]
    pub json: bool,
}

/// Loads the scene and prints what is in it.
///
/// # Errors
/// When the scene cannot be used.
pub fn run(args: &InfoArgs) -> Result<(), Failure> {
    let loaded = load::load(&args.scene, &Input::of(&args.scene)?, None)?;
    let scene = args.scene.title();
    let mut report = SceneReport::of(&scene, &loaded.description, loaded.textures());
    report.left_out = left_out(&loaded.description, loaded.textures(), loaded.trimmed);
    let text = if args.json {
        report.to_json()
    } else {
        report.to_table()
    };
    console::print_result(&text)
}
