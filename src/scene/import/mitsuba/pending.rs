//! What waits for the end of the import: shapes whose meshes are not loaded yet, and the sensor.

use crate::bsdf::MaterialId;
use crate::camera::CameraDescription;
use crate::film::FilmDescription;
use crate::medium::{Boundary, MediumId};
use crate::scene::Geometry;
use crate::scene::description::SamplerKind;
use crate::scene::import::faults::At;
use crate::scene::import::mesh::{MeshKind, MeshOptions};
use crate::texture::Texture;
use std::path::PathBuf;

/// A shape whose mesh may not have been loaded yet.
pub(super) struct PendingShape {
    pub name: String,
    pub geometry: PendingGeometry,
    pub material: MaterialId,
    /// What it emits, if it glows.
    pub radiance: Option<Texture>,
    /// The id of the emitter inside it.
    pub lamp_id: Option<String>,
    pub flip_normals: bool,
    pub group: Option<u32>,
    /// The media on its sides.
    pub boundary: Option<Boundary>,
}

/// What a pending shape is made of.
pub(super) enum PendingGeometry {
    Ready(Geometry),
    File(Request),
}

/// A mesh file that a shape asks for.
#[derive(Clone, Debug)]
pub(super) struct Request {
    pub path: PathBuf,
    pub kind: MeshKind,
    pub options: MeshOptions,
    /// Where the shape names the file.
    pub at: At,
}

impl Request {
    /// What two requests share when they are for the same mesh: everything but the place.
    pub fn key(&self) -> (PathBuf, String) {
        // `f64` in the options has no `Hash`; its shortest text that reads back the same stands for
        // it.
        (
            self.path.clone(),
            format!("{:?} {:?}", self.kind, self.options),
        )
    }
}

/// A sensor with everything inside it.
#[derive(Clone, Debug)]
pub(super) struct Sensor {
    pub camera: CameraDescription,
    pub film: FilmDescription,
    /// Samples a pixel, where the scene says.
    pub spp: Option<u32>,
    pub sampler: SamplerKind,
    /// What the camera is in.
    pub medium: MediumId,
}
