//! The light at one place, on a surface among media or inside of one: brute force against closed
//! forms, and the field beside brute force.

use crate::field::foggy_room;
use crate::support::{SceneMaker, cube, how, mesh, overlap, settings};
use crate::{body, furnace, medium};
use std::f32::consts::PI;
use twintree::accel::Backend;
use twintree::guide::{Field, ModelKind};
use twintree::integrate::PathSettings;
use twintree::integrate::debug::probe::{brute_force, learned, sight};
use twintree::integrate::guiding::Guide;
use twintree::integrate::training::learn;
use twintree::light::Emitter;
use twintree::math::{Rgb, Vec2, Vec3};

/// In a ball that absorbs nothing, under a sky of 1, the radiance is 1 from everywhere.
#[test]
fn inside_of_a_furnace_light_comes_evenly_from_all_sides() {
    let built = furnace(2.0);
    let sight = sight(&built.scene, &built.camera, Vec2::splat(4.0));
    // Through the ball's surface, which is index-matched: from 2 to 4, and the sky behind it.
    assert!(sight.surface.is_none());
    let [ball] = sight.media[..] else {
        panic!("{:?}", sight.media)
    };
    assert!((ball.from - 2.0).abs() < 1e-4 && (ball.to - 4.0).abs() < 1e-4);
    assert!(sight.in_medium(1.9).is_none() && sight.in_medium(4.1).is_none());
    let place = sight.in_medium(2.7).expect("it is in the ball");
    assert_eq!(place.medium(), Some(ball.medium));
    let light = brute_force(&built.scene, &settings(), &place, 8, 64);
    // Without absorption and roulette no path has another radiance.
    let fluence = light.integral().x / (4.0 * PI);
    assert!((fluence - 1.0).abs() < 0.005, "{fluence}");
    let dark = light.pixels.iter().filter(|p| (p.x - 1.0).abs() > 0.2);
    assert_eq!(dark.count(), 0);
}

/// A floor in a slab that absorbs, under a sky of 1: the irradiance is 2 pi times the third
/// exponential integral of the depth, the integral of mu exp(-depth / mu) over mu from 0 to 1.
#[test]
fn a_floor_under_a_slab_is_seen_and_lit_through_it() {
    let depth = 0.5f64;
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 300.0), Vec3::ZERO, 5.0, 8);
    // One unit of the slab lies above the floor.
    let inside = medium(&mut maker, depth as f32, 0.0);
    body(&mut maker, cube(100.0), inside);
    let (grey, far) = (maker.diffuse(0.5), 90.0);
    let corners = [(-far, -far), (far, -far), (far, far), (-far, far)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 99.0)).to_vec();
    maker.shape(mesh(corners, vec![[0, 1, 2], [0, 2, 3]]), grey, None, false);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    let built = maker.build(Backend::default());
    let sight = sight(&built.scene, &built.camera, Vec2::splat(4.0));
    let (_, place) = sight.surface.expect("the floor");
    assert!((place.point.p.z - 99.0).abs() < 1e-3 && place.medium().is_none());
    assert_eq!(sight.media.len(), 1);
    let found = brute_force(&built.scene, &settings(), &place, 64, 16)
        .integral()
        .x;
    let steps = 100_000;
    let middle = |i: i32| (f64::from(i) + 0.5) / f64::from(steps);
    let sum: f64 = (0..steps)
        .map(|i| middle(i) * (-depth / middle(i)).exp())
        .sum();
    let truth = (2.0 * f64::from(PI) * sum / f64::from(steps)) as f32;
    println!("{found} traced, {truth} by the integral");
    assert!((found / truth - 1.0).abs() < 0.005, "{found}, not {truth}");
}

#[test]
fn what_a_field_knows_of_a_place_in_fog_is_close_to_brute_force() {
    let room = foggy_room();
    let path = PathSettings {
        max_depth: 12,
        hide_emitters: true,
        ..settings()
    };
    let sight = sight(&room.scene, &room.camera, Vec2::splat(8.5));
    let place = sight.in_medium(1.2).expect("the room is full of fog");
    let truth = brute_force(&room.scene, &path, &place, 8, 256);
    let taught = learn(&room.view(&path, None), &how(400_000, 120_000)).unwrap();
    let whole = learned(&taught.guide, &place, 64).integral();
    assert!((whole - Rgb::ONE).abs().max_element() < 0.02, "{whole}");
    let view = learned(&taught.guide, &place, 8);
    let unknowing = Field::random(Vec3::splat(-1.0), Vec3::ONE, ModelKind::Gauss, 1);
    let unknowing = learned(&Guide::new(unknowing), &place, 8);
    let (good, bad) = (overlap(&truth, &view), overlap(&truth, &unknowing));
    println!("overlap {good} learned, {bad} random");
    assert!(good > 0.75 && bad < 0.65, "{good}, {bad}");
    let expected = place.ask(&taught.guide).irradiance().x;
    let arrives = truth.integral().x;
    println!("fluence {expected} learned, {arrives} traced");
    assert!(
        (expected / arrives - 1.0).abs() < 0.3,
        "{expected}, {arrives}"
    );
}
