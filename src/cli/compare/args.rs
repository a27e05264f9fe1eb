//! What can be typed for `twintree compare`.

use crate::cli::values;
use clap::Args;
use std::ops::Bound::Excluded;
use std::path::PathBuf;

/// Arguments of `twintree compare`.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// Images to compare with the reference
    #[arg(required = true, value_name = "IMAGE")]
    pub images: Vec<PathBuf>,
    /// Image to compare them with
    #[arg(short, long, value_name = "FILE")]
    pub reference: PathBuf,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub json: Option<PathBuf>,
    /// Draw the errors: into a directory, NAME-difference.png (red: too bright, blue: too dark) and
    /// NAME-flip.png of each image; into a file, all of them on one sheet
    #[arg(
        short,
        long,
        value_name = "DIRECTORY or FILE.png",
        help_heading = "Output"
    )]
    pub output: Option<PathBuf>,
    /// Brightness of the pictures as shown, as a power of two
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = values::stops,
        help_heading = "Metrics"
    )]
    pub exposure: f32,
    /// Compute SSIM and PSNR of the linear numbers, taken to span RANGE, instead of the pictures as
    /// shown
    #[arg(long, value_name = "RANGE", value_parser = values::number((Excluded(0.0), Excluded(f64::INFINITY)), "expected a number above 0 such as 1"),
          help_heading = "Metrics")]
    pub data_range: Option<f64>,
    /// Limits.
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Limits that make the exit code 1 when an image passes one.
#[derive(Args, Debug)]
#[command(next_help_heading = "Limits: exit with 1 if an image passes one, or is not finite")]
pub struct LimitArgs {
    /// Largest relMSE
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit)]
    pub max_relmse: Option<f64>,
    /// Largest RMSE
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit)]
    pub max_rmse: Option<f64>,
    /// Largest mean FLIP
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit)]
    pub max_flip: Option<f64>,
    /// Smallest SSIM
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit)]
    pub min_ssim: Option<f64>,
}
