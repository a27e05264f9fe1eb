//! Lamps and cameras that stand inside of a body: what Beer's law leaves of their light.

use crate::support::{SceneMaker, cube, settings};
use crate::{ball, body, expect, medium};
use std::f64::consts::PI;
use twintree::accel::{AnalyticKind, Backend};
use twintree::integrate::PathSettings;
use twintree::light::Emitter;
use twintree::math::{Affine3A, Rgb, Vec3};
use twintree::medium::Boundary;
use twintree::photon::PhotonSettings;
use twintree::photon::wave::PhotonWave;

const EXTINCTION: f32 = 0.7;

/// A ball of radius 1 around the origin that absorbs.
fn absorbing_ball(maker: &mut SceneMaker) -> u32 {
    let inside = medium(maker, EXTINCTION, 0.0);
    ball(maker, 1.0, inside);
    inside
}

/// A lamp of intensity 1 in the middle, a floor of reflectance 0.5 at a distance of 3, seen where
/// light falls straight on it; and the power that photons bring into a black room around the ball.
#[test]
fn a_point_light_inside_of_a_body_is_dimmed_on_its_way_out() {
    let passed = f64::from(-EXTINCTION).exp();
    let lamp = Emitter::Point {
        position: Vec3::ZERO,
        intensity: Rgb::ONE,
    };
    // Beside the ball: the floor is met at an angle.
    let eye = Vec3::new(8.0, 0.0, -3.0);
    let mut maker = SceneMaker::new(eye, Vec3::new(0.0, 0.0, 3.0), 0.1, 8);
    absorbing_ball(&mut maker);
    maker.emitter(lamp.clone());
    let grey = maker.diffuse(0.5);
    let place = Affine3A::from_translation(Vec3::Z * 3.0)
        * Affine3A::from_rotation_x(std::f32::consts::PI)
        * Affine3A::from_scale(Vec3::splat(2.0));
    let floor = maker.exact(AnalyticKind::Rectangle, place);
    maker.shape(floor, grey, None, false);
    let direct = PathSettings {
        max_depth: 2,
        ..settings()
    };
    let built = maker.build(Backend::default());
    let (seen, _) = built.mean(&direct, 64);
    let truth = 0.5 / PI / 9.0 * passed;
    // Shadow rays end a little before the lamp, where the medium still is.
    assert!((seen / truth - 1.0).abs() < 1e-3, "{seen}, not {truth}");

    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 1.0, 8);
    absorbing_ball(&mut maker);
    maker.emitter(lamp);
    let black = maker.diffuse(0.0);
    maker.sphere(Vec3::ZERO, 2.0, black, None, true);
    let scene = maker.build(Backend::default()).scene;
    let photon = PhotonSettings {
        max_bounces: 1,
        roulette_after: 8,
        seed: 11,
    };
    const PHOTONS: u64 = 10_000;
    let mut power = 0.0;
    PhotonWave::default().trace(&scene, &photon, 0..PHOTONS, &mut |landing| {
        power += f64::from(landing.power.x) / PHOTONS as f64;
    });
    // All photons go through as much of it: nothing is left to chance.
    let truth = 4.0 * PI * passed;
    assert!((power / truth - 1.0).abs() < 1e-3, "{power}, not {truth}");
}

/// A glowing ball of radius 0.25 in the middle of an absorbing one, named by its own boundary or
/// not.
#[test]
fn a_lamp_with_an_extent_is_dimmed_by_the_body_that_it_stands_in() {
    for named in [false, true] {
        let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 0.1, 8);
        let inside = absorbing_ball(&mut maker);
        let black = maker.diffuse(0.0);
        maker.sphere(Vec3::ZERO, 0.25, black, Some(2.0), false);
        if named {
            let lamp = maker.description.shapes.last_mut().unwrap();
            lamp.boundary = Some(Boundary {
                interior: inside,
                exterior: inside,
            });
        }
        let seen = maker.build(Backend::default()).mean(&settings(), 64);
        let truth = 2.0 * f64::from(-0.75 * EXTINCTION).exp();
        expect(&format!("a lamp in a body, named: {named}"), truth, seen);
    }
}

/// A camera in the middle of a body under a sky of 1, whose scene does not say where it is; and
/// outside of it.
#[test]
fn a_camera_inside_of_a_body_looks_through_what_is_before_it() {
    for (z, depth) in [(0.0, 1.0f32), (0.5, 0.5), (-3.0, 2.0), (3.0, 0.0)] {
        let eye = Vec3::new(0.0, 0.0, z);
        let mut maker = SceneMaker::new(eye, eye + Vec3::Z, 0.1, 8);
        let inside = medium(&mut maker, EXTINCTION, 0.0);
        body(&mut maker, cube(1.0), inside);
        maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
        let seen = maker.build(Backend::default()).mean(&settings(), 64);
        let truth = f64::from(-EXTINCTION * depth).exp();
        expect(&format!("a camera at {z}"), truth, seen);
    }
}
