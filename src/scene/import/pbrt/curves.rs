//! Curves as meshes: round ones as tubes, ribbons as strips.

use super::pending::Curve;
use crate::math::{Vec2, Vec3};
use crate::scene::import::mesh::Buffers;

/// Pieces of a segment.
const PIECES: usize = 6;
/// Sides of a tube.
const SIDES: usize = 6;

/// A place of a curve.
struct Station {
    at: Vec3,
    along: Vec3,
    width: f32,
    /// 0 to 1 over the whole curve.
    v: f32,
    normal: Option<Vec3>,
}

/// Meshes of curves, one after the other.
pub(super) fn tessellate(list: &[Curve]) -> Buffers {
    let mut out = Buffers {
        normals: Some(Vec::new()),
        uvs: Some(Vec::new()),
        ..Buffers::default()
    };
    for curve in list {
        let stations = stations(curve);
        match curve.normals {
            Some(_) => ribbon(&mut out, &stations),
            None => tube(&mut out, &stations),
        }
    }
    out
}

fn stations(curve: &Curve) -> Vec<Station> {
    let points: Vec<Vec3> = curve.points.chunks_exact(3).map(Vec3::from_slice).collect();
    let degree = curve.degree;
    let segments = match curve.is_spline {
        true => points.len() - degree,
        false => (points.len() - 1) / degree,
    };
    let mut out = Vec::with_capacity(segments * PIECES + 1);
    for segment in 0..segments {
        let first = if curve.is_spline {
            segment
        } else {
            segment * degree
        };
        let bezier = cubic(&points[first..=first + degree], curve.is_spline);
        let last = usize::from(segment + 1 == segments);
        for piece in 0..PIECES + last {
            let t = piece as f32 / PIECES as f32;
            let v = (segment as f32 + t) / segments as f32;
            let (at, along) = point(&bezier, t);
            let normal = curve.normals.map(|list| {
                let [a, b] = [0, 3].map(|k| Vec3::from_slice(&list[3 * segment + k..]));
                a.lerp(b, t)
            });
            out.push(Station {
                at,
                along,
                width: curve.widths[0] + (curve.widths[1] - curve.widths[0]) * v,
                v,
                normal,
            });
        }
    }
    out
}

/// The four control points of a cubic Bezier curve that is the same as a segment.
fn cubic(p: &[Vec3], is_spline: bool) -> [Vec3; 4] {
    match (p, is_spline) {
        (&[a, b, c], false) => raised(a, b, c),
        (&[a, b, c], true) => raised(a.midpoint(b), b, b.midpoint(c)),
        (&[a, b, c, d], false) => [a, b, c, d],
        (&[a, b, c, d], true) => {
            let [b1, c1] = [b.lerp(c, 1.0 / 3.0), b.lerp(c, 2.0 / 3.0)];
            let before = a.lerp(b, 2.0 / 3.0);
            let after = c.lerp(d, 1.0 / 3.0);
            [before.midpoint(b1), b1, c1, c1.midpoint(after)]
        }
        // Degrees were checked.
        _ => [Vec3::ZERO; 4],
    }
}

/// A quadratic curve as a cubic one.
fn raised(a: Vec3, b: Vec3, c: Vec3) -> [Vec3; 4] {
    [a, a.lerp(b, 2.0 / 3.0), c.lerp(b, 2.0 / 3.0), c]
}

/// Place and direction at `t` (de Casteljau).
fn point(p: &[Vec3; 4], t: f32) -> (Vec3, Vec3) {
    let mut q = *p;
    for last in (2..4).rev() {
        for i in 0..last {
            q[i] = q[i].lerp(q[i + 1], t);
        }
    }
    let chord = p[3] - p[0];
    let along = (q[1] - q[0])
        .try_normalize()
        .unwrap_or(chord.normalize_or(Vec3::Z));
    (q[0].lerp(q[1], t), along)
}

/// A tube around the stations, its frame carried along without twist.
fn tube(out: &mut Buffers, stations: &[Station]) {
    let first = out.positions.len() as u32;
    let Some(begin) = stations.first() else {
        return;
    };
    let mut side = begin.along.any_orthonormal_vector();
    for station in stations {
        side = side.reject_from_normalized(station.along);
        side = side
            .try_normalize()
            .unwrap_or(station.along.any_orthonormal_vector());
        let up = station.along.cross(side);
        for k in 0..=SIDES {
            let u = k as f32 / SIDES as f32;
            let (sin, cos) = (u * std::f32::consts::TAU).sin_cos();
            let normal = side * cos + up * sin;
            let at = station.at + normal * (0.5 * station.width);
            push(out, at, normal, Vec2::new(u, station.v));
        }
    }
    let row = SIDES as u32 + 1;
    for (j, k) in (0..stations.len() as u32 - 1).flat_map(|j| (0..row - 1).map(move |k| (j, k))) {
        let a = first + j * row + k;
        quad(out, [a, a + 1, a + row, a + row + 1]);
    }
}

fn ribbon(out: &mut Buffers, stations: &[Station]) {
    let first = out.positions.len() as u32;
    for station in stations {
        let normal = station
            .normal
            .unwrap_or(Vec3::Z)
            .reject_from_normalized(station.along);
        let normal = normal
            .try_normalize()
            .unwrap_or(station.along.any_orthonormal_vector());
        let side = normal.cross(station.along) * (0.5 * station.width);
        push(out, station.at - side, normal, Vec2::new(0.0, station.v));
        push(out, station.at + side, normal, Vec2::new(1.0, station.v));
    }
    for j in 0..stations.len() as u32 - 1 {
        let a = first + 2 * j;
        quad(out, [a, a + 1, a + 2, a + 3]);
    }
}

fn push(out: &mut Buffers, at: Vec3, normal: Vec3, uv: Vec2) {
    out.positions.push(at);
    out.normals.get_or_insert_default().push(normal);
    out.uvs.get_or_insert_default().push(uv);
}

fn quad(out: &mut Buffers, [a, b, c, d]: [u32; 4]) {
    out.triangles.push([a, b, d]);
    out.triangles.push([a, d, c]);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve<'s>(points: &'s [f32], degree: usize, is_spline: bool) -> Curve<'s> {
        Curve {
            points,
            degree,
            is_spline,
            widths: [0.2, 0.1],
            normals: None,
        }
    }

    /// A B-spline at its knots: (a + 4 b + c) / 6 of the cubic, (a + b) / 2 of the quadratic one.
    #[test]
    fn splines_pass_where_they_should() {
        let p = [0., 0., 0., 1., 2., 0., 3., 1., 1., 4., 0., 0., 6., 0., 0.];
        let cubic = stations(&curve(&p, 3, true));
        let expected =
            (Vec3::new(0., 0., 0.) + Vec3::new(1., 2., 0.) * 4.0 + Vec3::new(3., 1., 1.)) / 6.0;
        assert!((cubic[0].at - expected).length() < 1e-6);
        assert_eq!(cubic.len(), 2 * PIECES + 1);
        let quadratic = stations(&curve(&p, 2, true));
        assert!((quadratic[0].at - Vec3::new(0.5, 1.0, 0.0)).length() < 1e-6);
        let bezier = stations(&curve(&p, 2, false));
        assert_eq!(bezier[0].at, Vec3::ZERO);
        assert!((bezier[2 * PIECES].at - Vec3::new(6., 0., 0.)).length() < 1e-6);
        assert!((bezier[2 * PIECES].width - 0.1).abs() < 1e-6);
        // The middle of a quadratic Bezier curve is (a + 2 b + c) / 4.
        let middle = (Vec3::new(1., 2., 0.) * 2.0 + Vec3::new(3., 1., 1.)) / 4.0;
        assert!((bezier[PIECES / 2].at - middle).length() < 1e-6);
    }

    #[test]
    fn tubes_are_as_wide_as_their_curve_and_face_outwards() {
        let p = [0., 0., 0., 0., 0., 1., 0., 0., 2., 0., 0., 3.];
        let mesh = tessellate(&[curve(&p, 3, false)]);
        for (at, normal) in mesh.positions.iter().zip(mesh.normals.as_ref().unwrap()) {
            let width = 0.2 - 0.1 * at.z / 3.0;
            assert!((at.truncate().length() - 0.5 * width).abs() < 1e-6);
            assert!(normal.dot(at.with_z(0.0)) > 0.0);
        }
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let middle = (a + b + c).with_z(0.0);
            assert!((b - a).cross(c - a).dot(middle) > 0.0);
        }
    }
}
