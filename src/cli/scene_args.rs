//! What can be typed about what is rendered: scenes, and models without a scene.

use super::choice::{Choice, choice};
use super::values;
use crate::image::decoded::DecodeLimit;
use crate::math::DVec3;
use crate::scene::import::default_scene::{self, ProjectionKind, Sky, Viewpoint};
use crate::scene::import::gltf::Moment;
use crate::scene::import::models::palette::Paint;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::ffi::OsString;
use std::ops::Bound::{Excluded, Included};
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Which scene, and how to read it. The scene's fingerprint has what comes of most of it.
#[derive(Args, Clone, Debug, Serialize)]
pub struct SceneArgs {
    /// Scene file (Mitsuba's .xml, pbrt's .pbrt), or models (.ply .obj .stl .gltf .glb), each with steps behind an
    /// @: a.ply@translate=1,0,0;rotate=y,90;scale=2;material=gold;flat;flip
    #[arg(required = true, value_name = "SCENE|MODEL")]
    #[serde(skip)]
    pub files: Vec<OsString>,
    /// What is around models.
    #[command(flatten)]
    #[serde(skip)]
    pub studio: StudioArgs,
    /// How a scene is read.
    #[command(flatten)]
    #[serde(skip)]
    pub read: ReadArgs,
    /// Memory for texels, such as 512M or 2G: what does not fit is read again when needed. With
    /// :half behind it, as in 2G:half, textures of 32 bits are kept in 16: half the memory, three
    /// digits
    #[arg(
        long,
        value_name = "BYTES[:half]",
        default_value = "2G",
        help_heading = "Machine"
    )]
    pub texture_memory: TextureMemory,
    /// Most memory for an image or mesh file once it is decoded; one that is itself a hundredth of
    /// that passes
    #[arg(long, value_name = "BYTES", default_value = "1G", value_parser = values::bytes, help_heading = "Machine")]
    #[serde(skip)]
    pub limit_decoded: usize,
}

impl SceneArgs {
    /// A scene of a name, for commands that take a scene by an option.
    pub fn of(scene: &Path, read: &ReadArgs) -> Self {
        Self {
            files: vec![scene.into()],
            studio: StudioArgs::default(),
            read: read.clone(),
            texture_memory: TextureMemory::default(),
            limit_decoded: DecodeLimit::default().bytes as usize,
        }
    }

    /// What was asked for, in the words of who asked.
    pub fn title(&self) -> String {
        let words: Vec<_> = self.files.iter().map(|f| f.to_string_lossy()).collect();
        words.join(" ")
    }
}

/// How a scene is read.
#[derive(Args, Clone, Debug, Default)]
#[command(next_help_heading = "Scene")]
pub struct ReadArgs {
    /// Value of a $key in the scene; can be given often
    #[arg(short = 'D', long = "define", value_name = "KEY=VALUE")]
    pub define: Vec<Definition>,
    /// Put something plain in the place of what is wrong or missing, with a warning, instead of
    /// giving up
    #[arg(long)]
    pub lenient: bool,
}

/// What is around models that come without a scene.
#[derive(Args, Debug, Clone, Default, PartialEq)]
#[command(next_help_heading = "Models without a scene")]
pub struct StudioArgs {
    /// Camera: orbit:AZIMUTH,ELEVATION in degrees, from:X,Y,Z, or the name or number of a glTF
    /// camera [default: the models' first camera, or orbit:30,20]
    #[arg(long, value_name = "VIEW", allow_hyphen_values = true)]
    pub camera: Option<Viewpoint>,
    /// Point that the camera looks at [default: the middle of the models]
    #[arg(long, value_name = "X,Y,Z", value_parser = default_scene::point, allow_hyphen_values = true)]
    pub look_at: Option<DVec3>,
    /// How the camera projects [default: as the models' camera does, or perspective]
    #[arg(long, value_name = "NAME", value_parser = PROJECTIONS)]
    pub projection: Option<ProjectionKind>,
    /// Field of view along the picture's shorter side, degrees [default: the camera's, or 35; of a
    /// fisheye 180]
    #[arg(long, value_name = "DEGREES", value_parser = values::number((Excluded(0.0), Included(360.0)), "expected degrees above 0 such as 35, below 180, or up to 360 of a fisheye"))]
    pub fov: Option<f64>,
    /// Radius of the camera's lens, in the models' units: what is not in focus is blurred [default:
    /// a pinhole]
    #[arg(long, value_name = "RADIUS", value_parser = values::number((Excluded(0.0), Excluded(f64::INFINITY)), "expected a radius above 0 such as 0.02"))]
    pub aperture: Option<f64>,
    /// Distance to what is in focus, along the camera's axis [default: that of what the camera looks
    /// at]
    #[arg(long, value_name = "DISTANCE", requires = "aperture", value_parser = values::number((Excluded(0.0), Excluded(f64::INFINITY)), "expected a distance above 0 such as 2.5"))]
    pub focus: Option<f64>,
    /// Light: studio, white, white:R,G,B, sun, sun:AZIMUTH,ELEVATION or none [default: studio, if
    /// the models bring no light]
    #[arg(long, value_name = "SKY")]
    pub sky: Option<Sky>,
    /// Image around the scene, latitude by longitude
    #[arg(long, value_name = "FILE")]
    pub envmap: Option<PathBuf>,
    /// Ground under the models [material if none is named: matte:0.4]
    #[arg(long, value_name = "MATERIAL", num_args = 0..=1, require_equals = true, default_missing_value = "matte:0.4")]
    pub ground: Option<Paint>,
    /// Material of all models: clay, matte, plastic, metal, mirror, glass, frosted, water, gold,
    /// silver, copper, aluminium, chrome, tungsten; with a colour as in plastic:0.8,0.1,0.1 or
    /// clay:#cc3311 [default: the models' own; clay, with the colours of their vertices]
    #[arg(long, value_name = "MATERIAL")]
    pub material: Option<Paint>,
    /// The variant of glTF files whose materials are shown [default: their default materials]
    #[arg(long, value_name = "NAME")]
    pub variant: Option<String>,
    /// A moment of an animation of glTF files, with its name or number before a colon where it is
    /// not the first, as in Walk:1.5 [default: the files' own pose]
    #[arg(long, value_name = "[ANIMATION:]SECONDS", allow_hyphen_values = true)]
    pub at: Option<Moment>,
    /// Axis of the models that is up; glTF files are turned accordingly
    #[arg(long, value_name = "AXIS", default_value = "y")]
    pub up: UpAxis,
}

const PROJECTIONS: Choice<ProjectionKind> = choice! {
    /// As eyes and lenses see
    "perspective" => ProjectionKind::Perspective,
    /// Parallel rays: equal sizes at all distances
    "orthographic" => ProjectionKind::Orthographic,
    /// All directions, latitude by longitude, as in an environment map
    "spherical" => ProjectionKind::Spherical,
    /// A circle in which the distance from the middle is the angle to the axis
    "fisheye" => ProjectionKind::Fisheye,
};

/// Axis that points up.
#[derive(ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As in glTF and Mitsuba
    #[default]
    Y,
    /// As in CAD and 3D printing
    Z,
}

/// A value for a `$name` in a scene file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Definition {
    /// The name, without `$`.
    pub name: String,
    /// The text to put in its place.
    pub value: String,
}

impl FromStr for Definition {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.');
        match text.split_once('=') {
            Some((name, value)) if !name.is_empty() && name.chars().all(word) => Ok(Self {
                name: name.into(),
                value: value.into(),
            }),
            _ => Err("expected key=value such as -D spp=256".into()),
        }
    }
}

/// Memory for texels, and how they are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(into = "String")]
pub struct TextureMemory {
    /// Texels that are held at once, in bytes.
    pub bytes: usize,
    /// Keep 16 bits of each 32.
    pub half: bool,
}

impl Default for TextureMemory {
    fn default() -> Self {
        let (bytes, half) = (2 << 30, false);
        Self { bytes, half }
    }
}

impl From<TextureMemory> for String {
    fn from(memory: TextureMemory) -> Self {
        format!("{}{}", memory.bytes, if memory.half { ":half" } else { "" })
    }
}

impl FromStr for TextureMemory {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let half = text.strip_suffix(":half");
        Ok(Self {
            bytes: values::bytes(half.unwrap_or(text))?,
            half: half.is_some(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn definitions_keep_what_follows_the_first_equals_sign() {
        let definition: Definition = "a_1=b=c".parse().unwrap();
        assert_eq!(
            (definition.name.as_str(), definition.value.as_str()),
            ("a_1", "b=c")
        );
        for text in ["", "=1", "a", "a b=1"] {
            assert!(text.parse::<Definition>().is_err(), "{text}");
        }
    }

    #[test]
    fn texels_may_be_kept_in_halves() {
        let of = |bytes, half| Ok(TextureMemory { bytes, half });
        assert_eq!("512M".parse(), of(512 << 20, false));
        assert_eq!("1G:half".parse(), of(1 << 30, true));
        assert_eq!("2G".parse(), Ok(TextureMemory::default()));
        for text in ["", "half", ":half", "2G:halves", "2G:half:half", "-1:half"] {
            assert!(text.parse::<TextureMemory>().is_err(), "{text}");
        }
    }
}
