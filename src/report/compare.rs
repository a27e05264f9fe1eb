//! Errors of images against a reference: `twintree compare`.

use super::table::{markdown, number};
use serde::Serialize;

/// What is printed. The field names are the keys of `twintree compare --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Version of the program.
    pub version: String,
    /// The reference's file.
    pub reference: String,
    /// Width of all images.
    pub width: u32,
    /// Height of all images.
    pub height: u32,
    /// Pixels of the reference with a NaN or an infinity, which count as without error.
    pub reference_not_finite: usize,
    /// `hdr` or `ldr`: which FLIP was computed.
    pub flip_kind: &'static str,
    /// Range of the linear numbers that SSIM and PSNR were computed of; `null`: of the pictures as
    /// shown, with a range of 1.
    pub data_range: Option<f64>,
    /// Brightness of the pictures as shown, in stops.
    pub exposure: f32,
    /// The images, in the order of the command line.
    pub images: Vec<ImageErrors>,
    /// Limits that were passed, a sentence each.
    pub passed: Vec<String>,
}

/// The errors of one image. Numbers that are not finite are `null` in JSON.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ImageErrors {
    /// The file.
    pub image: String,
    /// Mean absolute difference.
    pub l1: f64,
    /// Mean squared difference.
    pub mse: f64,
    /// Its root.
    pub rmse: f64,
    /// Mean of (I - R)^2 / (R^2 + 0.01).
    pub relmse: f64,
    /// The same without the worst 0.1 % of the pixels.
    pub relmse_trimmed: f64,
    /// relMSE of the means over blocks of 4 x 4 pixels; `null` where there is no such block.
    pub relmse_4x4: Option<f64>,
    /// The same for 16 x 16 pixels.
    pub relmse_16x16: Option<f64>,
    /// Structural similarity; `null` for images below 7 x 7.
    pub ssim: Option<f64>,
    /// Peak signal-to-noise ratio in decibels; `null` for equal images.
    pub psnr: f64,
    /// Mean of the FLIP error map.
    pub flip: f64,
    /// Mean of the image over the reference's.
    pub mean_ratio: f64,
    /// The same for red, green and blue.
    pub mean_ratio_rgb: [f64; 3],
    /// Pixels four times brighter than any of the reference around them.
    pub fireflies: usize,
    /// Pixels with a NaN or an infinity, which count as black.
    pub not_finite: usize,
    /// Whether noise explains the difference; `null` unless both files have a variance layer.
    pub z: Option<Z>,
}

/// The z-test of an image.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Z {
    /// Share of the numbers inside the band that holds 0.999 of a normal distribution.
    pub inside: f64,
    /// z of the image's mean, for red, green and blue.
    pub of_mean: [f64; 3],
    /// Standard deviation of z of pixels and of the means over blocks of 4 x 4 and 16 x 16 pixels:
    /// 1 where noise explains the differences; `null` where the image has no such block.
    pub deviations: [Option<f64>; 3],
}

/// Heads of the columns.
const HEAD: [&str; 14] = [
    "image",
    "L1",
    "RMSE",
    "relMSE",
    "relMSE trimmed",
    "relMSE 4x4, 16x16",
    "SSIM",
    "PSNR",
    "FLIP",
    "mean ratio",
    "fireflies",
    "not finite",
    "z inside",
    "sd of z, 1 4 16 px",
];

impl Comparison {
    /// The file of `--json`.
    pub fn to_json(&self) -> String {
        super::json(self)
    }

    /// The table, a row an image.
    pub fn to_table(&self) -> String {
        let rows: Vec<Vec<String>> = self.images.iter().map(row).collect();
        markdown(&HEAD, &rows)
    }
}

/// The standard deviations of z in a cell.
fn deviations(z: Z) -> String {
    let one = |d: Option<f64>| d.map_or("-".into(), |d| format!("{d:.2}"));
    z.deviations.map(one).join(" ")
}

fn row(of: &ImageErrors) -> Vec<String> {
    let ratio = |x: f64| format!("{x:.5}");
    let or_dash = |x: Option<f64>| x.map_or("-".into(), ratio);
    vec![
        of.image.clone(),
        number(of.l1),
        number(of.rmse),
        number(of.relmse),
        number(of.relmse_trimmed),
        super::words::errors_of_blocks([of.relmse_4x4, of.relmse_16x16]),
        or_dash(of.ssim),
        number(of.psnr),
        number(of.flip),
        or_dash(Some(of.mean_ratio).filter(|x| x.is_finite())),
        of.fireflies.to_string(),
        of.not_finite.to_string(),
        or_dash(of.z.map(|z| z.inside)),
        of.z.map_or("-".into(), deviations),
    ]
}
