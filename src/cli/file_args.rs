//! What can be typed about the files of an image.

use super::aov::{self, Aov};
use super::choice::{Choice, choice};
use super::values;
use super::view_arg::ViewParser;
use crate::film::Layers;
use crate::image::{Compression, PixelType, ViewTransform};
use clap::Args;
use std::path::PathBuf;

/// What is written, and how.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Output")]
pub struct FileArgs {
    /// Image to write; the name's end says how: .exr .hdr .tif .png .jpg. Can be given often
    /// [default: the scene's name with .exr, in the current directory]
    #[arg(short, long, value_name = "FILE")]
    pub output: Vec<PathBuf>,
    /// Further layers of an EXR
    #[arg(
        long,
        value_name = "LAYERS",
        value_delimiter = ',',
        default_value = "none"
    )]
    pub aov: Vec<Aov>,
    /// Denoise the picture with Intel Open Image Denoise. An EXR then has the denoised picture as its
    /// R, G and B, the noisy one as layer "noisy", and the layers albedo and normal
    #[arg(long)]
    pub denoise: bool,
    /// The denoiser.
    #[command(flatten)]
    pub oidn: OidnArgs,
    /// How an EXR is written.
    #[command(flatten)]
    pub exr: ExrArgs,
    /// Brightness of .png and .jpg, as a power of two [default: the scene's]
    #[arg(long, value_name = "STOPS", value_parser = values::stops, allow_negative_numbers = true)]
    pub exposure: Option<f32>,
    /// How they show light.
    #[command(flatten)]
    pub view: ViewArgs,
    /// Write measurements as JSON
    #[arg(long, value_name = "FILE")]
    pub stats: Option<PathBuf>,
}

impl FileArgs {
    /// The layers that were asked for, and those that a denoiser needs.
    pub fn layers(&self) -> Layers {
        let mut layers = aov::layers(&self.aov);
        layers.albedo |= self.denoise;
        layers.normal |= self.denoise;
        layers
    }
}

/// Where the denoiser is.
#[derive(Args, Clone, Debug)]
pub struct OidnArgs {
    /// Where Open Image Denoise 2 is: its library, or a folder of a release or of Python's pyoidn
    /// [default: TWINTREE_OIDN, what the system has, Python's environment]
    #[arg(long, value_name = "PATH")]
    pub oidn: Option<PathBuf>,
}

/// How an EXR is written. Large ones are written in tiles.
#[derive(Args, Clone, Debug)]
pub struct ExrArgs {
    /// Numbers of an EXR: 16 or 32 bits
    #[arg(long, value_name = "TYPE", default_value = "half", value_parser = NUMBERS)]
    pub format: PixelType,
    /// Compression of an EXR; dwaa is lossy
    #[arg(long, value_name = "NAME", default_value = "zip", value_parser = PACKINGS)]
    pub compression: Compression,
}

/// How light is shown.
#[derive(Args, Clone, Debug)]
pub struct ViewArgs {
    /// How .png and .jpg show light, which has no upper limit as they have
    #[arg(long, value_name = "NAME", default_value = "srgb", value_parser = ViewParser)]
    pub view: ViewTransform,
}

const NUMBERS: Choice<PixelType> = choice! {
    /// 16 bits
    "half" => PixelType::Half,
    /// 32 bits
    "float" => PixelType::Float,
};

const PACKINGS: Choice<Compression> = choice! {
    /// Not compressed
    "none" => Compression::None,
    /// Deflate, lossless
    "zip" => Compression::Zip,
    /// Wavelets, lossless
    "piz" => Compression::Piz,
    /// Cosine transform, lossy
    "dwaa" => Compression::Dwaa,
};
