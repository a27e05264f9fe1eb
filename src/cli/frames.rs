//! `--frames`: a sequence of images by one command.
//!
//! A run of `#` in a name stands for the number of the frame, with as many digits at least: in the
//! scene's name, in those of outputs, and in the values of `-D`. A scene of one file gets the
//! number as `$frame`. Each frame has a seed of its own: noise that stood still would look like dirt
//! on the lens, and a field must not be learned from the very samples that it then guides.

use super::frame_list::{FrameList, numbered};
use super::input::Input;
use super::interrupt::Interrupt;
use super::output::Outputs;
use super::render_args::RenderArgs;
use super::scene_args::Definition;
use super::{Failure, output};
use crate::report::words;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Digits of a frame in a name that the program makes.
const DIGITS: &str = "####";

/// The same of a file. Names that are no text have no number.
fn numbered_file(path: &Path, frame: u32) -> Option<PathBuf> {
    Some(numbered(path.to_str()?, frame)?.into())
}

/// The command line of one frame.
///
/// # Errors
/// When frames would be written over each other.
fn of_frame(args: &RenderArgs, frame: u32) -> Result<RenderArgs, Failure> {
    let mut one = args.clone();
    let mut differs = false;
    for file in &mut one.scene.files {
        if let Some(name) = file.to_str().and_then(|name| numbered(name, frame)) {
            (*file, differs) = (OsString::from(name), true);
        }
    }
    for define in &mut one.scene.read.define {
        if let Some(value) = numbered(&define.value, frame) {
            (define.value, differs) = (value, true);
        }
    }
    if !differs {
        one.scene.read.define.push(Definition {
            name: "frame".into(),
            value: frame.to_string(),
        });
    }
    if one.files.output.is_empty() {
        one.files.output = vec![default_name(args)?];
    }
    let named = one.files.output.iter_mut().chain(&mut one.files.stats);
    for path in named {
        *path = numbered_file(path, frame).ok_or_else(|| {
            let message = format!("every frame would be written to {}", path.display());
            let help = "write #### where the frame's number belongs, as in out.####.exr";
            Failure::wrong(message, help)
        })?;
    }
    one.light.seed = args.light.seed.wrapping_add(frame.into());
    // Whole frames are left as they are; none is gone on with.
    one.parts.resume = false;
    Ok(one)
}

/// The scene's name with the frame's number.
fn default_name(args: &RenderArgs) -> Result<PathBuf, Failure> {
    let input = Input::of(&args.scene)?;
    let plain = output::default_name(input.first_path(), None, ".exr")?;
    if plain.to_string_lossy().contains('#') {
        return Ok(plain);
    }
    Ok(plain.with_extension(format!("{DIGITS}.exr")))
}

/// Refuses a frame whose scene file is missing.
fn check_scene(args: &RenderArgs) -> Result<(), Failure> {
    for path in Input::of(&args.scene)?.paths() {
        if !path.exists() {
            let message = format!("there is no {}", path.display());
            let help = "give --frames the frames that there are";
            return Err(Failure::wrong(message, help));
        }
    }
    Ok(())
}

/// Renders a sequence, frame by frame, each by `render`.
///
/// # Errors
/// When a name is wrong, or a frame cannot be rendered; after an interrupt.
pub fn run(
    args: &RenderArgs,
    list: &FrameList,
    interrupt: &Interrupt,
    mut render: impl FnMut(&RenderArgs) -> Result<(), Failure>,
) -> Result<(), Failure> {
    // Before the first frame is better than at the last.
    for &frame in &list.0 {
        check_scene(&of_frame(args, frame)?)?;
    }
    let (start, mut rendered) = (Instant::now(), 0);
    for (i, &frame) in list.0.iter().enumerate() {
        let one = of_frame(args, frame)?;
        if args.parts.resume && one.files.output.iter().all(|path| path.exists()) {
            tracing::info!("frame {frame} is there already");
            continue;
        }
        if interrupt.requested() {
            return Err(Failure::Interrupted);
        }
        let count = list.0.len();
        tracing::info!(
            "frame {frame}, {} of {count}, --seed {}",
            i + 1,
            one.light.seed
        );
        render(&one)?;
        rendered += 1;
    }
    let seconds = start.elapsed().as_secs_f64();
    if rendered > 0 {
        tracing::info!(
            "{rendered} frames in {}, {} each",
            words::time(seconds),
            words::time(seconds / f64::from(rendered))
        );
    }
    Ok(())
}

/// Says that an interrupted frame is not written: it would be taken for a whole one.
pub fn leave_out(outputs: &Outputs) -> Failure {
    let name = outputs.first().display();
    tracing::info!("{name} is not written, the frame is not whole; --resume begins with it");
    Failure::Interrupted
}
