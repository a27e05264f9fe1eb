//! Normals at vertices.
//!
//! Smooth normals weight each triangle's normal by its angle at the vertex (Thuermer and Wuethrich
//! 1998): unlike weights by area they do not depend on how a face was cut into triangles.

use crate::math::{DAffine3, DVec3, Vec3, Vec4};
use rayon::prelude::*;
use std::f32::consts::{FRAC_PI_2, PI};

/// Triangles whose contributions are held at once. They are computed by all threads and added by
/// one, in order: the same sums whatever the number of threads.
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
/// tan(angle) = |cross| / dot of the two sides, and the cross product has the same length at all
/// three corners.
#[inline]
pub(super) fn contributions(positions: &[Vec3], triangle: &[u32; 3]) -> [Vec3; 3] {
    let [a, b, c] = triangle.map(|i| positions[i as usize].as_dvec3());
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let normal = ab.cross(-ca);
    let length = normal.length();
    // The square of a length beyond this would leave the range of f64.
    let unit = match (1e-150..1e150).contains(&length) {
        true => (normal * (1.0 / length)).as_vec3(),
        false => match unit(normal) {
            Some(unit) => unit,
            None => return [Vec3::ZERO; 3],
        },
    };
    let dots = [-ab.dot(ca), -ab.dot(bc), -bc.dot(ca)];
    // The ratio survives the step to f32, whatever the mesh's size.
    dots.map(|dot| {
        let scale = 1.0 / length.max(dot.abs());
        unit * angle((length * scale) as f32, (dot * scale) as f32)
    })
}

/// The angle of the direction `(x, y)` from +x, for `y` not below 0: a polynomial for the arc
/// tangent (Abramowitz and Stegun 4.4.49, error below 2e-8) between 0 and 1. The library's function
/// took half of the time that meshes without normals needed to load.
#[inline]
fn angle(y: f32, x: f32) -> f32 {
    const TERMS: [f32; 8] = [
        0.002_866_225_7,
        -0.016_165_737,
        0.042_909_614,
        -0.075_289_64,
        0.106_562_64,
        -0.142_089,
        0.199_935_51,
        -0.333_331_45,
    ];
    let across = x.abs();
    let t = y.min(across) / y.max(across);
    let square = t * t;
    let sum = TERMS.iter().fold(0.0, |sum, term| (sum + term) * square);
    let arc = t + t * sum;
    let arc = if y > across { FRAC_PI_2 - arc } else { arc };
    if x < 0.0 { PI - arc } else { arc }
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
    let compute = |triangles: &[[u32; 3]], batch: &mut Vec<[Vec3; 3]>| {
        triangles
            .par_iter()
            .with_min_len(GRAIN)
            .map(|t| contributions(positions, t))
            .collect_into_vec(batch);
    };
    let mut sums = vec![Vec3::ZERO; count];
    let mut batches = triangles.chunks(BATCH);
    let (mut batch, mut next) = (Vec::new(), Vec::new());
    compute(batches.next().unwrap_or_default(), &mut batch);
    for targets in targets.chunks(BATCH) {
        // The next batch is computed while one thread adds this one.
        let add = || {
            for (corners, to) in batch.iter().zip(targets) {
                for (&normal, &to) in corners.iter().zip(to) {
                    sums[to as usize] += normal;
                }
            }
        };
        let after = batches.next().unwrap_or_default();
        rayon::join(add, || compute(after, &mut next));
        std::mem::swap(&mut batch, &mut next);
    }
    sums
}

/// Normals of the file in world space: by the inverse transpose, of unit length, or zero where
/// there is no direction in it.
pub(super) fn transform(normals: Vec<Vec3>, to_world: &DAffine3) -> Vec<Vec3> {
    let matrix = to_world.matrix3.inverse().transpose();
    let to_unit = |n: Vec3| unit(matrix * n.as_dvec3()).unwrap_or(Vec3::ZERO);
    normals
        .into_par_iter()
        .with_min_len(GRAIN)
        .map(to_unit)
        .collect()
}

/// Unit tangents in world space; zero where the file gives none. A mirror turns the texture's side
/// around.
pub(super) fn tangents(mut list: Vec<Vec4>, to_world: &DAffine3) -> Vec<Vec4> {
    let mirror = to_world.matrix3.determinant().signum() as f32;
    list.par_iter_mut().with_min_len(GRAIN).for_each(|t| {
        let along = to_world.matrix3 * t.truncate().as_dvec3();
        let side = if t.w < 0.0 { -mirror } else { mirror };
        *t = unit(along).unwrap_or(Vec3::ZERO).extend(side);
    });
    list
}

/// Replaces zero normals by the surface's own. Also how many vertices of triangles were repaired
/// and the first of them, if any.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_those_of_the_arc_tangent() {
        for i in 0..=3600 {
            let exact = (f64::from(i) * 0.05).to_radians();
            let (y, x) = (exact.sin().max(0.0) as f32, exact.cos() as f32);
            let error = f64::from(angle(y, x)) - f64::from(y).atan2(x.into());
            assert!(error.abs() < 4e-7, "{exact}: {error}");
        }
        assert_eq!(angle(0.0, 1.0), 0.0);
        assert_eq!(angle(0.0, -1.0), PI);
        assert_eq!(angle(1.0, 0.0), FRAC_PI_2);
    }
}
