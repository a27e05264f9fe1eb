//! Rays that must meet something: they begin inside a closed mesh.
//!
//! A mesh is closed if each of its edges is run along as often in one direction as in the other.
//! Then the winding number (how often the surface surrounds a point) is whole everywhere but on the
//! surface, and where it is not 0 no ray can leave without crossing a triangle. Rays go in all
//! directions, and at vertices and edges, where a tracer that is not watertight lets them through.

use super::subject::Subject;
use crate::accel::{Ray, Shape, TriangleMesh};
use crate::math::{DVec3, Pcg32, Vec2, Vec3, warp};
use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::f64::consts::PI;
use std::sync::Arc;

/// Rays from inside closed meshes.
#[derive(Default)]
pub struct InsideRays {
    /// In uniform directions.
    pub uniform: Vec<Ray>,
    /// At points of edges.
    pub edges: Vec<Ray>,
    /// At vertices.
    pub vertices: Vec<Ray>,
    /// Closed meshes that stand in the world by themselves.
    pub meshes: usize,
}

/// Most points that rays begin at.
const POINTS: usize = 64;
/// Most triangles looked at while winding numbers are summed up: about a second.
const WORK: usize = 100_000_000;

/// So many rays of each kind; none if no mesh is closed.
pub fn rays_inside(subject: &Subject, count: usize) -> InsideRays {
    let closed: Vec<&Arc<TriangleMesh>> = subject
        .world
        .geometries
        .par_iter()
        .filter_map(|g| match &g.shape {
            Shape::Triangles(mesh) => Some(mesh),
            Shape::Analytic(_) => None,
        })
        .filter(|mesh| is_closed(mesh))
        .collect();
    let mut rng = Pcg32::new(11, 11);
    let points = points_inside(subject, &closed, &mut rng);
    if points.is_empty() {
        return InsideRays {
            meshes: closed.len(),
            ..InsideRays::default()
        };
    }
    let from = |i: usize| points[i % points.len()];
    let uniform = (0..count).map(|i| Ray::new(from(i).0, warp::uniform_sphere(two(&mut rng))));
    let uniform = uniform.collect();
    let edges = (0..count)
        .map(|i| aimed(from(i), rng.next_f32(), &mut rng))
        .collect();
    let vertices = (0..count).map(|i| aimed(from(i), 0.0, &mut rng)).collect();
    InsideRays {
        uniform,
        edges,
        vertices,
        meshes: closed.len(),
    }
}

fn two(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// A ray at an edge of the mesh that surrounds the point: at a vertex if `along` is 0.
fn aimed((from, mesh): (Vec3, &TriangleMesh), along: f32, rng: &mut Pcg32) -> Ray {
    let [a, b, _] = mesh.corners(rng.next_u32() % mesh.triangles().len() as u32);
    Ray::new(from, (a.lerp(b, along) - from).normalize_or(Vec3::Z))
}

/// Whether the mesh has no border. Vertices at one place are one: files repeat them along seams.
pub fn is_closed(mesh: &TriangleMesh) -> bool {
    let mut places = FxHashMap::default();
    let welded: Vec<u32> = mesh
        .positions()
        .iter()
        .map(|p| {
            // 0 and -0 are one place.
            let place = (*p + 0.0).to_array().map(f32::to_bits);
            let next = places.len() as u32;
            *places.entry(place).or_insert(next)
        })
        .collect();
    let mut balance: FxHashMap<[u32; 2], i32> = FxHashMap::default();
    for triangle in mesh.triangles() {
        let [a, b, c] = triangle.map(|i| welded[i as usize]);
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let way = if from < to { 1 } else { -1 };
            *balance.entry([from.min(to), from.max(to)]).or_default() +=
                way * i32::from(from != to);
        }
    }
    !mesh.triangles().is_empty() && balance.values().all(|sum| *sum == 0)
}

/// Points inside closed meshes, each with its mesh.
fn points_inside<'a>(
    subject: &Subject,
    closed: &[&'a Arc<TriangleMesh>],
    rng: &mut Pcg32,
) -> Vec<(Vec3, &'a TriangleMesh)> {
    let total: usize = closed.iter().map(|m| m.triangles().len()).sum();
    let mut points = Vec::new();
    let tries = (WORK / total.max(1)).clamp(8, 4 * POINTS);
    for _ in 0..tries {
        if total == 0 || points.len() == POINTS {
            break;
        }
        let mut at = ((u64::from(rng.next_u32()) * total as u64) >> 32) as usize;
        let mesh = closed.iter().find(|m| {
            let inside = at < m.triangles().len();
            at -= if inside { 0 } else { m.triangles().len() };
            inside
        });
        let Some(mesh) = mesh else { continue };
        let side = rng.next_u32() & 1 == 0;
        if let Some(p) = beside(subject, mesh.corners(at as u32), side) {
            if winding(mesh, p).round() != 0.0 {
                points.push((p, &***mesh));
            }
        }
    }
    points
}

/// A point beside the middle of a triangle, half-way to what lies across.
fn beside(subject: &Subject, [a, b, c]: [Vec3; 3], front: bool) -> Option<Vec3> {
    let normal = (b - a).cross(c - a).try_normalize()?;
    let dir = if front { normal } else { -normal };
    // So near to a corner that f32 rounds the point onto the surface, nothing could be said about
    // it.
    let smallest = 1e-4 * subject.scene.rays.bounds().radius();
    let middle = (a + b + c) / 3.0;
    let mut ray = Ray::new(middle, dir);
    ray.tmin = smallest;
    let hit = subject.scene.rays.intersect(&ray);
    (hit.is_some() && hit.t > 2.0 * smallest).then(|| ray.at(0.5 * hit.t))
}

/// How often the surface surrounds `p`: its solid angle from there (van Oosterom and Strackee 1983)
/// over that of the sphere.
pub fn winding(mesh: &TriangleMesh, p: Vec3) -> f64 {
    let p = p.as_dvec3();
    let solid_angle = |triangle: &[u32; 3]| {
        let corner = |i: u32| -> DVec3 { mesh.positions()[i as usize].as_dvec3() - p };
        let [a, b, c] = triangle.map(corner);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let below = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        2.0 * a.dot(b.cross(c)).atan2(below)
    };
    let sum: f64 = mesh.triangles().par_iter().map(solid_angle).sum();
    sum / (4.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tetrahedron whose faces have vertices of their own, as a file with normals has them.
    fn tetrahedron(faces: usize) -> TriangleMesh {
        let v = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let list = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let positions = list[..faces].iter().flatten().map(|i| v[*i]).collect();
        let triangles = (0..faces as u32)
            .map(|f| [3 * f, 3 * f + 1, 3 * f + 2])
            .collect();
        TriangleMesh::new(positions, triangles).unwrap()
    }

    #[test]
    fn a_mesh_is_closed_when_no_face_is_missing() {
        assert!(is_closed(&tetrahedron(4)));
        assert!(!is_closed(&tetrahedron(3)));
        assert!(!is_closed(&TriangleMesh::default()));
    }

    #[test]
    fn the_winding_number_is_one_inside_and_zero_outside() {
        let mesh = tetrahedron(4);
        let at = |p| winding(&mesh, p);
        assert!((at(Vec3::splat(0.1)) - 1.0).abs() < 1e-12);
        assert!(at(Vec3::splat(0.5)).abs() < 1e-12);
    }
}
