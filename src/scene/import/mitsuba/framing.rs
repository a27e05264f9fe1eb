//! A camera for scenes that have none: it looks at all of the scene from the front, a little from above.

use super::sensors::{Sensor, default_film};
use crate::accel::Bounds;
use crate::camera::{CameraDescription, FovAxis, Projection};
use crate::math::{DAffine3, DVec3, Vec3};
use crate::scene::description::SamplerKind;
use crate::scene::{Geometry, Shape};
use glam::DMat3;

/// Full field of view along the picture's shorter side, degrees.
const FOV_DEGREES: f64 = 40.0;

/// A sensor that sees all shapes.
pub(super) fn frame(shapes: &[Shape], instances: &[(u32, DAffine3)]) -> Sensor {
    let bounds = world_bounds(shapes, instances);
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

/// Bounds of everything that rays can meet.
pub(super) fn world_bounds(shapes: &[Shape], instances: &[(u32, DAffine3)]) -> Bounds {
    let groups = shapes.iter().filter_map(|s| s.group).max();
    let mut of_group = vec![Bounds::EMPTY; groups.map_or(0, |g| g as usize + 1)];
    let mut world = Bounds::EMPTY;
    for shape in shapes {
        let bounds = shape_bounds(&shape.geometry);
        match shape.group {
            Some(group) => {
                let slot = &mut of_group[group as usize];
                *slot = slot.union(bounds);
            }
            None => world = world.union(bounds),
        }
    }
    for (group, to_world) in instances {
        let Some(bounds) = of_group.get(*group as usize).filter(|b| !b.is_empty()) else {
            continue;
        };
        for i in 0..8 {
            let pick = |bit: u32, low: f32, high: f32| if i >> bit & 1 == 0 { low } else { high };
            let corner = Vec3::new(
                pick(0, bounds.min.x, bounds.max.x),
                pick(1, bounds.min.y, bounds.max.y),
                pick(2, bounds.min.z, bounds.max.z),
            );
            world = world.with(to_world.transform_point3(corner.as_dvec3()).as_vec3());
        }
    }
    world
}

/// Bounds of a shape in its own space: the world, or its group.
pub(super) fn shape_bounds(geometry: &Geometry) -> Bounds {
    match geometry {
        Geometry::Exact(shape) => shape.bounds(),
        Geometry::Mesh(mesh) => {
            let positions = mesh.triangles.positions().iter();
            positions.fold(Bounds::EMPTY, |b, p| b.with(*p))
        }
    }
}
