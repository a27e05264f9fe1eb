//! Polygons into triangles.
//!
//! A convex polygon becomes the fan around its first corner, as every loader does it. Where the fan
//! would fold over (a concave polygon), ears are cut instead: a corner that turns the right way and
//! whose triangle holds no other corner.

use crate::math::{DVec3, Vec3};
use crate::texture::MeshAttribute;
use std::iter::repeat_n;

/// Ears cost the square of the number of corners; larger polygons stay fans.
const MOST_CORNERS_FOR_EARS: usize = 512;

/// Triangles of all polygons: `sizes` tells how many of the `indices` each takes. Values of the
/// polygons (attributes with `per_face` set) become values of the triangles.
pub(super) fn triangles(
    positions: &[Vec3],
    indices: &[u32],
    sizes: &[u32],
    attributes: &mut [MeshAttribute],
) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(indices.len().saturating_sub(2 * sizes.len()));
    let mut points = Vec::new();
    let mut rest = indices;
    for &size in sizes {
        let (face, next) = rest.split_at(size as usize);
        rest = next;
        if let &[a, b, c] = face {
            triangles.push([a, b, c]);
            continue;
        }
        points.clear();
        points.extend(face.iter().map(|&i| positions[i as usize]));
        triangulate(&points, |t| triangles.push(t.map(|i| face[i])));
    }
    for attribute in attributes.iter_mut().filter(|a| a.per_face) {
        let of_triangles = |(&value, &size)| repeat_n(value, (size as usize).saturating_sub(2));
        let values = attribute.values.iter().zip(sizes);
        attribute.values = values.flat_map(of_triangles).collect();
    }
    triangles
}

/// Calls `emit` with the corners (numbers into `points`) of each triangle: `points.len() - 2` times,
/// never for fewer than three points.
fn triangulate(points: &[Vec3], mut emit: impl FnMut([usize; 3])) {
    let n = points.len();
    if n < 3 {
        return;
    }
    let fan_holds = n == 3 || n > MOST_CORNERS_FOR_EARS || is_fan(points);
    if !fan_holds {
        return cut_ears(points, emit);
    }
    for i in 2..n {
        emit([0, i - 1, i]);
    }
}

/// Twice the area of a triangle, along its normal.
fn area(points: &[Vec3], [a, b, c]: [usize; 3]) -> DVec3 {
    let origin = points[a].as_dvec3();
    (points[b].as_dvec3() - origin).cross(points[c].as_dvec3() - origin)
}

/// The sum of the fan's areas: twice the polygon's (Newell).
fn newell(points: &[Vec3]) -> DVec3 {
    (2..points.len()).map(|i| area(points, [0, i - 1, i])).sum()
}

fn is_fan(points: &[Vec3]) -> bool {
    let normal = newell(points);
    (2..points.len()).all(|i| area(points, [0, i - 1, i]).dot(normal) >= 0.0)
}

fn cut_ears(points: &[Vec3], mut emit: impl FnMut([usize; 3])) {
    let normal = newell(points);
    let mut ring: Vec<usize> = (0..points.len()).collect();
    while ring.len() > 3 {
        let n = ring.len();
        let corners = |i: usize| [ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]];
        // A polygon that crosses itself may have no ear: any corner then, so that it ends.
        let ear = (0..n)
            .find(|&i| is_ear(points, normal, &ring, corners(i)))
            .unwrap_or(1);
        emit(corners(ear));
        ring.remove(ear);
    }
    emit([ring[0], ring[1], ring[2]]);
}

fn is_ear(points: &[Vec3], normal: DVec3, ring: &[usize], triangle: [usize; 3]) -> bool {
    let [a, b, c] = triangle;
    let side = |triangle| area(points, triangle).dot(normal);
    if side(triangle) <= 0.0 {
        return false;
    }
    let inside = |&p: &usize| {
        !triangle.contains(&p)
            && side([a, b, p]) >= 0.0
            && side([b, c, p]) >= 0.0
            && side([c, a, p]) >= 0.0
    };
    !ring.iter().any(inside)
}
