//! Worlds and rays the tests share.

use crate::accel::*;
use crate::math::{Pcg32, Vec2, warp};
use std::sync::Arc;

/// Each backend over the same world.
pub fn backends(
    world: &World,
    settings: BuildSettings,
    opacity: Option<&Arc<dyn Opacity>>,
) -> Vec<Box<dyn RayQuery>> {
    let names: &[Backend] = if cfg!(feature = "embree") {
        &[Backend::Embree]
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
