//! What can be typed about what is rendered: scenes, models without a scene, and models to be made.

use super::values::{self, Definition};
use crate::math::DVec3;
use crate::scene::import::default_scene::{self, Sky, Viewpoint};
use crate::scene::import::models::palette::Paint;
use clap::{Args, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::path::PathBuf;

/// Which scene, and how to read it.
#[derive(Args, Debug)]
pub struct SceneArgs {
    /// Scene file (Mitsuba XML), or models (.ply .obj .stl .gltf .glb), each with steps behind an
    /// @: a.ply@translate=1,0,0;rotate=y,90;scale=2;material=gold;flat;flip
    #[arg(required = true, value_name = "SCENE|MODEL")]
    pub files: Vec<OsString>,
    /// What is around models.
    #[command(flatten)]
    pub studio: StudioArgs,
    /// Value of a $key in the scene; can be given often
    #[arg(
        short = 'D',
        long = "define",
        value_name = "KEY=VALUE",
        help_heading = "Scene"
    )]
    pub define: Vec<Definition>,
    /// Put something plain in the place of what is wrong or missing, with a warning, instead of
    /// giving up
    #[arg(long, help_heading = "Scene")]
    pub lenient: bool,
    /// Memory for texels, such as 512M or 2G: what does not fit is read again when needed
    #[arg(long, value_name = "BYTES", default_value = "2G", value_parser = values::bytes, help_heading = "Machine")]
    pub texture_memory: usize,
    /// Most memory for an image or mesh file once it is decoded; one that is itself a hundredth of
    /// that passes
    #[arg(long, value_name = "BYTES", default_value = "1G", value_parser = values::bytes, help_heading = "Machine")]
    pub limit_decoded: usize,
    /// Keep textures of 32 bits in 16: half the memory, three digits
    #[arg(long, help_heading = "Machine")]
    pub half_textures: bool,
}

/// What is around models that come without a scene.
#[derive(Args, Debug, Clone, Default, PartialEq)]
pub struct StudioArgs {
    /// Camera: orbit:AZIMUTH,ELEVATION in degrees, from:X,Y,Z, or the name or number of a glTF
    /// camera [default: the models' first camera, or orbit:30,20]
    #[arg(
        long,
        value_name = "VIEW",
        allow_hyphen_values = true,
        help_heading = "Models without a scene"
    )]
    pub camera: Option<Viewpoint>,
    /// Point that the camera looks at [default: the middle of the models]
    #[arg(long, value_name = "X,Y,Z", value_parser = default_scene::point, allow_hyphen_values = true, help_heading = "Models without a scene")]
    pub look_at: Option<DVec3>,
    /// Field of view along the picture's shorter side, degrees [default: the camera's, or 35]
    #[arg(long, value_name = "DEGREES", value_parser = values::field_of_view, help_heading = "Models without a scene")]
    pub fov: Option<f64>,
    /// Light: studio, white, white:R,G,B, sun, sun:AZIMUTH,ELEVATION or none [default: studio, if
    /// the models bring no light]
    #[arg(long, value_name = "SKY", help_heading = "Models without a scene")]
    pub sky: Option<Sky>,
    /// Image around the scene, latitude by longitude
    #[arg(long, value_name = "FILE", help_heading = "Models without a scene")]
    pub envmap: Option<PathBuf>,
    /// Ground under the models [material if none is named: matte:0.4]
    #[arg(long, value_name = "MATERIAL", num_args = 0..=1, require_equals = true, default_missing_value = "matte:0.4", help_heading = "Models without a scene")]
    pub ground: Option<Paint>,
    /// Material of all models: clay, matte, plastic, metal, mirror, glass, frosted, water, gold,
    /// silver, copper, aluminium, chrome, tungsten; with a colour as in plastic:0.8,0.1,0.1 or
    /// clay:#cc3311 [default: the models' own; clay, with the colours of their vertices]
    #[arg(long, value_name = "MATERIAL", help_heading = "Models without a scene")]
    pub material: Option<Paint>,
    /// Axis of the models that is up; glTF files are turned accordingly
    #[arg(
        long,
        value_name = "AXIS",
        default_value = "y",
        help_heading = "Models without a scene"
    )]
    pub up: UpAxis,
}

/// Axis that points up.
#[derive(ValueEnum, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As in glTF and Mitsuba
    #[default]
    Y,
    /// As in CAD and 3D printing
    Z,
}

/// Arguments of `twintree make`.
#[derive(Args, Debug)]
pub struct MakeArgs {
    /// What to make.
    #[command(subcommand)]
    pub what: MakeCommand,
}

/// What can be made.
#[derive(Subcommand, Debug)]
pub enum MakeCommand {
    /// Write a mesh of any size as binary PLY, always the same for the same words
    Mesh(MakeMeshArgs),
}

/// Arguments of `twintree make mesh`.
#[derive(Args, Debug)]
pub struct MakeMeshArgs {
    /// Shape
    #[arg(long, value_name = "SHAPE")]
    pub kind: MeshShape,
    /// Triangles, such as 20k, 5M or 1G; the mesh comes as near to it as its shape allows
    #[arg(long, value_name = "N", default_value = "1M", value_parser = values::amount)]
    pub triangles: u64,
    /// File to write
    #[arg(short, long, value_name = "FILE.ply")]
    pub output: PathBuf,
}

/// Shapes that can be made.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshShape {
    /// Mountains
    Terrain,
    /// A wall along Heighway's dragon curve
    DragonCurve,
    /// Spheres on spheres
    SphereFlake,
    /// A tube tied to a knot
    TorusKnot,
}
