//! What both backends do with a [`World`] before they build: check it, and bound it.

use super::{AccelError, Bounds, Geometry, Shape, World};
use crate::math::Affine3A;
use rayon::prelude::*;

/// Every instance must name a group that exists and stand by a map that can be inverted.
pub fn check(world: &World) -> Result<(), AccelError> {
    let groups = world.groups.len();
    for (instance, placed) in world.instances.iter().enumerate() {
        if placed.group as usize >= groups {
            return Err(AccelError::MissingGroup {
                instance,
                group: placed.group,
                groups,
            });
        }
        let sound = placed.to_world.is_finite() && largest(&placed.to_world.inverse()) < STEEPEST;
        if !sound {
            return Err(AccelError::SingularInstance { instance });
        }
    }
    Ok(())
}

/// The steepest way into a group's space: beyond it rays would leave the range of `f32`.
const STEEPEST: f32 = 1e15;

/// Largest component of a map's linear part; NaN if any is.
fn largest(map: &Affine3A) -> f32 {
    let columns = map.matrix3.to_cols_array();
    if !map.is_finite() {
        return f32::NAN;
    }
    columns.into_iter().fold(0.0, |m, c| m.max(c.abs()))
}

/// The factor for [`Ray::is_traceable_within`](super::Ray::is_traceable_within) such that a ray
/// which passes stays below [`LARGEST`](super::LARGEST) in the space of every instance, too.
#[cfg(feature = "embree")]
pub fn overflow_factor(world: &World) -> f32 {
    let steepest = world
        .instances
        .iter()
        .map(|i| 4.0 * largest(&i.to_world.inverse()))
        .fold(1.0, f32::max);
    super::OVERFLOW * steepest
}

/// Bounds of all that rays can meet. Triangles with a corner that is not finite do not count: no
/// backend finds them.
pub fn world_bounds(world: &World) -> Bounds {
    let groups: Vec<Bounds> = world.groups.iter().map(|g| bounds_of_all(g)).collect();
    let mut bounds = bounds_of_all(&world.geometries);
    for instance in &world.instances {
        let Some(group) = groups.get(instance.group as usize) else {
            continue;
        };
        bounds = bounds.union(transformed(*group, &instance.to_world));
    }
    bounds
}

/// The box around a box's eight corners after a map; empty stays empty.
pub fn transformed(b: Bounds, map: &Affine3A) -> Bounds {
    if b.is_empty() {
        return b;
    }
    let (min, max) = (b.min, b.max);
    (0..8).fold(Bounds::EMPTY, |grown, i| {
        let mut corner = min;
        for axis in 0..3 {
            if i >> axis & 1 == 1 {
                corner[axis] = max[axis];
            }
        }
        grown.with(map.transform_point3(corner))
    })
}

fn bounds_of_all(geometries: &[Geometry]) -> Bounds {
    let bounds = geometries.par_iter().map(|g| bounds_of(&g.shape));
    bounds.reduce(|| Bounds::EMPTY, Bounds::union)
}

fn bounds_of(shape: &Shape) -> Bounds {
    match shape {
        Shape::Triangles(mesh) => mesh.bounds(),
        Shape::Analytic(exact) => {
            let b = exact.bounds();
            let finite = b.min.is_finite() && b.max.is_finite();
            if finite { b } else { Bounds::EMPTY }
        }
    }
}
