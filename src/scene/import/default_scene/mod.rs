//! A studio around bare models: a camera that frames them, light, and a ground if wanted.
//!
//! The key light is a large disk behind the camera's left shoulder, so soft shadows fall to the
//! right; a dome fills them. Whatever a file brings along (cameras, lights) is used unless
//! something else is asked for.

mod camera;
mod light;
mod projection;
#[cfg(test)]
mod tests;
mod words;

pub use projection::{Aperture, Kind as ProjectionKind};
pub use words::{Sky, Viewpoint, point};

use super::ImportError;
use super::models::palette::Paint;
use super::parts::Parts;
use crate::accel::{AnalyticKind, AnalyticShape, Bounds};
use crate::film::filter::Filter;
use crate::film::{FilmDescription, FilmKind};
use crate::light::EnvironmentImage;
use crate::math::{Affine3A, DVec3, Vec3};
use crate::scene::description::RenderDescription;
use crate::scene::{Description, Geometry, Shape};
use std::sync::Arc;

/// Width of a picture where nothing says otherwise, pixels.
const WIDTH: u32 = 768;
/// Radius of the ground in radii of the model: its edge is far, and no number gets large.
const GROUND_RADII: f32 = 60.0;

/// What is around the models.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Studio {
    /// Where the camera is; `None` takes the first camera of the files, or else a view of all.
    pub view: Option<Viewpoint>,
    /// What the camera looks at; `None` is the middle of the models.
    pub look_at: Option<DVec3>,
    /// Full field of view along the picture's shorter side, degrees; `None` is the camera's.
    pub fov_degrees: Option<f64>,
    /// How the camera projects; `None` is as the file's camera does, or else a perspective.
    pub projection: Option<ProjectionKind>,
    /// Its lens; `None` is the camera's, a pinhole.
    pub aperture: Option<Aperture>,
    /// Whether +z is up instead of +y.
    pub z_up: bool,
    /// Light; `None` is the studio's, unless the files bring their own.
    pub sky: Option<Sky>,
    /// An image around the scene, in place of the sky.
    pub environment: Option<Arc<EnvironmentImage>>,
    /// A plane under the models, painted so.
    pub ground: Option<Paint>,
    /// Width and height of the picture, as far as the command line gives them.
    pub size: (Option<u32>, Option<u32>),
}

impl Studio {
    /// Which way is up.
    pub fn up(&self) -> DVec3 {
        if self.z_up { DVec3::Z } else { DVec3::Y }
    }

    /// The direction from which a model is seen from the front.
    fn front(&self) -> DVec3 {
        if self.z_up { DVec3::NEG_Y } else { DVec3::Z }
    }

    /// Makes a scene of `parts`.
    ///
    /// # Errors
    /// When the camera that is asked for does not exist, or there is nothing to see.
    pub fn compose(&self, mut parts: Parts) -> Result<Description, ImportError> {
        let bounds = parts.bounds();
        if bounds.is_empty() {
            return Err(error(
                "there is nothing to see: no file has a triangle",
                None,
            ));
        }
        let shot = self.shot(&parts, bounds)?;
        self.add_ground(&mut parts, bounds);
        self.add_light(&mut parts, &shot.camera, bounds);
        Ok(Description {
            media: parts.media,
            camera_medium: None,
            shapes: parts.shapes,
            groups: parts.groups,
            instances: parts.instances,
            materials: parts.materials,
            emitters: parts.emitters,
            emitter_names: parts.emitter_names,
            camera: shot.camera,
            film: FilmDescription {
                exposure: self.exposure(),
                ..film(shot.aspect)
            },
            render: RenderDescription::default(),
            origin: DVec3::ZERO,
            warnings: parts.warnings.into_list(),
        })
    }

    fn add_ground(&self, parts: &mut Parts, bounds: Bounds) {
        let Some(paint) = &self.ground else {
            return;
        };
        let up = self.up().as_vec3();
        let center = bounds.center();
        let lowest = bounds.min.dot(up);
        // A little below the lowest point: surfaces that coincide would flicker between the two.
        let gap = 1e-4 * bounds.radius();
        let foot = center + up * (lowest - gap - center.dot(up));
        let radius = GROUND_RADII * bounds.radius().max(f32::MIN_POSITIVE);
        let material = paint.add(&mut parts.materials, None);
        let disk = AnalyticShape::new(AnalyticKind::Disk, facing(foot, up, radius));
        parts.shapes.push(Shape {
            name: "ground".into(),
            geometry: Geometry::Analytic(disk),
            material,
            emitter: None,
            flip_normals: false,
            group: None,
            boundary: None,
        });
    }
}

/// The map that puts the unit disk around `center`, facing `normal`.
fn facing(center: Vec3, normal: Vec3, radius: f32) -> Affine3A {
    let (s, t) = normal.any_orthonormal_pair();
    Affine3A::from_cols(
        (s * radius).into(),
        (t * radius).into(),
        (normal * radius).into(),
        center.into(),
    )
}

fn film(aspect: f64) -> FilmDescription {
    let height = (f64::from(WIDTH) / aspect).round().clamp(1.0, 65536.0);
    FilmDescription {
        width: WIDTH,
        height: height as u32,
        crop: None,
        filter: Filter::Gaussian { stddev: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: Default::default(),
    }
}

fn error(message: impl Into<String>, help: Option<String>) -> ImportError {
    ImportError {
        at: None,
        file: None,
        message: message.into(),
        help,
    }
}
