//! What photons and the field know of media.

use crate::support::{Built, SceneMaker, agree, how, inside_of_cube, settings};
use crate::{furnace, medium};
use std::f64::consts::PI;
use twintree::accel::{AnalyticKind, Backend};
use twintree::integrate::training::{garbage, learn};
use twintree::integrate::{GuidedSettings, PathSettings, Roulette};
use twintree::math::{Affine3A, Rgb, Vec3};
use twintree::photon::PhotonSettings;
use twintree::photon::wave::PhotonWave;

/// Photons of a sky of 1, in a ball of radius 1 that absorbs nothing: the fluence is 4 pi
/// everywhere, so the power that collides is 4 pi times the cross-section, sigma_t times the
/// volume.
#[test]
fn photons_collide_as_often_as_fluence_and_extinction_say() {
    for extinction in [0.2f32, 2.0, 12.0] {
        let scene = furnace(extinction).scene;
        let cross_section = f64::from(extinction) * 4.0 / 3.0 * PI;
        let (points, measured) = scene.medium_points(1 << 18, 3);
        let error = (measured / cross_section - 1.0).abs();
        assert!(error < 0.005, "{measured}, not {cross_section}");
        assert!(points.iter().all(|p| p.length() < 1.0001));

        // In the dense ball roulette would make more noise than the test allows.
        let photon = PhotonSettings {
            max_bounces: 4096,
            roulette_after: if extinction > 4.0 { 4096 } else { 8 },
            seed: 11,
        };
        const PHOTONS: u64 = 400_000;
        let (mut landed, mut cubes) = (0.0, 0.0);
        PhotonWave::default().trace(&scene, &photon, 0..PHOTONS, &mut |landing| {
            assert_eq!(landing.normal, Vec3::ZERO, "there is no surface to land on");
            let power = f64::from(landing.power.x);
            landed += power;
            cubes += power * f64::from(landing.position.length()).powi(3);
        });
        let fluence = landed / PHOTONS as f64 / cross_section;
        let error = fluence / (4.0 * PI) - 1.0;
        println!("extinction {extinction}: fluence {fluence:.4}, {error:+.4} off");
        assert!(error.abs() < 0.008, "{fluence}, not 4 pi");
        // As much in the middle as further out: r^3 is even in a ball.
        assert!((cubes / landed - 0.5).abs() < 0.004, "{}", cubes / landed);
    }
}

/// A foggy room with a lamp under its ceiling that shines upwards: all light is indirect.
pub fn foggy_room() -> Built {
    let eye = Vec3::new(0.0, 0.0, -0.95);
    let mut maker = SceneMaker::new(eye, Vec3::Z, 70.0, 16);
    maker.description.camera_medium = Some(medium(&mut maker, 0.6, 0.9));
    let wall = maker.diffuse(0.6);
    maker.shape(inside_of_cube(1.0), wall, None, false);
    let lamp = Affine3A::from_translation(Vec3::new(0.4, 0.7, 0.4))
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(0.15));
    let lamp = maker.exact(AnalyticKind::Rectangle, lamp);
    let black = maker.diffuse(0.0);
    maker.shape(lamp, black, Some(30.0), false);
    maker.build(Backend::default())
}

/// The mean is the same whatever the field says of a medium, and a field that has learned what
/// there is says something.
#[test]
fn guided_and_unguided_fog_have_the_same_mean() {
    let room = foggy_room();
    let guided = PathSettings {
        max_depth: 12,
        guided: GuidedSettings {
            roulette: Roulette::Field,
            ..GuidedSettings::PLAIN
        },
        ..settings()
    };
    let plain = PathSettings {
        max_depth: 12,
        ..settings()
    };
    let (reference, _) = room.render(&plain, 4096);
    let how = how(200_000, 60_000);
    let learned = learn(&room.view(&guided, None), &how).unwrap();
    assert!(learned.trainer.settings().media);
    let other = PathSettings { seed: 9, ..guided };
    let (by_field, _) = room.render_guided(&other, 1024, Some(&learned.guide));
    agree("fog, learned", &reference, &by_field);
    let garbage = garbage(&room.scene, how.model, 4);
    let (by_garbage, _) = room.render_guided(&other, 1024, Some(&garbage));
    agree("fog, garbage", &reference, &by_garbage);

    // Most light in the fog under the lamp comes from the bright ceiling above.
    let at = Vec3::new(0.4, 0.3, 0.4);
    let local = learned.guide.field.at_side(at, Vec3::ZERO, None, Rgb::ONE);
    let (up, down) = (local.pdf(Vec3::Y), local.pdf(-Vec3::Y));
    assert!(up > 2.0 * down, "{up} from above, {down} from below");
}
