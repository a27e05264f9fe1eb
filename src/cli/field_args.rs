//! What can be typed about learned fields: how they are learned, kept, added and looked at.

use super::light_args::LightArgs;
use super::ray_args::Accel;
use super::scene_args::SceneArgs;
use super::values::{self, Definition, Depth, Mixture, Pixel};
use crate::film::Shard;
use crate::integrate::reuse;
use clap::{Args, ValueEnum, value_parser};
use std::path::PathBuf;

/// How directions are guided.
#[derive(Args, Debug)]
pub struct GuideArgs {
    /// How directions are guided towards light [default: none, with --field double]
    #[arg(long, value_name = "NAME", help_heading = "Guiding")]
    pub guide: Option<Guide>,
    /// Guide by a field that "twintree train" made, instead of learning one
    #[arg(long, value_name = "FILE", help_heading = "Guiding",
          conflicts_with_all = ["photons", "paths", "batches", "guide_memory", "guide_model", "train"])]
    pub field: Option<PathBuf>,
    /// Take a field of another scene or camera, too: the image has the same mean, but may be
    /// noisier
    #[arg(long, requires = "field", help_heading = "Guiding")]
    pub any_scene: bool,
    /// How a field is learned.
    #[command(flatten)]
    pub learn: LearnArgs,
    /// Share of the directions that come from the field, 0.1 to 0.9, the others from the material;
    /// or "learned", place by place
    #[arg(
        long,
        value_name = "SHARE",
        default_value = "learned",
        help_heading = "Guiding"
    )]
    pub mixture: Mixture,
    /// What guided paths are ended or split by
    #[arg(
        long,
        value_name = "NAME",
        default_value = "field",
        help_heading = "Guiding"
    )]
    pub roulette: RouletteBy,
    /// How many pixels' paths share what they find behind their first rough vertices, where a field
    /// guides; 1: each is for itself, and the noise of neighbours independent
    #[arg(
        long,
        value_name = "N",
        default_value_t = REUSE,
        value_parser = value_parser!(u32).range(1..=i64::from(reuse::MAX_GROUP)),
        help_heading = "Guiding"
    )]
    pub reuse: u32,
    /// Manifold next-event estimation: guided paths sample suns and lamps behind glass and in
    /// mirrors
    #[arg(
        long,
        alias = "aim",
        value_name = "WHEN",
        default_value = "auto",
        help_heading = "Guiding"
    )]
    pub manifold: Manifold,
    /// Whether pixels that are noisier take more of the samples, where the first samples teach a
    /// field; --spp then is what they take on average
    #[arg(
        long,
        value_name = "WHEN",
        default_value = "auto",
        help_heading = "Guiding"
    )]
    pub adaptive: Adaptive,
    /// Whether a short trial tells if a field that is learned pays, and ends guiding where it does
    /// not
    #[arg(
        long,
        value_name = "WHEN",
        default_value = "auto",
        help_heading = "Guiding"
    )]
    pub trial: Trial,
}

impl GuideArgs {
    /// What guides: what is asked for, or else the double hierarchy where a field is given.
    pub fn way(&self) -> Guide {
        let by_field = self.field.as_ref().map(|_| Guide::Double);
        self.guide.or(by_field).unwrap_or(Guide::None)
    }
}

/// How many paths share what they find, unless told otherwise.
const REUSE: u32 = 32;
/// Camera paths that teach a field, unless told otherwise. (A quarter of the samples instead of
/// three, for small images of 64 samples: variance times time of a kitchen 0.96 instead of 0.90,
/// veach-ajar 0.41 and 0.42, lux-pool 2.0 and 2.1; the image's own variance up to 1.12 times.)
pub const PATHS: u64 = 2_000_000;

/// What Russian roulette goes by where a field guides.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum RouletteBy {
    /// How much light the field expects them to bring: what brings little is ended, what brings
    /// much split
    Field,
    /// Low throughput, as without a field
    Throughput,
}

/// Whether suns and lamps are sampled through specular chains.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Manifold {
    /// Where there are any, as often as a short trial finds worth its time
    Auto,
    /// Never: they are left to what the field knows
    Never,
}

/// Whether noisy pixels take more samples.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Adaptive {
    /// Where camera paths teach a field: their noise tells which pixels need more
    Auto,
    /// Never: each takes as many
    Never,
}

/// Whether guiding is tried.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Trial {
    /// While the field is learned, and guiding ends where it does not pay
    Auto,
    /// Never: paths are guided to the end
    Never,
}

/// How a field is learned.
#[derive(Args, Debug)]
pub struct LearnArgs {
    /// Photon paths that teach the field [default: as many as the image is worth, while they teach
    /// anything; with "twintree train" 500 000; with --guide gmm 9 million]
    #[arg(long, value_name = "N", help_heading = "Guiding")]
    pub photons: Option<u64>,
    /// Camera paths that teach the field; the first samples of a render do
    #[arg(
        long,
        value_name = "N",
        default_value_t = PATHS,
        help_heading = "Guiding"
    )]
    pub paths: u64,
    /// Which of the two do
    #[arg(
        long,
        value_name = "NAME",
        default_value = "both",
        help_heading = "Guiding"
    )]
    pub train: Teachers,
    /// Batches that --photons come in, each twice as large as the one before; with --guide gmm 30
    /// of one size
    #[arg(long, value_name = "N", default_value_t = 8, default_value_if("guide", "gmm", "30"), value_parser = clap::value_parser!(u32).range(1..=32), help_heading = "Guiding")]
    pub batches: u32,
    /// Memory for learning, such as 64M: the field's trees while they are trained, and the records
    /// that they learn from
    #[arg(long, value_name = "BYTES", default_value = "256M", value_parser = values::bytes, help_heading = "Guiding")]
    pub guide_memory: usize,
    /// What describes the directions of a cell
    #[arg(
        long,
        value_name = "NAME",
        value_enum,
        default_value_t,
        help_heading = "Guiding"
    )]
    pub guide_model: GuideModel,
}

/// Arguments of `twintree train`.
#[derive(Args, Debug)]
pub struct TrainArgs {
    /// File to write [default: the scene's name with .field, in the current directory]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// Learn further: from records that this field does not know yet, over its structure as it is
    #[arg(long, value_name = "FILE", help_heading = "Guiding",
          conflicts_with_all = ["batches", "guide_memory", "guide_model", "train"])]
    pub field: Option<PathBuf>,
    /// Learn from a share of these records, 0/4 to 3/4, into a field for "twintree merge-fields"
    #[arg(long, value_name = "I/N", value_parser = values::shard, requires = "field", help_heading = "Guiding")]
    pub shard: Option<Shard>,
    /// How a field is learned.
    #[command(flatten)]
    pub learn: LearnArgs,
    /// Scene.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Size of the picture that camera paths are for.
    #[command(flatten)]
    pub size: SizeArgs,
    /// Light transport.
    #[command(flatten)]
    pub light: LightArgs,
    /// Ray tracer [default: embree, where it was compiled in]
    #[arg(long, value_name = "NAME", help_heading = "Machine")]
    pub accel: Option<Accel>,
}

/// Size of a picture.
#[derive(Args, Debug)]
pub struct SizeArgs {
    /// Width in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=super::picture_args::MAX_SIDE), help_heading = "Picture")]
    pub width: Option<u32>,
    /// Height in pixels; alone it keeps the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=super::picture_args::MAX_SIDE), help_heading = "Picture")]
    pub height: Option<u32>,
}

/// Arguments of `twintree merge-fields`.
#[derive(Args, Debug)]
pub struct MergeFieldsArgs {
    /// Fields that were learned over one structure from different records, in any order
    #[arg(required = true)]
    pub fields: Vec<PathBuf>,
    /// File to write
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Add what there is, even if records are missing
    #[arg(long)]
    pub partial: bool,
}

/// Arguments of `twintree field`.
#[derive(Args, Debug)]
pub struct FieldArgs {
    /// Field that "twintree train" made
    pub field: PathBuf,
    /// Print what is in it: records, nodes, links, depths, bytes. The default, if nothing else is
    /// asked for
    #[arg(long, help_heading = "What to show")]
    pub stats: bool,
    /// Print JSON
    #[arg(long, help_heading = "What to show")]
    pub json: bool,
    /// Draw where light comes from at the point that a pixel sees: left as the field has it, right
    /// as unguided paths find it
    #[arg(long, value_name = "X,Y", allow_hyphen_values = true, requires_all = ["scene", "output"], help_heading = "What to show")]
    pub pixel: Option<Pixel>,
    /// File for that: directions, the scene's z axis up, as densities, 1 is the mean over the
    /// sphere
    #[arg(
        short,
        long,
        value_name = "FILE",
        requires = "pixel",
        help_heading = "What to show"
    )]
    pub output: Option<PathBuf>,
    /// Draw the cells of space that the camera sees, each in a colour of its own
    #[arg(
        long,
        value_name = "FILE",
        requires = "scene",
        help_heading = "What to show"
    )]
    pub tree: Option<PathBuf>,
    /// The scene that it was learned for
    #[arg(long, value_name = "FILE", help_heading = "Scene")]
    pub scene: Option<PathBuf>,
    /// Value of a $key in the scene; can be given often
    #[arg(
        short = 'D',
        long = "define",
        value_name = "KEY=VALUE",
        help_heading = "Scene"
    )]
    pub define: Vec<Definition>,
    /// Put something plain in the place of what is not supported, with a warning, instead of giving
    /// up
    #[arg(long, help_heading = "Scene")]
    pub lenient: bool,
    /// Take a field of another scene or camera, too
    #[arg(long, help_heading = "Scene")]
    pub any_scene: bool,
    /// Size of the camera's picture.
    #[command(flatten)]
    pub size: SizeArgs,
    /// Longest path, in edges, or "unlimited" [default: the scene's]
    #[arg(
        long,
        value_name = "N",
        allow_hyphen_values = true,
        help_heading = "Picture"
    )]
    pub max_depth: Option<Depth>,
    /// Seed of the paths
    #[arg(long, value_name = "N", default_value_t = 0, help_heading = "Picture")]
    pub seed: u64,
    /// Rows of the picture of directions
    #[arg(long, value_name = "N", default_value_t = 96, value_parser = clap::value_parser!(u32).range(2..=2048), help_heading = "Picture")]
    pub rows: u32,
    /// Paths a pixel of that picture
    #[arg(long, value_name = "N", default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..=1 << 20), help_heading = "Picture")]
    pub spp: u32,
    /// Include light straight from emitters, which next-event estimation finds without a field
    #[arg(long, help_heading = "Picture")]
    pub direct: bool,
    /// Brightness of .png and .jpg, as a power of two
    #[arg(
        long,
        value_name = "STOPS",
        default_value_t = -3.0,
        allow_negative_numbers = true,
        value_parser = values::stops,
        help_heading = "Picture"
    )]
    pub exposure: f32,
}

/// Ways of guiding.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guide {
    /// Plain path tracing
    None,
    /// A double hierarchy, learned before rendering
    Double,
    /// Cached Gaussian mixtures (Vorba et al. 2014), learned from photons before rendering: to
    /// compare with
    Gmm,
}

/// What describes the directions of a cell.
#[derive(ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum GuideModel {
    /// Constants on a tree of directions, as in the paper: learned in less time
    Constant,
    /// A mixture of von Mises-Fisher lobes with parallax: for lights that are small, or little
    /// memory
    Vmf,
    /// A mixture of eight Gaussians: learns from fewer records, ahead where light is narrow and
    /// moves
    #[default]
    Gauss,
}

/// Which records teach a field.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Teachers {
    /// Photons from the lights
    Photons,
    /// Paths from the camera
    Paths,
    /// Both
    Both,
}
