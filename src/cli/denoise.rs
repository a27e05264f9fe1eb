//! `twintree denoise`: from a noisy image file to one without noise.

use super::Failure;
use super::console::Console;
use super::denoising::Denoising;
use super::file_args::{ExrArgs, OidnArgs, ViewArgs};
use super::interrupt::Interrupt;
use super::output::{self, Outputs, check_lossless};
use super::values;
use crate::image::denoise::{Known, known};
use crate::image::{Attribute, PixelType, read_linear};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `twintree denoise`.
#[derive(Args, Debug)]
pub struct DenoiseArgs {
    /// Image to denoise: best an EXR that render wrote with --aov albedo,normal
    #[arg(value_name = "FILE")]
    pub input: PathBuf,
    /// Image to write; the name's end says how: .exr .hdr .tif .png .jpg. Can be given often
    #[arg(short, long, value_name = "FILE", required = true)]
    pub output: Vec<PathBuf>,
    /// How an EXR is written.
    #[command(flatten)]
    pub exr: ExrArgs,
    /// Brightness of .png and .jpg, as a power of two
    #[arg(long, value_name = "STOPS", value_parser = values::stops, default_value_t = 0.0,
          allow_negative_numbers = true)]
    pub exposure: f32,
    /// How they show light.
    #[command(flatten)]
    pub view: ViewArgs,
    /// The denoiser.
    #[command(flatten)]
    pub oidn: OidnArgs,
}

/// Denoises and writes.
///
/// # Errors
/// When there is no denoiser, the image cannot be read or has no colours, or an output cannot be
/// written; after an interrupt, with nothing written.
pub fn run(args: &DenoiseArgs, console: &Console, interrupt: &Interrupt) -> Result<(), Failure> {
    let outputs = Outputs::of_images(args.output.clone())?;
    outputs.spare("the noisy image", std::slice::from_ref(&args.input))?;
    output::load_library()?;
    let denoising = Denoising::load(&args.oidn, console, interrupt)?;
    let mut picture = read_linear(&args.input)?;
    let name = args.input.display();
    match known(&picture) {
        Known::Features => {}
        Known::Color => tracing::warn!(
            "{name} has no layers albedo and normal: it is denoised by its colours alone, and loses \
             more detail; render with --aov albedo,normal adds them"
        ),
        Known::Nothing => {
            return Err(Failure::wrong(
                format!("{name} has no colours"),
                "name an image with channels R, G and B",
            ));
        }
    }
    let is_matte = |a: &Attribute| a.name.starts_with("cryptomatte/");
    if picture.attributes.iter().any(is_matte) {
        check_lossless(&args.exr)?;
    }
    for channel in &mut picture.channels {
        // What needs 32 bits keeps them; the rest is as --format says.
        channel.pixel_type = channel.pixel_type.filter(|t| *t == PixelType::Float);
    }
    let (picture, denoised) = denoising.apply(picture, false);
    denoised?;
    outputs.write_images(&picture, &args.exr, args.exposure, &args.view.view)
}
