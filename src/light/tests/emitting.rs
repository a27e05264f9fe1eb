//! Photons against the power that lights have, and against the irradiance that sampling finds.

use super::scenes::*;
use super::*;
use crate::image::decoded::DecodeLimit;
use std::f32::consts::PI;

fn numbers<const N: usize>(rng: &mut Pcg32) -> [f32; N] {
    [(); N].map(|()| rng.next_f32())
}

/// Mean power of photons, green, and its standard error.
fn mean_power(lights: &Lights, draws: u32) -> (f64, f64) {
    let mut rng = Pcg32::new(21, 2);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..draws {
        let power = lights
            .emit(numbers(&mut rng))
            .map_or(0.0, |e| f64::from(e.power.y));
        sum += power;
        squares += power * power;
    }
    let n = f64::from(draws);
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(0.0) / n).sqrt())
}

fn expect_power(name: &str, setup: &Setup, expected: f32) {
    let (mean, error) = mean_power(&setup.lights, 100_000);
    let expected = f64::from(expected);
    assert!(error < 0.003 * expected, "{name}: +- {error}");
    assert!(
        (mean - expected).abs() < 4.0 * error + 2e-4 * expected,
        "{name}: {mean} instead of {expected}"
    );
}

fn grey(v: f32) -> Texture {
    Texture::Constant(Rgb::splat(v))
}

#[test]
fn photons_carry_the_power_of_their_light() {
    let map = placed(Vec3::splat(0.5), Vec3::X);
    let one = |s: EmitterShape| setup(vec![(s, grey(3.0))], vec![]);
    let sphere = one(exact(AnalyticKind::Sphere, map, false));
    expect_power("sphere", &sphere, 3.0 * PI * PI);
    let disk = one(exact(AnalyticKind::Disk, map, false));
    expect_power("disk", &disk, 3.0 * PI * PI * 0.25);
    let cylinder = one(exact(AnalyticKind::Cylinder, map, true));
    expect_power("cylinder", &cylinder, 3.0 * PI * (2.0 * PI * 0.25));
    let quad = one(quad_mesh(Vec3::ZERO, Vec3::X, Vec3::Y * 2.0));
    expect_power("quad", &quad, 3.0 * PI * 2.0);
    // A prolate spheroid with half-axes 1, 1, 2: area 2 pi (1 + 2 / e asin e), e = sqrt(3) / 2.
    let long = one(exact(
        AnalyticKind::Sphere,
        placed(Vec3::new(1.0, 1.0, 2.0), Vec3::ZERO),
        false,
    ));
    let e = 0.75f32.sqrt();
    expect_power(
        "spheroid",
        &long,
        3.0 * PI * 2.0 * PI * (1.0 + 2.0 / e * e.asin()),
    );
}

/// An image of latitude by longitude that is brighter towards +x than towards -x, with a mean of 1.
fn lobe() -> EnvironmentImage {
    let file = tempfile::Builder::new().suffix(".exr").tempfile().unwrap();
    let (width, height) = (256, 129);
    let value = |x: usize, y: usize| {
        let phi = (x as f32 + 0.5) * (2.0 * PI / width as f32);
        let theta = y as f32 * (PI / (height - 1) as f32);
        let v = 1.0 + 0.8 * phi.sin() * theta.sin();
        (v, v, v)
    };
    exr::prelude::write_rgb_file(file.path(), width, height, value).unwrap();
    EnvironmentImage::read(file.path(), None, DecodeLimit::default()).unwrap()
}

/// Emitters without a surface, each with its power on the scene.
fn others() -> Vec<(&'static str, Emitter, f32)> {
    let radius2 = BOUNDS.radius().powi(2) * 1.0001 * 1.0001;
    let spot = |beam_degrees: f32, falloff| Emitter::Spot {
        to_world: placed(Vec3::ONE, Vec3::new(0.5, -1.0, 3.0)),
        intensity: Rgb::splat(7.0),
        cutoff_degrees: 40.0,
        beam_degrees,
        falloff,
        texture: None,
    };
    // Integral of 2 pi sin(t) over the beam, and of the same times (cutoff - t) / (cutoff - beam)
    // beyond it.
    let (c, b) = (40f32.to_radians(), 20f32.to_radians());
    let falling = ((c - b) * b.cos() + b.sin() - c.sin()) / (c - b);
    vec![
        (
            "point",
            Emitter::Point {
                position: Vec3::ONE,
                intensity: Rgb::splat(2.0),
            },
            8.0 * PI,
        ),
        (
            "sharp spot",
            spot(40.0, Falloff::Linear),
            14.0 * PI * (1.0 - c.cos()),
        ),
        (
            "spot",
            spot(20.0, Falloff::Linear),
            14.0 * PI * (1.0 - b.cos() + falling),
        ),
        // The mean of 3 t^2 - 2 t^3 is a half.
        (
            "smooth spot",
            spot(20.0, Falloff::Smooth),
            14.0 * PI * (1.0 - 0.5 * (b.cos() + c.cos())),
        ),
        // The same intensity within the solid angle of a slide of 2 by 1 at distance 1.
        (
            "projection",
            Emitter::Projector {
                to_world: placed(Vec3::ONE, Vec3::new(0.0, 0.0, -4.0)),
                slide: grey(0.5),
                values: Slide::Intensity,
                scale: 3.0,
                fov_degrees: 90.0,
                aspect: 2.0,
            },
            1.5 * 4.0 * (0.5f32 / (1.0f32 + 1.0 + 0.25).sqrt()).atan(),
        ),
        (
            "projector",
            Emitter::Projector {
                to_world: placed(Vec3::ONE, Vec3::new(0.0, 0.0, -4.0)),
                slide: grey(0.5),
                values: Slide::Irradiance,
                scale: 3.0,
                fov_degrees: 90.0,
                aspect: 2.0,
            },
            1.5 * PI * 2.0,
        ),
        (
            "goniometric",
            Emitter::Goniometric {
                to_world: placed(Vec3::ONE, Vec3::new(-2.0, 1.0, 3.0)),
                image: Arc::new(lobe()),
                intensity: Rgb::splat(2.0),
            },
            8.0 * PI,
        ),
        (
            "directional",
            Emitter::Directional {
                direction: Vec3::new(0.6, 0.0, -0.8),
                irradiance: Rgb::splat(5.0),
            },
            5.0 * PI * radius2,
        ),
        (
            "constant",
            Emitter::Constant {
                radiance: Rgb::splat(0.3),
            },
            1.2 * PI * PI * radius2,
        ),
    ]
}

#[test]
fn photons_of_lights_without_a_surface_carry_their_power() {
    let (mut all, mut total) = (Vec::new(), 0.0);
    for (name, emitter, power) in others() {
        expect_power(name, &setup(vec![], vec![emitter.clone()]), power);
        all.push(emitter);
        total += power;
    }
    expect_power("together", &setup(vec![], all), total);
}

/// Irradiance at a small disk by the photons that cross it, against sampling from it: positions,
/// directions and powers of photons together are the light that arrives.
fn compare_flux(name: &str, s: &Setup, p: Vec3, n: Vec3) {
    let (radius, draws) = (0.6f32, 300_000);
    let frame = crate::math::Frame::new(n);
    let mut rng = Pcg32::new(4, 4);
    let (mut sum, mut squares) = (0.0, 0.0);
    for _ in 0..draws {
        let Some(e) = s.lights.emit(numbers(&mut rng)) else {
            continue;
        };
        let cos = -e.dir.dot(n);
        let t = (e.org - p).dot(n) / cos;
        if cos > 0.0 && t > 0.0 && (e.org + e.dir * t - p).length() < radius {
            let power = f64::from(e.power.y);
            sum += power;
            squares += power * power;
        }
    }
    let area = f64::from(PI * radius * radius) * f64::from(draws);
    let (photons, error) = (sum / area, squares.sqrt() / area);
    let mut sum = 0.0;
    for _ in 0..draws {
        let [a, b, c, d, e] = numbers(&mut rng);
        let at = crate::math::warp::concentric_disk(Vec2::new(d, e)) * radius;
        let q = p + frame.to_world(at.extend(0.0));
        if let Some(l) = s.lights.sample(q, n, &mut (), [a, b, c]) {
            sum += f64::from(s.lights.radiance(&l.incoming).y * l.dir.dot(n).max(0.0) / l.pdf);
        }
    }
    let sampled = sum / f64::from(draws);
    assert!(error < 0.03 * sampled, "{name}: {photons} +- {error}");
    assert!(
        (photons - sampled).abs() < 4.0 * error + 0.003 * sampled,
        "{name}: photons {photons} +- {error}, sampling {sampled}"
    );
}

#[test]
fn photons_and_sampling_find_the_same_irradiance() {
    let p = Vec3::new(0.2, 0.1, 0.3);
    for (name, emitter, _) in others() {
        let n = match &emitter {
            Emitter::Spot { to_world, .. } | Emitter::Projector { to_world, .. } => {
                // On the axis, facing the light.
                let axis = to_world.transform_vector3(Vec3::Z);
                let at = Vec3::from(to_world.translation) + axis * 1.5;
                compare_flux(name, &setup(vec![], vec![emitter.clone()]), at, -axis);
                continue;
            }
            _ => Vec3::new(-0.3, 0.2, 0.9).normalize(),
        };
        compare_flux(name, &setup(vec![], vec![emitter]), p, n);
    }
    let shapes = vec![
        (
            quad_mesh(Vec3::new(-1.0, -1.0, 1.5), Vec3::Y, Vec3::X),
            grey(3.0),
        ),
        (
            exact(
                AnalyticKind::Sphere,
                placed(Vec3::splat(0.4), Vec3::new(1.0, 0.3, 1.6)),
                false,
            ),
            grey(2.0),
        ),
        (
            exact(
                AnalyticKind::Cylinder,
                placed(Vec3::new(0.5, 0.3, 1.0), Vec3::new(-1.0, 1.0, 1.6)),
                false,
            ),
            grey(2.0),
        ),
    ];
    compare_flux("shapes", &setup(shapes, vec![]), p, Vec3::Z);
}

/// Directions leave a surface by the cosine: the mean of the cosine is 2/3, of its square 1/2,
/// around the normal.
#[test]
fn surfaces_shine_by_the_cosine() {
    let s = setup(vec![(strewn(20, 0.4, 2), grey(1.0))], vec![]);
    let mut rng = Pcg32::new(8, 1);
    let (mut first, mut second) = (0.0, 0.0);
    for _ in 0..200_000 {
        let e = s.lights.emit(numbers(&mut rng)).unwrap();
        let cos = f64::from(e.dir.dot(e.ng));
        first += cos / 200_000.0;
        second += cos * cos / 200_000.0;
    }
    assert!((first - 2.0 / 3.0).abs() < 0.003 && (second - 0.5).abs() < 0.003);
}

/// Lights that are far from what photons are to land on.
fn far() -> Vec<(&'static str, Setup)> {
    let shape = |s: EmitterShape| setup(vec![(s, grey(200.0))], vec![]);
    let disk = placed(Vec3::splat(3.0), Vec3::new(5.0, 3.0, 20.0));
    let point = Emitter::Point {
        position: Vec3::new(9.0, -3.0, 30.0),
        intensity: Rgb::splat(3e4),
    };
    vec![
        (
            "far sphere",
            shape(exact(AnalyticKind::Sphere, disk, false)),
        ),
        ("far disk", shape(exact(AnalyticKind::Disk, disk, true))),
        (
            "far triangles",
            shape(quad_mesh(
                Vec3::new(0.0, 12.0, 20.0),
                Vec3::Y * 4.0,
                Vec3::X,
            )),
        ),
        ("far point", setup(vec![], vec![point])),
    ]
}

#[test]
fn photons_from_afar_are_the_light_that_arrives() {
    for (name, s) in far() {
        let n = Vec3::new(0.3, 0.1, 0.9).normalize();
        compare_flux(name, &s, Vec3::new(0.2, 0.1, 0.3), n);
    }
}

/// All that leave pass the ball that they are sent to. A far point sends what falls on it: I 2 pi
/// (1 - sqrt(1 - (r / d)^2)).
#[test]
fn photons_from_afar_arrive() {
    let radius = BOUNDS.radius() * 1.001;
    let mut rng = Pcg32::new(9, 3);
    for (name, s) in far() {
        for _ in 0..10_000 {
            let Some(e) = s.lights.emit(numbers(&mut rng)) else {
                continue;
            };
            let past = (-e.org).dot(e.dir);
            let aside = (e.org + e.dir * past).length();
            assert!(past > 0.0 && aside < radius, "{name}: {aside}");
        }
    }
    let distance2 = 9f32.powi(2) + 3f32.powi(2) + 30f32.powi(2);
    let sin2 = (BOUNDS.radius() * 1.0001).powi(2) / distance2;
    let (_, point) = far().pop().unwrap();
    let expected = 3e4 * 2.0 * PI * (1.0 - (1.0 - sin2).sqrt());
    expect_power("far point", &point, expected);
}

/// What is sent to the scene counts when lights are chosen, not what is sent into the void.
#[test]
fn a_far_light_is_chosen_by_what_it_sends_here() {
    let disk = |radius, at, flip| {
        let map = Affine3A::from_translation(at) * Affine3A::from_scale(Vec3::splat(radius));
        exact(AnalyticKind::Disk, map, flip)
    };
    let near = disk(1.0, Vec3::Z, false);
    let far = disk(3.0, Vec3::Z * 40.0, true);
    let s = setup(vec![(near, grey(1.0)), (far, grey(10.0))], vec![]);
    let mut rng = Pcg32::new(5, 7);
    let (mut of_far, draws) = (0.0, 100_000);
    for _ in 0..draws {
        let e = s.lights.emit(numbers(&mut rng)).unwrap();
        of_far += f64::from(e.emitter) / f64::from(draws);
    }
    // A ball of radius r at a distance d takes pi r^2 / d^2, and the disk faces it: 10 pi 3^2 of
    // that, beside pi pi.
    let angle = f64::from(BOUNDS.radius()).powi(2) / 1600.0;
    let expected = 90.0 * angle / (90.0 * angle + 1.0);
    assert!(
        (of_far / expected - 1.0).abs() < 0.03,
        "{of_far} instead of {expected}"
    );
}
