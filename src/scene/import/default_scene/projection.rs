//! How the camera of a studio projects, and how far away it stands for that.

use super::{Studio, error};
use crate::accel::Bounds;
use crate::camera::{FovAxis, Projection};
use crate::math::DVec3;
use crate::scene::import::ImportError;
use glam::DMat3;

/// Full field of view along the picture's shorter side, degrees: that of a portrait lens.
const FOV_DEGREES: f64 = 35.0;
/// That of a fisheye.
const FISHEYE_DEGREES: f64 = 180.0;
/// A fisheye of a wider field stands as near as one of this: the models would be before its glass.
const WIDEST_FIT_DEGREES: f64 = 90.0;
/// Room around the model.
const MARGIN: f64 = 1.05;

/// A kind of projection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// As eyes and lenses see.
    Perspective,
    /// By parallel rays.
    Orthographic,
    /// All directions, latitude by longitude.
    Spherical,
    /// A circle of angles.
    Fisheye,
}

impl Kind {
    /// The kind of a projection.
    pub(super) fn of(projection: &Projection) -> Self {
        match projection {
            Projection::Perspective { .. } | Projection::ThinLens { .. } => Self::Perspective,
            Projection::Orthographic => Self::Orthographic,
            Projection::Spherical => Self::Spherical,
            Projection::Fisheye { .. } => Self::Fisheye,
        }
    }

    /// Width over height of its picture, where nothing else says.
    pub(super) fn aspect(self) -> f64 {
        match self {
            Self::Perspective | Self::Orthographic => 4.0 / 3.0,
            Self::Spherical => 2.0,
            Self::Fisheye => 1.0,
        }
    }
}

/// A lens that is no pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aperture {
    /// Its radius, world units.
    pub radius: f64,
    /// Distance to what is sharp, along the axis; `None` is that of what the camera looks at.
    pub focus: Option<f64>,
}

impl Studio {
    /// Refuses what has no meaning with this projection.
    pub(super) fn check_lens(&self, kind: Kind) -> Result<(), ImportError> {
        let refuse = |message: String, help: &str| Err(error(message, Some(help.into())));
        let fov = self.fov_degrees;
        match (kind, fov) {
            (Kind::Orthographic, Some(_)) => refuse(
                "--fov has no meaning for parallel rays".into(),
                "leave it out: an orthographic picture is as wide as the models",
            ),
            (Kind::Spherical, Some(_)) => refuse(
                "--fov has no meaning for a panorama, which shows all directions".into(),
                "leave it out, or choose --projection fisheye",
            ),
            (Kind::Perspective, Some(fov)) if fov >= 180.0 => refuse(
                format!("--fov {fov}: a perspective shows less than 180 degrees"),
                "give less, or choose --projection fisheye, which shows up to 360",
            ),
            _ if self.aperture.is_some() && kind != Kind::Perspective => refuse(
                "--aperture has a meaning for a perspective only".into(),
                "leave it out, or choose --projection perspective",
            ),
            _ => Ok(()),
        }
    }

    /// A perspective of that field of view, through a lens if one is asked for. `to_target` leads
    /// from the eye to what it looks at.
    pub(super) fn perspective(
        &self,
        (fov_degrees, fov_axis): (f64, FovAxis),
        to_target: DVec3,
        forward: DVec3,
    ) -> Result<Projection, ImportError> {
        let principal_point = [0.0; 2];
        let Some(Aperture { radius, focus }) = self.aperture else {
            return Ok(Projection::Perspective {
                fov_degrees,
                fov_axis,
                principal_point,
            });
        };
        let focus_distance = focus.unwrap_or_else(|| to_target.dot(forward));
        if focus_distance > 0.0 && focus_distance.is_finite() {
            return Ok(Projection::ThinLens {
                fov_degrees,
                fov_axis,
                principal_point,
                aperture_radius: radius,
                focus_distance,
            });
        }
        let message = "--aperture: what should be sharp is not before the camera";
        let help =
            "give the distance to what should be sharp with --focus, or a point with --look-at";
        Err(error(message, Some(help.into())))
    }

    /// Field of view of a perspective.
    pub(super) fn fov(&self) -> (f64, FovAxis) {
        let fov = self.fov_degrees.unwrap_or(FOV_DEGREES);
        (fov, FovAxis::Smaller)
    }

    /// The fisheye that is asked for.
    pub(super) fn fisheye(&self) -> Projection {
        Projection::Fisheye {
            fov_degrees: self.fov_degrees.unwrap_or(FISHEYE_DEGREES),
            fov_axis: FovAxis::Smaller,
        }
    }

    /// The distance from `target` at which all of the models fit into the picture.
    pub(super) fn distance(
        &self,
        kind: Kind,
        bounds: Bounds,
        target: DVec3,
        matrix: &DMat3,
        aspect: f64,
    ) -> f64 {
        let radius = f64::from(bounds.radius());
        let half = |degrees: f64| (0.5 * degrees.to_radians()).tan();
        let corners = corners(bounds, target, matrix);
        let mut distance: f64 = 0.0;
        match kind {
            // Anywhere outside.
            Kind::Orthographic => {
                return 2.0 * ((target - bounds.center().as_dvec3()).length() + radius);
            }
            Kind::Perspective | Kind::Spherical => {
                let (half, aspect) = match kind {
                    // It shows all from anywhere. There the models have a usual size.
                    Kind::Spherical => (half(FOV_DEGREES), 1.0),
                    _ => (half(self.fov().0), aspect),
                };
                let (half_x, half_y) = (half * aspect.max(1.0), half * (1.0 / aspect).max(1.0));
                for corner in corners {
                    // |x| <= (distance + z) half_x, and the same for y.
                    let across = (corner.x.abs() / half_x).max(corner.y.abs() / half_y);
                    distance = distance.max(MARGIN * across - corner.z);
                }
            }
            Kind::Fisheye => {
                let fov = self.fov_degrees.unwrap_or(FISHEYE_DEGREES);
                let half = half(fov.min(WIDEST_FIT_DEGREES));
                for corner in corners {
                    let across = corner.x.hypot(corner.y) / half;
                    distance = distance.max(MARGIN * across - corner.z);
                }
            }
        }
        // A single flat triangle seen from its side still has a distance.
        distance.max(1e-3 * radius)
    }
}

/// Half the width of a picture by parallel rays from `eye` that shows all of the models.
pub(super) fn parallel_half_width(bounds: Bounds, eye: DVec3, matrix: &DMat3, aspect: f64) -> f64 {
    let corners = corners(bounds, eye, matrix);
    let half = corners.map(|c| c.x.abs().max(c.y.abs() * aspect));
    let half = half.into_iter().fold(0.0, f64::max) * MARGIN;
    half.max(1e-3 * f64::from(bounds.radius())).max(1e-30)
}

/// The corners of a box along the axes of a camera, seen from a point.
fn corners(bounds: Bounds, from: DVec3, matrix: &DMat3) -> [DVec3; 8] {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    std::array::from_fn(|i| {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                min[axis]
            } else {
                max[axis]
            }
        };
        matrix.transpose() * (DVec3::new(pick(0), pick(1), pick(2)) - from)
    })
}
