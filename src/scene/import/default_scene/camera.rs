//! The camera of a studio: where it stands and where it looks.

use super::projection::{Kind, parallel_half_width};
use super::{Studio, Viewpoint, error};
use crate::accel::Bounds;
use crate::camera::{CameraDescription, Projection};
use crate::math::{DAffine3, DVec3};
use crate::scene::import::ImportError;
use crate::scene::import::parts::{NamedCamera, Parts};
use glam::DMat3;

/// Where the camera stands if nothing is asked for: a little to the right and above, degrees.
const AZIMUTH_ELEVATION: (f64, f64) = (30.0, 20.0);

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
            let own = Kind::of(&found.camera.projection);
            let kind = self.projection.unwrap_or(own);
            self.check_lens(kind)?;
            let own_aspect = found.aspect.filter(|_| kind == own);
            let aspect = asked.or(own_aspect).unwrap_or(kind.aspect());
            let camera = match kind == own {
                true => self.adjusted(found.camera, bounds)?,
                false => self.projected(&found.camera, kind, bounds, aspect)?,
            };
            return Ok(Shot { camera, aspect });
        }
        let kind = self.projection.unwrap_or(Kind::Perspective);
        self.check_lens(kind)?;
        let aspect = asked.unwrap_or(kind.aspect());
        let camera = match self.view {
            Some(Viewpoint::From(eye)) => self.from(eye, kind, bounds, aspect)?,
            Some(Viewpoint::Orbit { azimuth, elevation }) => {
                self.orbit((azimuth, elevation), kind, bounds, aspect)?
            }
            _ => self.orbit(AZIMUTH_ELEVATION, kind, bounds, aspect)?,
        };
        Ok(Shot { camera, aspect })
    }

    /// A camera of a file with the field of view, the lens and the target of the command line.
    fn adjusted(
        &self,
        mut camera: CameraDescription,
        bounds: Bounds,
    ) -> Result<CameraDescription, ImportError> {
        let eye = camera.to_world.translation;
        let own = camera.to_world.matrix3;
        let to_target = self.look_at.and_then(|t| (t - eye).try_normalize());
        if let Some(forward) = to_target {
            let mut turned = axes(forward, self.up());
            // Here the scale is the size of the picture.
            if camera.projection == Projection::Orthographic {
                turned.x_axis *= own.x_axis.length();
                turned.y_axis *= own.y_axis.length();
            }
            camera.to_world.matrix3 = turned;
        }
        if let Projection::Perspective {
            fov_degrees,
            fov_axis,
            ..
        } = camera.projection
        {
            let own = (fov_degrees, fov_axis);
            let fov = self.fov_degrees.map_or(own, |_| self.fov());
            let to_target = self.target(bounds) - eye;
            let forward = camera.to_world.matrix3.z_axis;
            camera.projection = self.perspective(fov, to_target, forward)?;
        }
        Ok(camera)
    }

    /// A camera that stands where one of a file does, and projects otherwise.
    fn projected(
        &self,
        found: &CameraDescription,
        kind: Kind,
        bounds: Bounds,
        aspect: f64,
    ) -> Result<CameraDescription, ImportError> {
        let eye = found.to_world.translation;
        let own = found.to_world.matrix3;
        let to_target = self.look_at.and_then(|t| (t - eye).try_normalize());
        let matrix = match to_target {
            Some(forward) => axes(forward, self.up()),
            None => {
                let [x, y, z] = [own.x_axis, own.y_axis, own.z_axis].map(DVec3::normalize_or_zero);
                DMat3::from_cols(x, y, z)
            }
        };
        self.describe((eye, matrix), kind, bounds, aspect)
    }

    fn target(&self, bounds: Bounds) -> DVec3 {
        self.look_at.unwrap_or_else(|| bounds.center().as_dvec3())
    }

    fn from(
        &self,
        eye: DVec3,
        kind: Kind,
        bounds: Bounds,
        aspect: f64,
    ) -> Result<CameraDescription, ImportError> {
        let mut way = self.target(bounds) - eye;
        // From the middle of the models, a panorama shows what is before them in its middle.
        if way == DVec3::ZERO && kind == Kind::Spherical {
            way = self.front();
        }
        let Some(forward) = way.try_normalize() else {
            let help = "choose another place with --camera, or another target with --look-at";
            let message = "the camera stands where it looks at";
            return Err(error(message, Some(help.into())));
        };
        self.describe((eye, axes(forward, self.up())), kind, bounds, aspect)
    }

    /// A camera on a sphere around the target, as near as it may be without cutting anything off.
    fn orbit(
        &self,
        (azimuth, elevation): (f64, f64),
        kind: Kind,
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
        let distance = self.distance(kind, bounds, target, &matrix, aspect);
        if !(distance > 0.0 && distance.is_finite()) {
            return Err(error(
                "the models have no extent that a camera could frame",
                None,
            ));
        }
        self.describe((target + outward * distance, matrix), kind, bounds, aspect)
    }

    /// A camera at a place with these axes.
    fn describe(
        &self,
        (eye, matrix): (DVec3, DMat3),
        kind: Kind,
        bounds: Bounds,
        aspect: f64,
    ) -> Result<CameraDescription, ImportError> {
        let radius = f64::from(bounds.radius()).max(1e-30);
        let reach = (eye - bounds.center().as_dvec3()).length() + radius;
        let (matrix3, projection) = match kind {
            Kind::Perspective => {
                let to_target = self.target(bounds) - eye;
                let projection = self.perspective(self.fov(), to_target, matrix.z_axis)?;
                (matrix, projection)
            }
            Kind::Orthographic => {
                let half = parallel_half_width(bounds, eye, &matrix, aspect);
                let size = DMat3::from_diagonal(DVec3::new(half, half, 1.0));
                (matrix * size, Projection::Orthographic)
            }
            Kind::Spherical => (self.level(matrix), Projection::Spherical),
            Kind::Fisheye => (matrix, self.fisheye()),
        };
        Ok(CameraDescription {
            to_world: DAffine3 {
                matrix3,
                translation: eye,
            },
            projection,
            near_clip: 1e-5 * radius,
            far_clip: 1e4 * reach,
        })
    }

    /// The same axes with the horizon in the middle of a panorama.
    fn level(&self, matrix: DMat3) -> DMat3 {
        let up = self.up();
        let ahead = matrix.z_axis.reject_from_normalized(up);
        // Straight up and down there is no ahead but the picture's top.
        let ahead = match ahead.length() > 1e-6 {
            true => ahead,
            false => matrix.y_axis.reject_from_normalized(up),
        };
        ahead.try_normalize().map_or(matrix, |a| axes(a, up))
    }
}

/// Camera axes (left, up, forward) for a direction; `up` says which way the picture's top is.
fn axes(forward: DVec3, up: DVec3) -> DMat3 {
    let left = up.cross(forward).try_normalize();
    let left = left.unwrap_or_else(|| forward.any_orthonormal_vector());
    DMat3::from_cols(left, forward.cross(left), forward)
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
