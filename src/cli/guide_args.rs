//! What can be typed about guiding: by what, and how that is learned.

use super::choice::{Choice, choice};
use super::help::options_of;
use super::values;
use crate::guide::ModelKind;
use crate::integrate::{Roulette, reuse};
use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{Args, ValueEnum, value_parser};
use serde::Serialize;
use std::ffi::OsString;
use std::path::PathBuf;
use std::str::FromStr;

/// How directions are guided.
#[derive(Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Guiding")]
pub struct GuideArgs {
    /// How directions are guided towards light [default: auto; with --field double, with --shard
    /// none]
    #[arg(long, value_name = "NAME")]
    pub guide: Option<Guide>,
    /// Guide by a field that "twintree train" made, instead of learning one; any:FILE takes that of
    /// another scene or camera, too: the image has the same mean, but may be noisier
    #[arg(long, value_name = "[any:]FILE", value_parser = field_name(),
          conflicts_with_all = options_of::<LearnArgs>().iter().map(|option| option.get_id().clone()))]
    #[serde(skip)]
    pub field: Option<FieldName>,
    /// How a field is learned.
    #[command(flatten, next_help_heading = "Guiding, for research")]
    #[serde(flatten)]
    pub learn: LearnArgs,
    /// What a field is used for.
    #[command(flatten)]
    #[serde(flatten)]
    pub guided: GuidedArgs,
}

impl GuideArgs {
    /// What guides: what is asked for, or else the double hierarchy where a field is given.
    pub fn way(&self) -> Guide {
        let by_field = self.field.as_ref().map(|_| Guide::Double);
        self.guide.or(by_field).unwrap_or(Guide::Auto)
    }
}

/// What is done where a field guides.
#[derive(Args, Clone, Debug, Serialize)]
#[command(next_help_heading = "Guiding, for research")]
pub struct GuidedArgs {
    /// Share of the directions that come from the field, 0.1 to 0.9, the others from the material;
    /// or "learned", place by place
    #[arg(long, value_name = "SHARE", default_value = "learned")]
    pub mixture: Mixture,
    /// What guided paths are ended or split by
    #[arg(long, value_name = "NAME", default_value = "field", value_parser = ROULETTES)]
    pub roulette: Roulette,
    /// How many pixels' paths share what they find behind their first rough vertices, where a field
    /// guides; 1: each is for itself, and the noise of neighbours independent
    #[arg(long, value_name = "N", default_value_t = REUSE, value_parser = value_parser!(u32).range(1..=i64::from(reuse::MAX_GROUP)))]
    pub reuse: u32,
    /// Manifold next-event estimation: guided paths sample suns and lamps behind glass and in
    /// mirrors, where there are any, as often as a short trial finds worth its time
    #[arg(long, alias = "aim", value_name = "WHEN", default_value = "auto")]
    pub manifold: When,
    /// Whether pixels that are noisier take more of the samples, where camera paths teach a field:
    /// their noise tells which need more; --spp then is what they take on average
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub adaptive: When,
    /// Whether a short trial tells if a field that is learned pays, and ends guiding where it does
    /// not
    #[arg(long, value_name = "WHEN", default_value = "auto")]
    pub trial: When,
}

const ROULETTES: Choice<Roulette> = choice! {
    /// How much light the field expects them to bring: what brings little is ended, what brings
    /// much split
    "field" => Roulette::Field,
    /// Low throughput, as without a field
    "throughput" => Roulette::Throughput,
};

/// Whether the program may do what helps it.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum When {
    /// Where it pays
    Auto,
    /// Not at all
    Never,
}

/// How a field is learned.
#[derive(Args, Clone, Debug, Serialize)]
pub struct LearnArgs {
    /// Photon paths that teach the field [default: as many as the image is worth, while they teach
    /// anything; with "twintree train" 500 000; with --guide gmm 9 million]
    #[arg(long, value_name = "N", value_parser = values::amount_or_zero)]
    pub photons: Option<u64>,
    /// Camera paths that teach the field; the first samples of a render do
    #[arg(long, value_name = "N", default_value_t = PATHS, value_parser = values::amount_or_zero)]
    pub paths: u64,
    /// Which of the two do
    #[arg(long, value_name = "NAME", default_value = "both")]
    pub train: Teachers,
    /// Batches that --photons come in, each twice as large as the one before; with --guide gmm 30
    /// of one size
    #[arg(long, value_name = "N", default_value_t = 8, default_value_if("guide", "gmm", "30"), value_parser = value_parser!(u32).range(1..=32))]
    pub batches: u32,
    /// Memory for learning, such as 64M: the field's trees while they are trained, and the records
    /// that they learn from
    #[arg(long, value_name = "BYTES", default_value = "256M", value_parser = values::bytes)]
    pub guide_memory: usize,
    /// What describes the directions of a cell
    #[arg(long, value_name = "NAME", default_value = "gauss", value_parser = MODELS)]
    pub guide_model: ModelKind,
}

/// Camera paths that teach a field, unless told otherwise. (A quarter of the samples instead of
/// three, for small images of 64 samples: variance times time of a kitchen 0.96 instead of 0.90,
/// veach-ajar 0.41 and 0.42, lux-pool 2.0 and 2.1; the image's own variance up to 1.12 times.)
pub const PATHS: u64 = 2_000_000;
/// Pixels whose paths share what they find, unless told otherwise.
pub const REUSE: u32 = 32;
/// What describes the directions of a cell, unless told otherwise.
pub const MODEL: ModelKind = ModelKind::Gauss;

const MODELS: Choice<ModelKind> = choice! {
    /// Constants on a tree of directions, as in the paper: learned in less time
    "constant" => ModelKind::Constant,
    /// A mixture of von Mises-Fisher lobes with parallax: for lights that are small, or little
    /// memory
    "vmf" => ModelKind::Vmf,
    /// A mixture of eight Gaussians: learns from fewer records, ahead where light is narrow and
    /// moves
    "gauss" => MODEL,
};

/// Ways of guiding.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Guide {
    /// A double hierarchy, where learning one may pay: not where there is no indirect light, and
    /// not for previews and tiny images
    Auto,
    /// Plain path tracing
    None,
    /// A double hierarchy, learned before rendering and from its first samples
    Double,
    /// Cached Gaussian mixtures (Vorba et al. 2014), learned from photons before rendering: to
    /// compare with
    Gmm,
    /// The SD-tree of practical path guiding (Mueller et al. 2017, Rath et al. 2020), learned from
    /// camera paths while rendering: to compare with
    Ppg,
}

/// Which records teach a field.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Teachers {
    /// Photons from the lights
    Photons,
    /// Paths from the camera
    Paths,
    /// Both
    Both,
}

/// How often directions are drawn from a field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(into = "String")]
pub struct Mixture(
    /// Share of the directions, within 0.1 and 0.9; `None` is learned.
    pub Option<f32>,
);

impl From<Mixture> for String {
    fn from(mixture: Mixture) -> Self {
        mixture
            .0
            .map_or("learned".into(), |share| share.to_string())
    }
}

impl FromStr for Mixture {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "learned" {
            return Ok(Self(None));
        }
        let share = values::number(
            0.1..=0.9,
            "expected a number from 0.1 to 0.9, or \"learned\"",
        );
        share(text).map(|share| Self(Some(share)))
    }
}

/// The file of a field.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldName {
    /// Its name.
    pub path: PathBuf,
    /// Whether it may be that of another scene.
    pub any_scene: bool,
}

/// Reads the name of a field; `any:` before it takes that of any scene.
pub fn field_name() -> impl TypedValueParser<Value = FieldName> {
    OsStringValueParser::new().map(|name: OsString| {
        let any = name.to_str().and_then(|text| text.strip_prefix("any:"));
        FieldName {
            any_scene: any.is_some(),
            path: any.map_or_else(|| PathBuf::from(&name), PathBuf::from),
        }
    })
}
