//! A camera for scenes that have none: it looks at all of the scene from the front, a little from
//! above.

use super::films::default_film;
use super::pending::Sensor;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::math::{DAffine3, DVec3};
use crate::medium::VACUUM;
use crate::scene::Shape;
use crate::scene::description::SamplerKind;
use crate::scene::import::parts::bounds_of;
use glam::DMat3;

/// Full field of view along the picture's shorter side, degrees.
const FOV_DEGREES: f64 = 40.0;

/// A sensor that sees all shapes.
pub(super) fn frame(shapes: &[Shape], instances: &[(u32, DAffine3)]) -> Sensor {
    let bounds = bounds_of(shapes, instances);
    let center = bounds.center().as_dvec3();
    let radius = f64::from(bounds.radius()).max(1e-6);
    // The sphere around the scene touches the picture's edge.
    let distance = radius / (0.5 * FOV_DEGREES.to_radians()).sin();
    let from = DVec3::new(0.35, 0.3, 1.0).normalize();
    let forward = -from;
    let left = DVec3::Y.cross(forward).normalize();
    let up = forward.cross(left);
    let to_world = DAffine3 {
        matrix3: DMat3::from_cols(left, up, forward),
        translation: center + from * distance,
    };
    Sensor {
        medium: VACUUM,
        camera: CameraDescription {
            to_world,
            projection: Projection::Perspective {
                fov_degrees: FOV_DEGREES,
                fov_axis: FovAxis::Smaller,
                principal_point: [0.0; 2],
            },
            near_clip: 1e-4 * distance,
            far_clip: 10.0 * distance,
        },
        film: default_film(),
        spp: None,
        sampler: SamplerKind::default(),
    }
}
