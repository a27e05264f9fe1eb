//! What can be typed about the files of an image.

use super::values;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// What is written, and how.
#[derive(Args, Debug)]
pub struct FileArgs {
    /// Image to write; the name's end says how: .exr .hdr .tif .png .jpg. Can be given often
    /// [default: the scene's name with .exr, in the current directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Vec<PathBuf>,
    /// Further layers of an EXR
    #[arg(
        long,
        value_name = "LAYERS",
        value_delimiter = ',',
        default_value = "none",
        help_heading = "Output"
    )]
    pub aov: Vec<Aov>,
    /// Numbers of an EXR: 16 or 32 bits
    #[arg(
        long,
        value_name = "TYPE",
        default_value = "half",
        help_heading = "Output"
    )]
    pub format: NumberFormat,
    /// Compression of an EXR; dwaa is lossy
    #[arg(
        long,
        value_name = "NAME",
        default_value = "zip",
        help_heading = "Output"
    )]
    pub compression: Packing,
    /// Write an EXR in tiles
    #[arg(long, help_heading = "Output")]
    pub tiled: bool,
    /// Brightness of .png and .jpg, as a power of two [default: the scene's]
    #[arg(
        long,
        value_name = "STOPS",
        allow_negative_numbers = true,
        value_parser = values::stops,
        help_heading = "Output"
    )]
    pub exposure: Option<f32>,
    /// Write measurements as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub stats: Option<PathBuf>,
}

/// A layer beside the picture.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// Reflectance of the first surface
    Albedo,
    /// Its shading normal, world space
    Normal,
    /// Its distance
    Depth,
    /// Variance of each pixel's mean
    Variance,
    /// Noise like that of the picture, by which `compare` tells how wrong means over blocks may be
    Noise,
    /// Samples of each pixel
    Samples,
    /// Every layer
    All,
    /// The picture alone
    None,
}

/// Width of an EXR's numbers.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberFormat {
    /// 16 bits
    Half,
    /// 32 bits
    Float,
}

/// Compression of an EXR.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// Not compressed
    None,
    /// Deflate, lossless
    Zip,
    /// Wavelets, lossless
    Piz,
    /// Cosine transform, lossy
    Dwaa,
}
