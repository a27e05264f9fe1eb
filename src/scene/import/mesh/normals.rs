//! Normals at vertices.
//!
//! Smooth normals weight each triangle's normal by its angle at the vertex (Thuermer and Wuethrich
//! 1998): unlike weights by area they do not depend on how a face was cut into triangles.

use crate::math::{DAffine3, DVec3, Vec3};
use rayon::prelude::*;

/// Triangles whose contributions are held at once. They are computed by all threads and added by one,
/// in order: the same sums whatever the number of threads.
const BATCH: usize = 1 << 16;
/// Items a thread takes at once.
const GRAIN: usize = 1 << 12;

/// Twice the area of a triangle, along its normal.
#[inline]
pub(super) fn cross(positions: &[Vec3], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
    (b - a).cross(c - a)
}

/// The unit vector along `v`, whatever its length; `None` if it has no direction.
pub(super) fn unit(v: DVec3) -> Option<Vec3> {
    // Scaled first, so that the squares of neither tiny nor huge components leave the range.
    let unit = (v / v.abs().max_element()).normalize().as_vec3();
    unit.is_finite().then_some(unit)
}

/// What a triangle adds to its three corners: its unit normal times the angle there.
///
/// tan(angle) = |cross| / dot of the two sides, and the cross product has the same length at all three
/// corners.
#[inline]
pub(super) fn contributions(positions: &[Vec3], triangle: &[u32; 3]) -> [Vec3; 3] {
    let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let normal = ab.cross(-ca);
    let length = normal.length();
    let Some(unit) = unit(normal) else {
        return [Vec3::ZERO; 3];
    };
    let dots = [-ab.dot(ca), -ab.dot(bc), -bc.dot(ca)];
    // The ratio survives the step to f32, whatever the mesh's size.
    dots.map(|dot| {
        let scale = 1.0 / length.max(dot.abs());
        let angle = ((length * scale) as f32).atan2((dot * scale) as f32);
        unit * angle
    })
}

/// Angle-weighted unit normals. A vertex without triangles gets +z.
pub(super) fn smooth(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let sums = accumulate(positions, triangles, triangles, positions.len());
    sums.into_par_iter()
        .with_min_len(GRAIN)
        .map(|n| unit(n.as_dvec3()).unwrap_or(Vec3::Z))
        .collect()
}

/// Sums of [`contributions`] of `triangles` at `targets` (the vertex that each corner adds to).
pub(super) fn accumulate(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    targets: &[[u32; 3]],
    count: usize,
) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; count];
    let mut batch = Vec::new();
    for (triangles, targets) in triangles.chunks(BATCH).zip(targets.chunks(BATCH)) {
        triangles
            .par_iter()
            .with_min_len(GRAIN)
            .map(|t| contributions(positions, t))
            .collect_into_vec(&mut batch);
        for (corners, to) in batch.iter().zip(targets) {
            for (&normal, &to) in corners.iter().zip(to) {
                sums[to as usize] += normal;
            }
        }
    }
    sums
}

/// Normals of the file in world space: by the inverse transpose, of unit length, or zero where there
/// is no direction in it.
pub(super) fn transform(normals: Vec<Vec3>, to_world: &DAffine3) -> Vec<Vec3> {
    let matrix = to_world.matrix3.inverse().transpose();
    let to_unit = |n: Vec3| unit(matrix * n.as_dvec3()).unwrap_or(Vec3::ZERO);
    normals
        .into_par_iter()
        .with_min_len(GRAIN)
        .map(to_unit)
        .collect()
}

/// Replaces zero normals by the surface's own. Also how many vertices of triangles were repaired and
/// the first of them, if any.
pub(super) fn repair(
    mut normals: Vec<Vec3>,
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> (Vec<Vec3>, Option<(usize, usize)>) {
    if !normals
        .par_iter()
        .with_min_len(GRAIN)
        .any(|n| *n == Vec3::ZERO)
    {
        return (normals, None);
    }
    let lacks = |t: &&[u32; 3]| t.iter().any(|&i| normals[i as usize] == Vec3::ZERO);
    let around: Vec<[u32; 3]> = triangles.iter().filter(lacks).copied().collect();
    let sums = accumulate(positions, &around, &around, positions.len());
    let mut used = vec![false; positions.len()];
    for &i in around.iter().flatten() {
        used[i as usize] = true;
    }
    let mut repaired = None;
    for (i, normal) in normals.iter_mut().enumerate() {
        if *normal != Vec3::ZERO {
            continue;
        }
        *normal = unit(sums[i].as_dvec3()).unwrap_or(Vec3::Z);
        if used[i] {
            let (count, first) = repaired.unwrap_or((0, i));
            repaired = Some((count + 1, first));
        }
    }
    (normals, repaired)
}
