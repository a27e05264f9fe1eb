//! How geometries and instances are numbered in Embree's scenes.
//!
//! In the world's scene the geometry `i` has Embree's number `i`, and instance `k` has `n + k`, n
//! being the count of geometries. In a group's scene geometry `j` has number `j`. [`Numbers`] turns
//! Embree's numbers back into the caller's.

use super::sys::INVALID_ID;
use crate::accel::{AccelError, Hit, NO_INSTANCE, World};

/// Embree's numbers to the caller's.
#[derive(Default)]
pub struct Numbers {
    /// [`Geometry::id`] of the world's geometries, then those of each group.
    ids: Vec<u32>,
    /// How many geometries stand in the world: instances count from there.
    pub loose: u32,
    /// For each instance, where its group's geometries begin in `ids`.
    starts: Vec<u32>,
}

impl Numbers {
    /// The caller's geometry and instance for Embree's `geometry` inside Embree's `instance`.
    #[inline]
    pub fn resolve(&self, geometry: u32, instance: u32) -> (u32, u32) {
        if instance == INVALID_ID {
            return (self.ids[geometry as usize], NO_INSTANCE);
        }
        let index = instance - self.loose;
        let start = self.starts[index as usize];
        (self.ids[(start + geometry) as usize], index)
    }

    /// The same for a complete hit.
    #[inline]
    pub fn hit(&self, t: f32, uv: (f32, f32), prim: u32, geometry: u32, instance: u32) -> Hit {
        if geometry == INVALID_ID {
            return Hit::NONE;
        }
        let (shape, instance) = self.resolve(geometry, instance);
        Hit {
            t,
            u: uv.0,
            v: uv.1,
            prim,
            shape,
            instance,
        }
    }
}

/// Gives every geometry its place, and checks that all can be numbered.
pub fn number(world: &World) -> Result<Numbers, AccelError> {
    let loose = world.geometries.len();
    let total = loose + world.instances.len() + world.groups.iter().map(Vec::len).sum::<usize>();
    if total >= INVALID_ID as usize {
        return Err(AccelError::TooMany {
            what: "geometries and instances",
            count: total,
        });
    }
    let mut ids: Vec<u32> = world.geometries.iter().map(|g| g.id).collect();
    let mut group_starts = Vec::with_capacity(world.groups.len());
    for group in &world.groups {
        group_starts.push(ids.len() as u32);
        ids.extend(group.iter().map(|g| g.id));
    }
    let starts = world
        .instances
        .iter()
        .map(|i| group_starts.get(i.group as usize).copied().unwrap_or(0))
        .collect();
    Ok(Numbers {
        ids,
        loose: loose as u32,
        starts,
    })
}
