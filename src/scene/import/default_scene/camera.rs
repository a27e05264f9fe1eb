//! The camera of a studio.

use super::{Studio, Viewpoint, error};
use crate::accel::Bounds;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::ImportError;
use crate::scene::import::parts::{NamedCamera, Parts};
use glam::DMat3;

/// Full field of view along the picture's shorter side, degrees: that of a portrait lens.
const FOV_DEGREES: f64 = 35.0;
/// Where the camera stands if nothing is asked for: a little to the right and above, degrees.
const AZIMUTH_ELEVATION: (f64, f64) = (30.0, 20.0);
/// Width over height if nothing is asked for.
const ASPECT: f64 = 4.0 / 3.0;
/// Room around the model.
const MARGIN: f64 = 1.05;

/// A camera, and the proportions of its picture.
pub(super) struct Shot {
    pub camera: CameraDescription,
    pub aspect: f64,
}

impl Studio {
    /// The camera that is asked for.
    pub(super) fn shot(&self, parts: &Parts, bounds: Bounds) -> Result<Shot, ImportError> {
        let chosen = match &self.view {
            Some(Viewpoint::Named(name)) => Some(named(&parts.cameras, name)?),
            Some(_) => None,
            None => parts.cameras.first(),
        };
        let asked = match self.size {
            (Some(w), Some(h)) => Some(f64::from(w) / f64::from(h)),
            _ => None,
        };
        if let Some(found) = chosen {
            let aspect = asked.or(found.aspect).unwrap_or(ASPECT);
            let camera = self.adjusted(found.camera);
            return Ok(Shot { camera, aspect });
        }
        let aspect = asked.unwrap_or(ASPECT);
        let camera = match self.view {
            Some(Viewpoint::From(eye)) => self.from(eye, bounds)?,
            Some(Viewpoint::Orbit { azimuth, elevation }) => {
                self.orbit((azimuth, elevation), bounds, aspect)?
            }
            _ => self.orbit(AZIMUTH_ELEVATION, bounds, aspect)?,
        };
        Ok(Shot { camera, aspect })
    }

    /// A camera of a file with the field of view and the target of the command line.
    fn adjusted(&self, mut camera: CameraDescription) -> CameraDescription {
        if let (Some(fov), Projection::Perspective { .. }) = (self.fov_degrees, camera.projection) {
            camera.projection = perspective(fov);
        }
        let eye = camera.to_world.translation;
        let to_target = self.look_at.and_then(|t| (t - eye).try_normalize());
        if let Some(forward) = to_target {
            camera.to_world.matrix3 = axes(forward, self.up());
        }
        camera
    }

    fn fov(&self) -> f64 {
        self.fov_degrees.unwrap_or(FOV_DEGREES)
    }

    fn target(&self, bounds: Bounds) -> DVec3 {
        self.look_at.unwrap_or_else(|| bounds.center().as_dvec3())
    }

    fn from(&self, eye: DVec3, bounds: Bounds) -> Result<CameraDescription, ImportError> {
        let way = self.target(bounds) - eye;
        let Some(forward) = way.try_normalize() else {
            let help = "choose another place with --camera, or another target with --look-at";
            let message = "the camera stands where it looks at";
            return Err(error(message, Some(help.into())));
        };
        Ok(self.describe(eye, axes(forward, self.up()), bounds))
    }

    /// A camera on a sphere around the target, as near as it may be without cutting anything off.
    fn orbit(
        &self,
        (azimuth, elevation): (f64, f64),
        bounds: Bounds,
        aspect: f64,
    ) -> Result<CameraDescription, ImportError> {
        let (up, front) = (self.up(), self.front());
        let right = up.cross(front);
        let (sin_a, cos_a) = azimuth.to_radians().sin_cos();
        let (sin_e, cos_e) = elevation.to_radians().sin_cos();
        let outward = (front * cos_a + right * sin_a) * cos_e + up * sin_e;
        // Straight from above, the front's side of the picture is down.
        let hint = if cos_e.abs() < 1e-6 {
            (front * cos_a + right * sin_a) * -sin_e.signum()
        } else {
            up * cos_e.signum()
        };
        let matrix = axes(-outward, hint);
        let target = self.target(bounds);
        let distance = fit(bounds, target, &matrix, self.fov(), aspect);
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(error(
                "the models have no extent that a camera could frame",
                None,
            ));
        }
        Ok(self.describe(target + outward * distance, matrix, bounds))
    }

    fn describe(&self, eye: DVec3, matrix3: DMat3, bounds: Bounds) -> CameraDescription {
        let radius = f64::from(bounds.radius()).max(1e-30);
        let reach = (eye - bounds.center().as_dvec3()).length() + radius;
        CameraDescription {
            to_world: DAffine3 {
                matrix3,
                translation: eye,
            },
            projection: perspective(self.fov()),
            near_clip: 1e-5 * radius,
            far_clip: 1e4 * reach,
        }
    }
}

fn perspective(fov_degrees: f64) -> Projection {
    Projection::Perspective {
        fov_degrees,
        fov_axis: FovAxis::Smaller,
        principal_point: [0.0; 2],
    }
}

/// Camera axes (left, up, forward) for a direction; `up` says which way the picture's top is.
fn axes(forward: DVec3, up: DVec3) -> DMat3 {
    let left = up.cross(forward).try_normalize();
    let left = left.unwrap_or_else(|| forward.any_orthonormal_vector());
    DMat3::from_cols(left, forward.cross(left), forward)
}

/// The distance from `target` at which the corners of the box fit into the picture.
fn fit(bounds: Bounds, target: DVec3, matrix: &DMat3, fov_degrees: f64, aspect: f64) -> f64 {
    let half = (0.5 * fov_degrees.to_radians()).tan();
    let (half_x, half_y) = (half * aspect.max(1.0), half * (1.0 / aspect).max(1.0));
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let mut distance: f64 = 0.0;
    for i in 0..8 {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        let corner = matrix.transpose() * (DVec3::new(pick(0), pick(1), pick(2)) - target);
        // |x| <= (distance + z) half_x, and the same for y.
        let across = (corner.x.abs() / half_x).max(corner.y.abs() / half_y);
        distance = distance.max(MARGIN * across - corner.z);
    }
    // A single flat triangle seen from its side still has a distance.
    distance.max(1e-3 * f64::from(bounds.radius()))
}

/// The camera with that name or number.
fn named<'a>(cameras: &'a [NamedCamera], name: &str) -> Result<&'a NamedCamera, ImportError> {
    let by_name = cameras.iter().find(|c| c.name == name);
    let number = name.parse::<usize>().ok();
    let found = by_name.or_else(|| cameras.get(number?));
    found.ok_or_else(|| {
        let list: Vec<String> = cameras
            .iter()
            .enumerate()
            .map(|(i, c)| format!("{i} ({})", c.name))
            .collect();
        let help = match list.is_empty() {
            true => "the files have no camera: use --camera orbit:AZIMUTH,ELEVATION".to_owned(),
            false => format!("there are {}", list.join(", ")),
        };
        error(format!("there is no camera \"{name}\""), Some(help))
    })
}
