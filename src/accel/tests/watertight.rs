//! No ray leaves a closed mesh: not anywhere, not through its edges, and not through its vertices.
//!
//! Embree fails at vertices, also with its flag for robustness: its edge tests agree along an edge,
//! but where three or more meet, all of them may round to "just beside" (Embree's issues 181 and
//! 381). About one in a hundred rays aimed exactly at a vertex slips through; the tests hold it to
//! that. The tracer in pure Rust loses none.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Pcg32, Vec3};
use std::sync::Arc;

const STEPS: u32 = 200;
const RAYS: usize = 100_000;

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

/// What rays from inside are aimed at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    Vertices,
    Edges,
    Anywhere,
}

fn rays_from_inside(mesh: &TriangleMesh, center: Vec3, radius: f32, aim: Aim) -> Vec<Ray> {
    let mut rng = Pcg32::new(41, 1);
    (0..RAYS)
        .map(|_| {
            let org = center + point(&mut rng, 0.4 * radius);
            let prim = rng.next_u32() % mesh.triangles().len() as u32;
            let [a, b, _] = mesh.corners(prim);
            let dir = match aim {
                Aim::Vertices => a - org,
                Aim::Edges => a.lerp(b, rng.next_f32()) - org,
                Aim::Anywhere => direction(&mut rng),
            };
            Ray::new(org, dir.normalize())
        })
        .collect()
}

/// The share of rays that meet nothing, or are not blocked.
fn misses(tracer: &dyn RayQuery, rays: &[Ray]) -> f64 {
    let mut hits = vec![Hit::NONE; rays.len()];
    let mut blocked = vec![false; rays.len()];
    tracer.intersect_batch(rays, &mut hits);
    tracer.occluded_batch(rays, &mut blocked);
    let lost = |i: &usize| !hits[*i].is_some() || !blocked[*i];
    (0..rays.len()).filter(lost).count() as f64 / rays.len() as f64
}

/// Every tracer and aim; `allowed` says what share Embree may lose.
fn check_sphere(center: Vec3, radius: f32, quality: BuildQuality, allowed: fn(Aim) -> f64) {
    let mesh = sphere(center, radius);
    let settings = BuildSettings {
        quality,
        ..robust()
    };
    for tracer in backends(&mesh_world(Arc::clone(&mesh)), settings, None) {
        let embree = tracer.name().starts_with("Embree");
        for aim in [Aim::Vertices, Aim::Edges, Aim::Anywhere] {
            let rays = rays_from_inside(&mesh, center, radius, aim);
            let (rate, most) = (
                misses(&*tracer, &rays),
                if embree { allowed(aim) } else { 0.0 },
            );
            let place = format!("{} {quality:?} radius {radius} at {center}", tracer.name());
            assert!(rate <= most, "{place}: {rate} of rays at {aim:?} were lost");
        }
    }
}

/// One vertex in fifty, nothing else.
fn only_vertices(aim: Aim) -> f64 {
    if aim == Aim::Vertices { 0.02 } else { 0.0 }
}

#[test]
fn nothing_leaves_a_sphere_at_the_origin() {
    for quality in [BuildQuality::Balanced, BuildQuality::High] {
        check_sphere(Vec3::ZERO, 1.0, quality, only_vertices);
    }
}

/// Embree's own `verify` asks for the same place and, of rays anywhere, for the same rate.
#[test]
fn next_to_nothing_leaves_a_sphere_far_away() {
    let center = Vec3::new(148_376.0, 1234.0, -223_423.0);
    let rate = |aim| match aim {
        Aim::Vertices => 0.02,
        Aim::Edges | Aim::Anywhere => 2e-5,
    };
    check_sphere(center, 100.0, BuildQuality::Balanced, rate);
    // Here a vertex is rounded by half the length of an edge, and what was an edge may be a vertex.
    let rounded = |aim| match aim {
        Aim::Vertices | Aim::Edges => 0.02,
        Aim::Anywhere => 2e-5,
    };
    check_sphere(center, 2.0, BuildQuality::Balanced, rounded);
    check_sphere(center, 2.0, BuildQuality::High, rounded);
}

/// The unit of length does not matter.
#[test]
fn nothing_leaves_tiny_and_huge_spheres() {
    for radius in [1e-6, 1e6] {
        check_sphere(Vec3::ZERO, radius, BuildQuality::Balanced, only_vertices);
    }
}
