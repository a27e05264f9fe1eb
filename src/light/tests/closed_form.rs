//! Irradiance by sampling against what is known.

use super::scenes::*;
use super::*;
use std::f32::consts::PI;

/// Irradiance at `p` on a surface with normal `n`, red channel, and the standard error of the
/// estimate.
fn irradiance(lights: &Lights, p: Vec3, n: Vec3, draws: usize) -> (f64, f64) {
    let mut rng = Pcg32::new(11, 5);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..draws {
        let u = [(); 3].map(|()| rng.next_f32());
        let value = lights.sample(p, n, &mut (), u).map_or(0.0, |s| {
            f64::from(lights.radiance(&s.incoming).x * s.dir.dot(n).max(0.0) / s.pdf)
        });
        sum += value;
        squares += value * value;
    }
    let mean = sum / draws as f64;
    let variance = (squares / draws as f64 - mean * mean).max(0.0);
    (mean, (variance / draws as f64).sqrt())
}

fn expect(name: &str, lights: &Lights, p: Vec3, n: Vec3, expected: f32) {
    let (mean, error) = irradiance(lights, p, n, 200_000);
    let expected = f64::from(expected);
    assert!(
        error < 0.003 * expected,
        "{name}: {mean} is too uncertain, {error}"
    );
    assert!(
        (mean - expected).abs() < 4.0 * error + 1e-5 * expected,
        "{name}: {mean} +- {error} instead of {expected}"
    );
}

#[test]
fn a_sphere_is_a_point_of_its_projected_area() {
    let center = Vec3::new(0.3, 2.0, -0.1);
    for radius in [1e-3, 0.5, 1.7] {
        let map = placed(Vec3::splat(radius), center);
        let s = setup(
            vec![(exact(AnalyticKind::Sphere, map, false), constant(3.0))],
            vec![],
        );
        // E = pi L (r/d)^2 for a sphere wholly above the horizon, facing it.
        let d = center.length();
        let expected = 3.0 * PI * (radius / d).powi(2);
        expect("sphere", &s.lights, Vec3::ZERO, center / d, expected);
    }
}

#[test]
fn a_disk_above_its_centre() {
    for (radius, height) in [(1.0, 0.5), (0.5, 2.0), (1.0, 20.0)] {
        let map = Affine3A::from_scale_rotation_translation(
            Vec3::splat(radius),
            glam::Quat::from_rotation_x(PI),
            Vec3::Z * height,
        );
        let s = setup(
            vec![(exact(AnalyticKind::Disk, map, false), constant(1.0))],
            vec![],
        );
        let expected = PI * radius * radius / (radius * radius + height * height);
        expect("disk", &s.lights, Vec3::ZERO, Vec3::Z, expected);
    }
}

/// Irradiance from a polygon by Lambert's formula.
fn polygon(p: Vec3, n: Vec3, corners: &[Vec3], radiance: f32) -> f32 {
    let dirs: Vec<Vec3> = corners.iter().map(|&c| (c - p).normalize()).collect();
    let sum: f32 = (0..dirs.len())
        .map(|i| {
            let (a, b) = (dirs[i], dirs[(i + 1) % dirs.len()]);
            a.dot(b).acos() * a.cross(b).normalize().dot(n)
        })
        .sum();
    0.5 * radiance * sum.abs()
}

#[test]
fn polygons_by_lamberts_formula() {
    let (corner, a, b) = (Vec3::new(-0.4, 0.2, 1.0), Vec3::Y * 0.7, Vec3::X * 1.1);
    for p in [
        Vec3::ZERO,
        Vec3::new(0.1, 0.4, 0.9),
        Vec3::new(0.0, 0.1, -5.0),
    ] {
        let n = Vec3::new(0.1, 0.05, 1.0).normalize();
        let corners = [corner, corner + a, corner + a + b, corner + b];
        let s = setup(vec![(quad_mesh(corner, a, b), constant(2.0))], vec![]);
        let expected = polygon(p, n, &corners, 2.0);
        expect("quad", &s.lights, p, n, expected);
        let half = mesh(&corners[..3], &[[0, 1, 2]]);
        let s = setup(vec![(half, constant(2.0))], vec![]);
        if p.z < 0.5 {
            expect(
                "triangle",
                &s.lights,
                p,
                n,
                polygon(p, n, &corners[..3], 2.0),
            );
        }
    }
}

#[test]
fn points_environments_and_parallel_light() {
    let point = Emitter::Point {
        position: Vec3::new(0.0, 3.0, 4.0),
        intensity: Rgb::splat(50.0),
    };
    let s = setup(vec![], vec![point.clone()]);
    expect("point", &s.lights, Vec3::ZERO, Vec3::Z, 50.0 / 25.0 * 0.8);
    let grey = Emitter::Constant {
        radiance: Rgb::splat(0.7),
    };
    let s = setup(vec![], vec![grey.clone()]);
    expect("constant", &s.lights, Vec3::ZERO, Vec3::Z, 0.7 * PI);
    let parallel = Emitter::Directional {
        direction: Vec3::new(0.6, 0.0, -0.8),
        irradiance: Rgb::splat(5.0),
    };
    let s = setup(vec![], vec![parallel.clone()]);
    expect("directional", &s.lights, Vec3::ZERO, Vec3::Z, 4.0);
    let s = setup(vec![], vec![point, grey, parallel]);
    expect(
        "together",
        &s.lights,
        Vec3::ZERO,
        Vec3::Z,
        1.6 + 0.7 * PI + 4.0,
    );
}

#[test]
fn nothing_comes_from_what_cannot_shine() {
    let flat = mesh(&[Vec3::ZERO, Vec3::X, Vec3::X * 2.0], &[[0, 1, 2]]);
    let nan = Texture::Constant(Rgb::new(f32::NAN, -1.0, f32::INFINITY));
    let quad = || quad_mesh(Vec3::ZERO, Vec3::X, Vec3::Y);
    let none = Affine3A::from_scale(Vec3::new(1.0, 0.0, 0.0));
    let s = setup(
        vec![
            (flat, constant(1.0)),
            (quad(), constant(0.0)),
            (quad(), nan),
            (exact(AnalyticKind::Disk, none, false), constant(1.0)),
            (
                exact(
                    AnalyticKind::Sphere,
                    Affine3A::from_scale(Vec3::splat(1e-30)),
                    false,
                ),
                constant(1.0),
            ),
        ],
        vec![
            Emitter::Point {
                position: Vec3::ONE,
                intensity: Rgb::ZERO,
            },
            Emitter::Constant {
                radiance: Rgb::splat(f32::NAN),
            },
        ],
    );
    let mut rng = Pcg32::new(1, 1);
    for _ in 0..1000 {
        let u = [(); 5].map(|()| rng.next_f32());
        assert!(
            s.lights
                .sample(
                    Vec3::new(0.3, 0.4, 2.0),
                    Vec3::ZERO,
                    &mut (),
                    [u[0], u[1], u[2]]
                )
                .is_none()
        );
        assert!(s.lights.emit(u).is_none());
    }
    assert!(!s.lights.has_environment() && s.lights.len() == 7);
}

#[test]
fn extreme_radiances_scale_and_extreme_random_numbers_hold() {
    let top = 1.0 - f32::EPSILON * 0.5;
    let p = Vec3::new(0.2, 0.1, 3.0);
    let lights = |scale: f32| {
        let quad = quad_mesh(Vec3::ZERO, Vec3::X, Vec3::Y);
        let ball = exact(
            AnalyticKind::Sphere,
            placed(Vec3::splat(0.3), Vec3::X * 2.0),
            false,
        );
        setup(
            vec![
                (quad, Texture::Constant(Rgb::splat(scale))),
                (ball, Texture::Constant(Rgb::splat(scale))),
            ],
            vec![],
        )
    };
    let base = lights(1.0);
    for scale in [1e-30, 1e-10, 1e10, 1e30f32] {
        let s = lights(scale);
        for u0 in [0.0, 0.3, 0.9, top] {
            for u1 in [0.0, 0.5, top] {
                for u2 in [0.0, 0.5, top] {
                    let a = base
                        .lights
                        .sample(p, Vec3::NEG_Z, &mut (), [u0, u1, u2])
                        .unwrap();
                    let b = s
                        .lights
                        .sample(p, Vec3::NEG_Z, &mut (), [u0, u1, u2])
                        .unwrap();
                    assert!(a.dir.is_finite() && (a.dir.length() - 1.0).abs() < 1e-5);
                    assert!((a.pdf / b.pdf - 1.0).abs() < 1e-5, "{a:?} {b:?}");
                    let a_radiance = base.lights.radiance(&a.incoming).x;
                    let b_radiance = s.lights.radiance(&b.incoming).x;
                    assert!((b_radiance / scale / a_radiance - 1.0).abs() < 1e-5);
                }
            }
        }
    }
}
