//! Worlds and rays the tests share.

use crate::accel::*;
use crate::math::{Affine3A, Pcg32, Vec2, Vec3, warp};
use std::sync::Arc;

/// Each backend over the same world.
pub fn backends(
    world: &World,
    settings: BuildSettings,
    opacity: Option<&Arc<dyn Opacity>>,
) -> Vec<Box<dyn RayQuery>> {
    let names: &[Backend] = if cfg!(feature = "embree") {
        &[Backend::Embree, Backend::Obvhs]
    } else {
        &[Backend::Obvhs]
    };
    names
        .iter()
        .map(|&backend| build(world.clone(), settings, opacity.cloned(), backend).unwrap())
        .collect()
}

/// Robust and on one thread, as the tests trace.
pub fn robust() -> BuildSettings {
    BuildSettings {
        robust: true,
        threads: 1,
        ..Default::default()
    }
}

/// Uniform in the cube `[-half, half]^3`.
pub fn point(rng: &mut Pcg32, half: f32) -> Vec3 {
    let mut one = || (2.0 * rng.next_f32() - 1.0) * half;
    Vec3::new(one(), one(), one())
}

/// Uniform on the sphere.
pub fn direction(rng: &mut Pcg32) -> Vec3 {
    warp::uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32()))
}

/// Triangles of every size and orientation in `[-1, 1]^3`.
pub fn soup(count: usize, size: f32, seed: u64) -> Arc<TriangleMesh> {
    let mut rng = Pcg32::new(seed, 1);
    let mut positions = Vec::with_capacity(3 * count);
    for _ in 0..count {
        let center = point(&mut rng, 1.0);
        for _ in 0..3 {
            positions.push(center + point(&mut rng, size));
        }
    }
    let triangles = (0..count as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    Arc::new(TriangleMesh::new(positions, triangles.collect()).unwrap())
}

/// One opaque geometry.
pub fn geometry(id: u32, shape: Shape) -> Geometry {
    Geometry {
        id,
        shape,
        masked: false,
    }
}

/// A world of one mesh, whose id is 7.
pub fn mesh_world(mesh: Arc<TriangleMesh>) -> World {
    World {
        geometries: vec![geometry(7, Shape::Triangles(mesh))],
        ..Default::default()
    }
}

/// Rays from inside the cube `[-half, half]^3` in all directions.
pub fn rays(count: usize, half: f32, seed: u64) -> Vec<Ray> {
    let mut rng = Pcg32::new(seed, 2);
    (0..count)
        .map(|_| {
            let org = point(&mut rng, half);
            Ray::new(org, direction(&mut rng))
        })
        .collect()
}

/// A map that turns, stretches and moves within `[-half, half]^3`.
pub fn random_map(rng: &mut Pcg32, half: f32) -> Affine3A {
    let axis = direction(rng);
    let scale = (point(rng, 1.0) * 2.0).map(f32::exp2);
    let map = Affine3A::from_axis_angle(axis, 6.0 * rng.next_f32()) * Affine3A::from_scale(scale);
    Affine3A::from_translation(point(rng, half)) * map
}

/// All kinds of exact shapes, loose and in groups with meshes, and instances of the groups.
pub fn mixed_world() -> World {
    let mut rng = Pcg32::new(8, 8);
    let kinds = [
        AnalyticKind::Sphere,
        AnalyticKind::Disk,
        AnalyticKind::Cylinder,
        AnalyticKind::Rectangle,
    ];
    let mut exact = |id: u32, half: f32| {
        let small = Affine3A::from_scale(Vec3::splat(0.3));
        let map = random_map(&mut rng, half) * small;
        geometry(
            id,
            Shape::Analytic(AnalyticShape::new(kinds[id as usize % 4], map)),
        )
    };
    let mut world = World::default();
    world.geometries.extend((100..116).map(|id| exact(id, 2.0)));
    world
        .geometries
        .push(geometry(50, Shape::Triangles(soup(40, 0.3, 9))));
    for group in 0..3 {
        let mut members: Vec<_> = (0..4).map(|i| exact(200 + 10 * group + i, 1.0)).collect();
        let mesh = soup(20, 0.4, 10 + u64::from(group));
        members.push(geometry(60 + group, Shape::Triangles(mesh)));
        world.groups.push(members);
    }
    let mut rng = Pcg32::new(9, 9);
    for i in 0..9 {
        // Group 2 stays unused: a backend may not confuse the numbering.
        let map = random_map(&mut rng, 3.0) * Affine3A::from_scale(Vec3::splat(0.5));
        world.instances.push(Instance {
            group: i % 2,
            to_world: map,
        });
    }
    world
}
