//! What can be typed for the commands that measure: `compare` and `bench`.

use super::scene_args::{MeshShape, SceneArgs, StudioArgs};
use super::values;
use clap::{Args, Subcommand, ValueEnum};
use std::path::{Path, PathBuf};

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
    #[arg(long, value_name = "RANGE", value_parser = values::range, help_heading = "Metrics")]
    pub data_range: Option<f64>,
    /// Limits.
    #[command(flatten)]
    pub limits: LimitArgs,
}

/// Limits that make the exit code 1 when an image passes one.
#[derive(Args, Debug)]
pub struct LimitArgs {
    /// Largest relMSE
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit, help_heading = "Limits: exit with 1 if an image passes one, or is not finite")]
    pub max_relmse: Option<f64>,
    /// Largest RMSE
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit, help_heading = "Limits: exit with 1 if an image passes one, or is not finite")]
    pub max_rmse: Option<f64>,
    /// Largest mean FLIP
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit, help_heading = "Limits: exit with 1 if an image passes one, or is not finite")]
    pub max_flip: Option<f64>,
    /// Smallest SSIM
    #[arg(long, value_name = "X", allow_negative_numbers = true, value_parser = values::limit, help_heading = "Limits: exit with 1 if an image passes one, or is not finite")]
    pub min_ssim: Option<f64>,
}

/// What `twintree bench` measures.
#[derive(Subcommand, Debug)]
pub enum Bench {
    /// Build times, memory and rays a second of both ray tracers
    Accel(Box<BenchAccelArgs>),
    /// How loading, building and tracing grow with the size of a mesh
    Scale(BenchScaleArgs),
}

/// Arguments of `twintree bench accel`.
#[derive(Args, Debug)]
pub struct BenchAccelArgs {
    /// Scene; its file may also be a mesh: .ply, .obj or .serialized
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Ray tracers to measure [default: all there are]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub accel: Vec<super::ray_args::Accel>,
    /// Build qualities to measure
    #[arg(
        long,
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "fast,balanced,high"
    )]
    pub quality: Vec<Quality>,
    /// Rays of each kind
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1024..=1 << 24))]
    pub rays: u32,
    /// Seconds for each rate: the rays are traced again and again, and the median counts
    #[arg(long, value_name = "SECONDS", default_value_t = 0.3, value_parser = values::limit)]
    pub seconds: f64,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// Arguments of `twintree bench scale`.
#[derive(Args, Debug)]
pub struct BenchScaleArgs {
    /// Triangles of the smallest mesh
    #[arg(long, value_name = "N", default_value = "1k", value_parser = values::amount)]
    pub least: u64,
    /// Triangles of the largest mesh, such as 64M; each is four times the one before
    #[arg(long, value_name = "N", default_value = "4M", value_parser = values::amount)]
    pub most: u64,
    /// Shape of the meshes
    #[arg(long, value_name = "SHAPE", default_value = "terrain")]
    pub kind: MeshShape,
    /// Ray tracers to measure [default: all there are]
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    pub accel: Vec<super::ray_args::Accel>,
    /// Rays of each kind
    #[arg(long, value_name = "N", default_value_t = 1 << 18, value_parser = clap::value_parser!(u32).range(1024..=1 << 24))]
    pub rays: u32,
    /// Seconds for each rate: the rays are traced again and again, and the median counts
    #[arg(long, value_name = "SECONDS", default_value_t = 0.3, value_parser = values::limit)]
    pub seconds: f64,
    /// Where the meshes are written while they are needed: 20 bytes a triangle [default: the
    /// system's directory for temporary files]
    #[arg(long, value_name = "DIRECTORY")]
    pub directory: Option<PathBuf>,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Draw the curves
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl BenchScaleArgs {
    /// The word for the shape.
    pub fn shape(&self) -> String {
        let word = self.kind.to_possible_value();
        word.map_or(String::new(), |w| w.get_name().to_owned())
    }

    /// A scene of one mesh.
    pub fn scene_of(&self, mesh: &Path) -> SceneArgs {
        SceneArgs {
            files: vec![mesh.into()],
            studio: StudioArgs::default(),
            define: Vec::new(),
            lenient: false,
            texture_memory: 0,
            limit_decoded: usize::MAX,
            half_textures: false,
        }
    }
}

/// How long to build, for how fast a tree.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// Quick to build
    Fast,
    /// What a render takes
    Balanced,
    /// Slow to build, fastest to trace
    High,
}
