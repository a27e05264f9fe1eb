//! `twintree check`: is the scene all right?

use super::input::Input;
use super::load;
use super::scene_args::SceneArgs;
use super::{Failure, console};
use clap::Args;

/// Arguments of `twintree check`.
#[derive(Args, Debug)]
pub struct CheckArgs {
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
}

/// Loads the scene; its warnings are logged on the way, and so is what a render would say of its
/// lights.
///
/// # Errors
/// When the scene cannot be used.
pub fn run(args: &CheckArgs) -> Result<(), Failure> {
    let scene = args.scene.title();
    let mut loaded = load::load(&args.scene, &Input::of(&args.scene)?, None)?;
    let verdict = match loaded.check() {
        0 => "no warnings".to_owned(),
        1 => "1 warning".to_owned(),
        n => format!("{n} warnings"),
    };
    console::print_result(&format!("{scene}: {verdict}\n"))
}
