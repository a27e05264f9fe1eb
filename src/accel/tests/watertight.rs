//! No ray leaves a closed mesh, not even through its vertices and edges.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Pcg32, Vec3};
use std::sync::Arc;

const STEPS: u32 = 200;
const RAYS: usize = 200_000;

/// A sphere of 200 by 200 quads around `center`, closed at the poles and along the seam.
fn sphere(center: Vec3, radius: f32) -> Arc<TriangleMesh> {
    let mut positions = vec![center + Vec3::Z * radius, center - Vec3::Z * radius];
    for i in 1..STEPS {
        for j in 0..STEPS {
            let theta = std::f32::consts::PI * i as f32 / STEPS as f32;
            let phi = std::f32::consts::TAU * j as f32 / STEPS as f32;
            let (sin, cos) = theta.sin_cos();
            let p = Vec3::new(sin * phi.cos(), sin * phi.sin(), cos);
            positions.push(center + p * radius);
        }
    }
    let vertex = |i: u32, j: u32| match i {
        0 => 0,
        STEPS => 1,
        _ => 2 + (i - 1) * STEPS + j % STEPS,
    };
    let mut triangles = Vec::new();
    for i in 0..STEPS {
        for j in 0..STEPS {
            let [a, b] = [vertex(i, j), vertex(i, j + 1)];
            let [c, d] = [vertex(i + 1, j), vertex(i + 1, j + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    Arc::new(TriangleMesh::new(positions, triangles).unwrap())
}

/// A third of the rays aimed at vertices, a third at edges, a third anywhere.
fn rays_from_inside(mesh: &TriangleMesh, center: Vec3, radius: f32) -> Vec<Ray> {
    let mut rng = Pcg32::new(41, 1);
    (0..RAYS)
        .map(|i| {
            let org = center + point(&mut rng, 0.4 * radius);
            let prim = rng.next_u32() % mesh.triangles().len() as u32;
            let [a, b, _] = mesh.corners(prim);
            let dir = match i % 3 {
                0 => a - org,
                1 => a.lerp(b, rng.next_f32()) - org,
                _ => direction(&mut rng),
            };
            Ray::new(org, dir.normalize())
        })
        .collect()
}

fn misses(tracer: &dyn RayQuery, rays: &[Ray]) -> usize {
    let mut hits = vec![Hit::NONE; rays.len()];
    let mut blocked = vec![false; rays.len()];
    tracer.intersect_batch(rays, &mut hits);
    tracer.occluded_batch(rays, &mut blocked);
    let lost = |i: &usize| !hits[*i].is_some() || !blocked[*i];
    (0..rays.len()).filter(lost).count()
}

#[test]
fn nothing_leaves_a_sphere_at_the_origin() {
    for quality in [BuildQuality::Balanced, BuildQuality::High] {
        let mesh = sphere(Vec3::ZERO, 1.0);
        let rays = rays_from_inside(&mesh, Vec3::ZERO, 1.0);
        let settings = BuildSettings {
            quality,
            ..robust()
        };
        for tracer in backends(&mesh_world(mesh), settings, None) {
            assert_eq!(misses(&*tracer, &rays), 0, "{}", tracer.name());
        }
    }
}

/// Embree's own `verify` asks for the same place and the same rate.
#[test]
fn next_to_nothing_leaves_a_sphere_far_away() {
    let center = Vec3::new(148_376.0, 1234.0, -223_423.0);
    for radius in [1.0, 100.0] {
        let mesh = sphere(center, radius);
        let rays = rays_from_inside(&mesh, center, radius);
        for tracer in backends(&mesh_world(mesh), robust(), None) {
            let rate = misses(&*tracer, &rays) as f64 / RAYS as f64;
            assert!(rate <= 2e-5, "{} radius {radius}: {rate}", tracer.name());
        }
    }
}

/// The walk may not depend on the unit of length.
#[test]
fn nothing_leaves_tiny_and_huge_spheres() {
    for radius in [1e-6, 1e6] {
        let mesh = sphere(Vec3::ZERO, radius);
        let rays = rays_from_inside(&mesh, Vec3::ZERO, radius);
        for tracer in backends(&mesh_world(mesh), robust(), None) {
            assert_eq!(misses(&*tracer, &rays), 0, "{} {radius}", tracer.name());
        }
    }
}
