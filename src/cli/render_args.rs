//! What can be typed for `twintree render`.
//!
//! What is typed is part of a render's identity (see [`super::identity`]) unless `#[serde(skip)]`
//! says that it shapes no pixel, or does so through the scene, whose fingerprint has all of it.

use super::file_args::FileArgs;
use super::frame_list::FrameList;
use super::guide_args::GuideArgs;
use super::light_args::LightArgs;
use super::light_layers::LightLayerArgs;
use super::part_args::PartArgs;
use super::picture_args::PictureArgs;
use super::preview::Preview;
use super::ray_args::RayArgs;
use super::scene_args::SceneArgs;
use super::values;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::ops::Bound::Excluded;
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;

/// Arguments of `twintree render`.
#[derive(Args, Clone, Debug, Serialize)]
pub struct RenderArgs {
    /// Files.
    #[command(flatten)]
    #[serde(skip)]
    pub files: FileArgs,
    /// Measure the error against this image while rendering, for --stats and the message at the end
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with = "shard",
        help_heading = "Output"
    )]
    #[serde(skip)]
    pub reference: Option<PathBuf>,
    /// When to stop: parts say so apart, for a render may go on to more samples.
    #[command(flatten)]
    #[serde(skip)]
    pub stop: StopArgs,
    /// Parts and checkpoints.
    #[command(flatten)]
    #[serde(skip)]
    pub parts: PartArgs,
    /// Render a sequence: 1-48, 1-48x2 for every second, or 1,5,10-20. In names (-o, --stats, the
    /// scene's) and in values of -D, #### stands for the frame's number; a single scene file gets it
    /// as $frame. Where only the camera moves, the field is carried on. With --resume, frames whose
    /// images are there are left out
    #[arg(long, value_name = "LIST", help_heading = "Sequence",
          conflicts_with_all = ["shard", "checkpoint", "pixel", "reference"])]
    #[serde(skip)]
    pub frames: Option<FrameList>,
    /// Scene.
    #[command(flatten)]
    #[serde(flatten)]
    pub scene: SceneArgs,
    /// Picture.
    #[command(flatten)]
    #[serde(flatten)]
    pub picture: PictureArgs,
    /// Light transport.
    #[command(flatten)]
    #[serde(flatten)]
    pub light: LightArgs,
    /// Layers of light: what they come to is told apart.
    #[command(flatten)]
    #[serde(skip)]
    pub layers: LightLayerArgs,
    /// Samples that went wrong.
    #[command(flatten)]
    #[serde(skip)]
    pub doubt: DoubtArgs,
    /// Guiding.
    #[command(flatten)]
    #[serde(flatten)]
    pub guide: GuideArgs,
    /// Ray tracer.
    #[command(flatten)]
    #[serde(flatten)]
    pub rays: RayArgs,
    /// Show the image while it renders, in the viewer tev (tev=host:port if it runs elsewhere)
    #[arg(long, value_name = "tev[=HOST:PORT]", help_heading = "Messages")]
    #[serde(skip)]
    pub preview: Option<Preview>,
}

/// When to stop: whichever comes first.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Stop at whichever comes first")]
pub struct StopArgs {
    /// Settings for a purpose: when to stop, and how long to learn; options that are given besides
    /// win
    #[arg(long, value_name = "NAME", conflicts_with = "shard")]
    pub quality: Option<Preset>,
    /// Stop after N samples a pixel [default: the scene's number, or none with --time or --noise]
    #[arg(long, value_name = "N", value_parser = values::amount)]
    pub spp: Option<u64>,
    /// Stop after this time of rendering: 90, 120s, 2m, 1h30m
    #[arg(long, value_name = "TIME", value_parser = values::duration)]
    pub time: Option<Duration>,
    /// Stop at this noise: the expected root of the relative mean squared error
    #[arg(long, value_name = "NOISE", allow_negative_numbers = true,
          value_parser = values::number((Excluded(0.0), Excluded(f32::INFINITY)), "expected a number above 0 such as 0.02"))]
    pub noise: Option<f32>,
}

/// What an image is for.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// A look at light and frame
    Draft,
    /// To show
    Normal,
    /// To keep
    Final,
}

/// Samples that went wrong.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Doubt")]
pub struct DoubtArgs {
    /// End with exit code 3 if a sample or a photon was not finite and had to be left out; the
    /// image is written all the same
    #[arg(long)]
    pub strict: bool,
    /// Trace one sample of this pixel and print its path, sample 0 if none is named; nothing is
    /// written
    #[arg(long, value_name = "X,Y[,SAMPLE]", allow_hyphen_values = true)]
    pub pixel: Option<PixelSample>,
}

/// A sample of a pixel of the full film.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelSample {
    /// x from the left and y from the top, from 0.
    pub pixel: [u32; 2],
    /// Which of its samples, from 0.
    pub sample: u64,
}

impl FromStr for PixelSample {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let pixel = values::list(text).map(|pixel| Self { pixel, sample: 0 });
        let sample = || {
            let (pixel, sample) = text.rsplit_once(',')?;
            Some(Self {
                pixel: values::list(pixel)?,
                sample: sample.trim().parse().ok()?,
            })
        };
        pixel
            .or_else(sample)
            .ok_or_else(|| "expected two whole numbers x,y such as 160,90, or x,y,sample".into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_has_two_numbers_and_a_sample_may_follow() {
        let of = |pixel, sample| Ok(PixelSample { pixel, sample });
        assert_eq!("3,4".parse(), of([3, 4], 0));
        assert_eq!("3,4,5000000000".parse(), of([3, 4], 5_000_000_000));
        for text in ["", "3", "3,4,5,6", "-1,2", "1,2,-3", "a,b", "1.5,2"] {
            assert!(text.parse::<PixelSample>().is_err(), "{text}");
        }
    }
}
