//! Participating media: closed forms, what the field learns of them, and agreement with Mitsuba 3.

mod field;
mod inside;
mod mitsuba;
mod places;
#[path = "../support/mod.rs"]
mod support;

use support::{Built, SceneMaker, cube, settings};
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::material::Null;
use twintree::integrate::PathSettings;
use twintree::light::Emitter;
use twintree::math::{Affine3A, Rgb, Vec3};
use twintree::medium::{Boundary, Homogeneous, Medium, PhaseFunction, VACUUM};
use twintree::scene::Geometry;

/// Adds a medium that scatters to all sides alike.
fn medium(maker: &mut SceneMaker, extinction: f32, albedo: f32) -> u32 {
    maker.description.media.list.push(Medium {
        name: "medium".into(),
        extinction: Homogeneous {
            extinction: Rgb::splat(extinction),
            albedo: Rgb::splat(albedo),
        }
        .into(),
        phase: PhaseFunction::isotropic(),
    });
    maker.description.media.list.len() as u32 - 1
}

/// Adds an index-matched body of a medium.
fn body(maker: &mut SceneMaker, geometry: Geometry, interior: u32) {
    let null = maker.material(Null);
    maker.shape(geometry, null, None, false);
    let shape = maker.description.shapes.last_mut().unwrap();
    shape.boundary = Some(Boundary {
        interior,
        exterior: VACUUM,
    });
}

fn ball(maker: &mut SceneMaker, radius: f32, interior: u32) {
    let place = Affine3A::from_scale(Vec3::splat(radius));
    let sphere = maker.exact(AnalyticKind::Sphere, place);
    body(maker, sphere, interior);
}

/// A ball of radius 1 that absorbs nothing, under a sky of 1.
fn furnace(extinction: f32) -> Built {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 25.0, 8);
    let inside = medium(&mut maker, extinction, 1.0);
    ball(&mut maker, 1.0, inside);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    maker.build(Backend::default())
}

/// The mean must be `truth` within 4 standard errors, which must be small enough to see 1 %.
fn expect(what: &str, truth: f64, (mean, error): (f64, f64)) {
    println!("{what}: {mean:.6} +- {error:.6}, truth {truth:.6}");
    assert!(error < 0.0025 * truth, "{what}: too noisy to tell: {error}");
    let allowed = 4.0 * error + 1e-4 * truth;
    assert!(
        (mean - truth).abs() < allowed,
        "{what}: {mean} +- {error}, not {truth}"
    );
}

/// A sky of 1 seen straight through a slab of thickness 2, by a narrow field of view.
#[test]
fn a_slab_lets_through_what_beers_law_says() {
    for (depth, albedo) in [(1e-4f32, 0.0f32), (0.5, 0.0), (3.0, 0.0), (0.5, 0.7)] {
        let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -9.0), Vec3::ZERO, 0.1, 8);
        let inside = medium(&mut maker, 0.5 * depth, albedo);
        body(&mut maker, cube(1.0), inside);
        maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
        // Emission alone: nothing that was scattered.
        let settings = PathSettings {
            max_depth: 1,
            ..settings()
        };
        let built = maker.build(Backend::default());
        let truth = f64::from(-depth).exp();
        expect(
            &format!("depth {depth}"),
            truth,
            built.mean(&settings, 4096),
        );
    }
}

/// Nothing is absorbed: under an even sky a ball that only scatters cannot be seen.
#[test]
fn a_ball_that_only_scatters_vanishes_in_a_furnace() {
    for extinction in [0.3, 3.0, 30.0] {
        let mean = furnace(extinction).mean(&settings(), 1024);
        expect(&format!("furnace {extinction}"), 1.0, mean);
    }
}

/// Where a lamp is beside a ray from the camera, and extinction and albedo of the medium without
/// end around both.
const LAMP: Vec3 = Vec3::new(0.0, 1.0, 3.0);
const FOG: (f32, f32) = (0.4, 0.6);

/// What a lamp of intensity 1 brings by one scattering: the integral of sigma_s / (4 pi r^2)
/// exp(-sigma (t + r)) over t up to an end, with r^2 = d^2 + (t - t0)^2.
fn scattered_once(end: f64) -> f64 {
    let (sigma, albedo) = (f64::from(FOG.0), f64::from(FOG.1));
    let (t0, d) = (f64::from(LAMP.z), f64::from(LAMP.y));
    let step = 1e-4;
    let along = |i: u32| {
        let t = (f64::from(i) + 0.5) * step;
        let square = d * d + (t - t0) * (t - t0);
        sigma * albedo / (4.0 * std::f64::consts::PI * square)
            * (-sigma * (t + square.sqrt())).exp()
    };
    (0..(end / step) as u32).map(along).sum::<f64>() * step
}

fn in_endless_fog() -> SceneMaker {
    let mut maker = SceneMaker::new(Vec3::ZERO, Vec3::Z, 0.05, 8);
    maker.description.camera_medium = Some(medium(&mut maker, FOG.0, FOG.1));
    maker
}

fn point_lamp(maker: &mut SceneMaker) {
    maker.emitter(Emitter::Point {
        position: LAMP,
        intensity: Rgb::ONE,
    });
}

/// Expects light that was scattered once.
fn expect_once(what: &str, truth: f64, maker: SceneMaker) {
    let settings = PathSettings {
        max_depth: 2,
        ..settings()
    };
    let built = maker.build(Backend::default());
    expect(what, truth, built.mean(&settings, 1 << 13));
}

#[test]
fn a_point_light_in_endless_fog_shows_what_is_scattered_once() {
    let mut maker = in_endless_fog();
    point_lamp(&mut maker);
    expect_once("point light", scattered_once(60.0), maker);
}

/// A small sphere that glows: directions that meet it, light samples at collisions and distances
/// that it draws share what it brings. Its extent changes r^-2 by less than (radius / d)^2, and what
/// is seen of it is nearer than its centre by 2/3 of the radius on average.
#[test]
fn a_small_lamp_in_endless_fog_shows_the_same_as_a_point() {
    let radius = 0.02f32;
    let mut maker = in_endless_fog();
    let black = maker.diffuse(0.0);
    let radiance = 1.0 / (std::f32::consts::PI * radius * radius);
    maker.sphere(LAMP, radius, black, Some(radiance), false);
    let nearer = f64::from(FOG.0 * radius) * 2.0 / 3.0;
    expect_once("small lamp", scattered_once(60.0) * nearer.exp(), maker);
}

/// The distances that a lamp draws end where the ray does.
#[test]
fn behind_a_wall_a_lamp_draws_no_distances() {
    let mut maker = in_endless_fog();
    let black = maker.diffuse(0.0);
    maker.sphere(Vec3::new(0.0, 0.0, 8.6), 5.0, black, None, false);
    point_lamp(&mut maker);
    expect_once("until a wall", scattered_once(3.6), maker);
}

/// A slab of optical depth 8 that absorbs nothing, on black ground under a sky of 1, seen from
/// straight above: what is missing came through. Far from its faces light diffuses, and the share is
/// K(1) 4/3 / (depth + 2 q) with q = 0.71045 (Hopf's constant) and the escape function K(1) =
/// sqrt(3)/4 H(1), H(1) = 2.90781 (Chandrasekhar's function for isotropic scattering).
#[test]
fn light_diffuses_through_a_deep_slab() {
    let depth = 8.0f32;
    let eye = Vec3::new(0.0, 0.0, -40.0);
    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 0.1, 16);
    let inside = medium(&mut maker, 1.0, 1.0);
    let wide = Affine3A::from_scale(Vec3::new(400.0, 400.0, 1.0));
    // Rectangles face +z: the near one is turned.
    for (z, turn) in [(0.0, std::f32::consts::PI), (depth, 0.0)] {
        let turned = Affine3A::from_rotation_y(turn) * wide;
        let place = Affine3A::from_translation(Vec3::new(0.0, 0.0, z)) * turned;
        let face = maker.exact(AnalyticKind::Rectangle, place);
        body(&mut maker, face, inside);
    }
    let black = maker.diffuse(0.0);
    let place = Affine3A::from_translation(Vec3::new(0.0, 0.0, depth + 0.01)) * wide;
    let ground = maker.exact(AnalyticKind::Rectangle, place);
    maker.shape(ground, black, None, false);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    let escape = 3f64.sqrt() / 4.0 * 2.907_81;
    let truth = escape * (4.0 / 3.0) / (f64::from(depth) + 2.0 * 0.710_45);
    let (mean, error) = maker.build(Backend::default()).mean(&settings(), 6144);
    expect("through a deep slab", truth, (1.0 - mean, error));
}

/// Optical depths and sizes from the smallest to the largest: every image is finite, and a ball
/// that absorbs nothing still vanishes.
#[test]
fn extremes_neither_hang_nor_lose_light() {
    for scale in [1e-4f32, 1.0, 1e4] {
        for depth in [1e-8f32, 1e-3, 1e3, 1e6] {
            let eye = Vec3::new(0.0, 0.0, -3.0) * scale;
            let mut maker = SceneMaker::new(eye, Vec3::ZERO, 25.0, 8);
            maker.description.camera.near_clip = 1e-3 * f64::from(scale);
            // What is deep inside comes out late: most of it is absorbed there.
            let albedo = if depth > 1.0 { 0.99 } else { 1.0 };
            let inside = medium(&mut maker, depth / scale, albedo);
            ball(&mut maker, scale, inside);
            maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
            let (mean, error) = maker.build(Backend::default()).mean(&settings(), 64);
            assert!(
                mean.is_finite() && mean > 0.2 && mean < 1.0 + 4.0 * error + 1e-5,
                "{mean}"
            );
            if albedo == 1.0 {
                assert!(
                    (mean - 1.0).abs() < 4.0 * error + 1e-4,
                    "{scale} {depth}: {mean}"
                );
            }
        }
    }
}
