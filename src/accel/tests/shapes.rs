//! Exact shapes by themselves.

use super::worlds::*;
use crate::accel::*;
use crate::math::{Affine3A, Pcg32, Vec3};

const KINDS: [AnalyticKind; 4] = [
    AnalyticKind::Sphere,
    AnalyticKind::Disk,
    AnalyticKind::Cylinder,
    AnalyticKind::Rectangle,
];

/// The point of the unit shape with coordinates `(u, v)`.
fn surface(kind: AnalyticKind, u: f32, v: f32) -> Vec3 {
    let ring = |u: f32| {
        let (sin, cos) = (std::f32::consts::TAU * u).sin_cos();
        Vec3::new(cos, sin, 0.0)
    };
    match kind {
        AnalyticKind::Sphere => {
            let (sin, cos) = (std::f32::consts::PI * v).sin_cos();
            ring(u) * sin + Vec3::Z * cos
        }
        AnalyticKind::Disk => ring(v) * u,
        AnalyticKind::Cylinder => ring(u) + Vec3::Z * v,
        AnalyticKind::Rectangle => Vec3::new(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0),
    }
}

/// Whether a ray in direction `dir` touches rather than crosses at the unit shape's point `p`:
/// there the rounding of the target to `f32` decides whether it is met.
fn grazing(shape: &AnalyticShape, p: Vec3, dir: Vec3) -> bool {
    let normal = match shape.kind {
        AnalyticKind::Sphere => p,
        AnalyticKind::Cylinder => p.with_z(0.0),
        AnalyticKind::Disk | AnalyticKind::Rectangle => Vec3::Z,
    };
    let d = shape.to_object.transform_vector3(dir).normalize();
    normal.dot(d).abs() < 0.01
}

/// Rays aimed at known points find them, and report the coordinates they were made from.
#[test]
fn rays_find_the_points_they_are_aimed_at() {
    let mut rng = Pcg32::new(5, 5);
    for round in 0..40_000 {
        let kind = KINDS[round % 4];
        let shape = AnalyticShape::new(kind, random_map(&mut rng, 3.0));
        let (u, v) = (0.01 + 0.98 * rng.next_f32(), 0.01 + 0.98 * rng.next_f32());
        let target = shape.to_world.transform_point3(surface(kind, u, v));
        let dir = direction(&mut rng);
        if grazing(&shape, surface(kind, u, v), dir) {
            continue;
        }
        let (t, u1, v1) = shape
            .intersect(target - dir * 0.5, dir, 0.0, 10.0)
            .unwrap_or_else(|| panic!("{kind:?} {u} {v} was missed"));
        if (t - 0.5).abs() > 1e-3 {
            // Another part of the shape stood before the target.
            assert!(t < 0.5 && matches!(kind, AnalyticKind::Sphere | AnalyticKind::Cylinder));
            continue;
        }
        let p = shape.to_world.transform_point3(surface(kind, u1, v1));
        assert!((p - target).length() < 2e-3, "{kind:?}: {p} {target}");
    }
}

/// A sphere far from the origin and a ray from far away: the hit lies on the sphere.
#[test]
fn distance_costs_no_digits() {
    let mut rng = Pcg32::new(6, 6);
    for round in 0..20_000 {
        let kind = [AnalyticKind::Sphere, AnalyticKind::Cylinder][round % 2];
        let shape = AnalyticShape::new(kind, Affine3A::IDENTITY);
        let away = 10f32.powf(6.0 * rng.next_f32());
        let target = surface(kind, rng.next_f32(), rng.next_f32()) * 0.5;
        let dir = direction(&mut rng);
        let org = target - dir * away;
        let Some((t, ..)) = shape.intersect(org, dir, 0.0, f32::INFINITY) else {
            continue;
        };
        let p = org.as_dvec3() + dir.as_dvec3() * f64::from(t);
        let r = match kind {
            AnalyticKind::Sphere => p.length(),
            _ => p.truncate().length(),
        };
        // t itself is rounded to f32; nothing else may be lost.
        let bound = 1e-6 + f64::from(away) * 1.2e-7;
        assert!((r - 1.0).abs() <= bound, "{kind:?} from {away}: {r}");
    }
}

#[test]
fn bounds_hold_the_shape_and_touch_it() {
    let mut rng = Pcg32::new(7, 7);
    for round in 0..40 {
        let kind = KINDS[round % 4];
        let shape = AnalyticShape::new(kind, random_map(&mut rng, 3.0));
        let b = shape.bounds();
        let mut reached = Bounds::EMPTY;
        for i in 0..=100 {
            for j in 0..=100 {
                let p = surface(kind, i as f32 / 100.0, j as f32 / 100.0);
                reached = reached.with(shape.to_world.transform_point3(p));
            }
        }
        let size = (b.max - b.min).max_element();
        assert!(
            (reached.min - b.min).min_element() >= -1e-6 * size,
            "{kind:?}"
        );
        assert!(
            (b.max - reached.max).min_element() >= -1e-6 * size,
            "{kind:?}"
        );
        let slack = (b.max - b.min) - (reached.max - reached.min);
        assert!(slack.max_element() < 3e-3 * size, "{kind:?} {slack}");
    }
}

#[test]
fn flat_shapes_may_be_scaled_to_nothing_along_their_normal() {
    let flat = Affine3A::from_scale(Vec3::new(2.0, 3.0, 0.0));
    let shape = AnalyticShape::new(AnalyticKind::Rectangle, flat);
    let hit = shape.intersect(Vec3::new(1.0, 1.5, 4.0), -Vec3::Z, 0.0, 10.0);
    let (t, u, v) = hit.unwrap();
    assert!((t - 4.0).abs() < 1e-6 && (u - 0.75).abs() < 1e-6 && (v - 0.75).abs() < 1e-6);
}

#[test]
fn degenerate_shapes_and_rays_are_misses() {
    let odd = [0.0, f32::NAN, f32::INFINITY, 1e38, -1e38];
    for kind in KINDS {
        for a in odd {
            let sound = AnalyticShape::new(kind, Affine3A::IDENTITY);
            let ill = AnalyticShape::new(kind, Affine3A::from_scale(Vec3::new(a, a, a)));
            for b in odd {
                let (v, w) = (Vec3::new(a, b, 0.0), Vec3::new(0.0, b, a));
                for shape in [&sound, &ill] {
                    let hit = shape.intersect(v, w, 0.0, f32::INFINITY);
                    assert!(hit.is_none_or(|h| h.0 >= 0.0 && !h.1.is_nan() && !h.2.is_nan()));
                }
                assert!(ill.intersect(Vec3::NAN, w, 0.0, 1.0).is_none());
            }
        }
    }
}

/// Most rays take the short way, batches with masks and the other ray tracer the long one.
#[test]
fn flat_shapes_are_met_to_the_same_bits_both_ways() {
    let mut rng = Pcg32::new(2, 9);
    let mut number = |scale: f32| scale * (2.0 * rng.next_f32() - 1.0);
    let mut met = 0;
    for round in 0..40_000 {
        let mut vector = |scale| Vec3::new(number(scale), number(scale), number(scale));
        let (x, y, z, place) = (vector(2.0), vector(2.0), vector(2.0), vector(10.0));
        let kind = [AnalyticKind::Disk, AnalyticKind::Rectangle][round % 2];
        let map = Affine3A::from_mat3_translation(crate::math::Mat3::from_cols(x, y, z), place);
        let shape = AnalyticShape::new(kind, map);
        let org = vector(20.0);
        let dir = place + x * vector(1.0).x + y * vector(1.0).y - org;
        let (tmin, tmax) = (0.1 * vector(1.0).x, 1.0 + 0.2 * vector(1.0).x);
        let long = shape.crossings(org, dir, tmin, tmax).next();
        let short = shape.intersect(org, dir, tmin, tmax);
        assert_eq!(short, long.map(|c| (c.t, c.u, c.v)));
        met += u32::from(short.is_some());
    }
    assert!((10_000..30_000).contains(&met), "{met}");
}
