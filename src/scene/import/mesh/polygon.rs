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
/// Corners tried as ears, for each corner of a polygon.
const TRIES_OF_CORNER: usize = 8;

/// What polygons become.
pub(super) struct Cut {
    pub triangles: Vec<[u32; 3]>,
    /// What is said about polygons that could not be cut as they should.
    pub warning: Option<String>,
}

/// Triangles of all polygons: `sizes` tells how many of the `indices` each takes. Values of the
/// polygons (attributes with `per_face` set) become values of the triangles.
pub(super) fn triangles(
    positions: &[Vec3],
    indices: &[u32],
    sizes: &[u32],
    attributes: &mut [MeshAttribute],
) -> Cut {
    let mut triangles = Vec::with_capacity(indices.len().saturating_sub(2 * sizes.len()));
    let (mut points, mut folded) = (Vec::new(), Vec::new());
    let mut rest = indices;
    for (at, &size) in sizes.iter().enumerate() {
        let (face, next) = rest.split_at(size as usize);
        rest = next;
        if let &[a, b, c] = face {
            triangles.push([a, b, c]);
            continue;
        }
        points.clear();
        points.extend(face.iter().map(|&i| positions[i as usize]));
        let cut_well = triangulate(&points, |t| triangles.push(t.map(|i| face[i])));
        if !cut_well {
            folded.push(at);
        }
    }
    let warning = folded.first().map(|first| {
        let count = folded.len();
        format!(
            "{count} concave polygons with many corners or crossing sides are fans of triangles that may fold over, the first is face {first} (counted from 0)"
        )
    });
    for attribute in attributes.iter_mut().filter(|a| a.per_face) {
        let of_triangles = |(&value, &size)| repeat_n(value, (size as usize).saturating_sub(2));
        let values = attribute.values.iter().zip(sizes);
        attribute.values = values.flat_map(of_triangles).collect();
    }
    Cut { triangles, warning }
}

/// Calls `emit` with the corners (numbers into `points`) of each triangle: `points.len() - 2`
/// times, never for fewer than three points. False if the triangles may fold over.
fn triangulate(points: &[Vec3], mut emit: impl FnMut([usize; 3])) -> bool {
    let n = points.len();
    if n < 3 {
        return true;
    }
    let fan_holds = n == 3 || is_fan(points);
    if !fan_holds && n <= MOST_CORNERS_FOR_EARS {
        return cut_ears(points, emit);
    }
    for i in 2..n {
        emit([0, i - 1, i]);
    }
    fan_holds
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

/// False if what remained had no ear, and became a fan.
fn cut_ears(points: &[Vec3], mut emit: impl FnMut([usize; 3])) -> bool {
    let normal = newell(points);
    let mut ring: Vec<usize> = (0..points.len()).collect();
    // Where an ear was cut, its neighbours often become ears: the search goes on there, and few
    // corners are tried for each. A polygon that crosses itself may have none.
    let mut tries = TRIES_OF_CORNER * points.len();
    let (mut at, mut since) = (1, 0);
    while ring.len() > 3 && since < ring.len() && tries > 0 {
        let n = ring.len();
        at %= n;
        let corners = [ring[(at + n - 1) % n], ring[at], ring[(at + 1) % n]];
        if is_ear(points, normal, &ring, corners) {
            emit(corners);
            ring.remove(at);
            (at, since) = ((at + n - 1) % n, 0);
        } else {
            (at, since) = (at + 1, since + 1);
        }
        tries -= 1;
    }
    for i in 2..ring.len() {
        emit([ring[0], ring[i - 1], ring[i]]);
    }
    ring.len() == 3
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
