//! What can be typed for `twintree table1`.

use crate::cli::choice::{Choice, choice};
use crate::cli::guide_args::PATHS;
use crate::cli::light_args::LightArgs;
use crate::cli::picture_args::MAX_SIDE;
use crate::cli::ray_args::RayArgs;
use crate::cli::scene_args::ReadArgs;
use crate::cli::values;
use crate::guide::ModelKind;
use crate::integrate::reuse;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `twintree table1`.
#[derive(Args, Debug)]
pub struct Table1Args {
    /// Scene file; can be given often [default: scenes/pool/pool.xml and scenes/door/door.xml]
    #[arg(long = "scene", value_name = "FILE", help_heading = "Scene")]
    pub scenes: Vec<PathBuf>,
    /// How the scenes are read.
    #[command(flatten)]
    pub read: ReadArgs,
    /// Width in pixels; the height follows the scene's proportions
    #[arg(long, value_name = "PIXELS", value_parser = clap::value_parser!(u32).range(1..=MAX_SIDE), help_heading = "Picture")]
    pub width: Option<u32>,
    /// Samples a pixel
    #[arg(long, value_name = "N", default_value = "256", value_parser = values::amount, help_heading = "Picture")]
    pub spp: u64,
    /// Methods to compare
    #[arg(
        long = "method",
        value_name = "NAMES",
        value_delimiter = ',',
        default_value = "none,gmm,ppg,double,double-vmf,double-gauss,field,field-reuse,field-manifold,double-render",
        value_parser = METHODS,
        help_heading = "Guiding"
    )]
    pub methods: Vec<Method>,
    /// Batches of photons
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=1 << 16), help_heading = "Guiding")]
    pub batches: u32,
    /// Photon paths a batch
    #[arg(long, value_name = "N", default_value = "300k", value_parser = values::amount, help_heading = "Guiding")]
    pub photons: u64,
    /// Memory for a double hierarchy while it is learned, such as 64M
    #[arg(long, value_name = "BYTES", default_value = "256M", value_parser = values::bytes, help_heading = "Guiding")]
    pub guide_memory: usize,
    /// Memory for mixtures while they are learned: they take what they need, unless this is little
    #[arg(long, value_name = "BYTES", default_value = "256M", value_parser = values::bytes, help_heading = "Guiding")]
    pub gmm_memory: usize,
    /// Camera paths that teach the fields of the rows from "field" on and of ppg, as in "twintree
    /// render"
    #[arg(long, value_name = "N", default_value_t = PATHS, value_parser = values::amount_or_zero, help_heading = "Guiding")]
    pub paths: u64,
    /// How many pixels' paths share what they find, with every method that guides, as in "twintree
    /// render"; 1: each is for itself, as in the paper, except in the rows from "field-reuse" on
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=i64::from(reuse::MAX_GROUP)), help_heading = "Guiding")]
    pub reuse: u32,
    /// Times that everything is done, with a seed of its own each; medians count. The methods take
    /// turns
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000), help_heading = "Measurement")]
    pub repeats: u32,
    /// Image to measure errors against, one for each scene, in their order; without it one is
    /// rendered
    #[arg(long = "reference", value_name = "FILE", help_heading = "Measurement")]
    pub references: Vec<PathBuf>,
    /// Samples a pixel of a reference that is rendered [default: 16 times --spp]
    #[arg(long, value_name = "N", conflicts_with = "references", value_parser = values::amount, help_heading = "Measurement")]
    pub reference_spp: Option<u64>,
    /// Directory that keeps rendered references for the next time
    #[arg(
        long,
        value_name = "DIRECTORY",
        default_value = ".",
        help_heading = "Measurement"
    )]
    pub cache: PathBuf,
    /// Write the numbers as JSON
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub json: Option<PathBuf>,
    /// Directory for the images of the last repeat: SCENE-METHOD.png
    #[arg(short, long, value_name = "DIRECTORY", help_heading = "Output")]
    pub output: Option<PathBuf>,
    /// Light transport.
    #[command(flatten)]
    pub light: LightArgs,
    /// Ray tracer.
    #[command(flatten)]
    pub rays: RayArgs,
}

/// Methods that are compared.
pub const METHODS: Choice<Method> = choice! {
    /// Plain path tracing
    "none" => Method::None,
    /// Cached Gaussian mixtures (Vorba et al. 2014)
    "gmm" => Method::Gmm,
    /// The SD-tree of practical path guiding (Mueller et al. 2017, Rath et al. 2020), which learns
    /// from the image's own first samples
    "ppg" => Method::Ppg,
    /// The double hierarchy with constants
    "double" => Method::Double(ModelKind::Constant),
    /// The double hierarchy with von Mises-Fisher lobes
    "double-vmf" => Method::Double(ModelKind::Vmf),
    /// The double hierarchy with Gaussian mixtures
    "double-gauss" => Method::Double(ModelKind::Gauss),
    /// The same as "twintree render --guide double" learns it: from as many of the photons as the
    /// image is worth, and from the image's own first samples; nothing else that a render does
    "field" => Method::Render(Extras { reuse: false, manifold: false, adaptive: false }),
    /// Beside that paths share what they find, in groups as in "twintree render"
    "field-reuse" => Method::Render(Extras { reuse: true, manifold: false, adaptive: false }),
    /// And there is manifold next-event estimation
    "field-manifold" => Method::Render(Extras { reuse: true, manifold: true, adaptive: false }),
    /// And samples go where the noise is: all that "twintree render --guide double" does
    "double-render" => Method::Render(Extras { reuse: true, manifold: true, adaptive: true }),
};

/// A method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Without a field.
    None,
    /// Mixtures.
    Gmm,
    /// An SD-tree.
    Ppg,
    /// A double hierarchy of that model, learned before rendering.
    Double(ModelKind),
    /// A double hierarchy as a render learns it, with what a render does besides.
    Render(Extras),
}

/// What a guided render does beside sampling from its field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Extras {
    /// Paths of several pixels share what they find.
    pub reuse: bool,
    /// Manifold next-event estimation.
    pub manifold: bool,
    /// Noisier pixels take more samples.
    pub adaptive: bool,
}
