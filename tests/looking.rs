//! Looking at fields: brute force against closed forms, the learned distribution against brute
//! force, and where the camera looks at all.

mod support;

use std::sync::atomic::{AtomicU32, Ordering};
use support::{Built, SceneMaker, inside_of_cube, mesh, overlap, settings};
use twintree::accel::{AnalyticKind, Backend};
use twintree::guide::{Field, ModelKind, SurfacePoint, Trainer};
use twintree::integrate::PathSettings;
use twintree::integrate::debug::cells;
use twintree::integrate::debug::probe::{LatLong, Place, brute_force, learned, sight};
use twintree::integrate::guiding::Guide;
use twintree::integrate::training::extend::{More, extend, to_file};
use twintree::integrate::training::importance::look;
use twintree::integrate::training::{LearnSettings, Learned, learn, learn_until};
use twintree::light::Emitter;
use twintree::math::{Affine3A, Rgb, Vec2, Vec3};
use twintree::photon::PhotonSettings;
use twintree::photon::schedule::Budget;

const PI: f32 = std::f32::consts::PI;

/// A grey floor, seen from above, under a constant sky.
fn floor(radiance: f32) -> Built {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 40.0, 8);
    let grey_wall = maker.diffuse(0.5);
    let corners = [(-9.0, -9.0), (9.0, -9.0), (9.0, 9.0), (-9.0, 9.0)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, 0.0)).to_vec();
    let square = mesh(corners, vec![[0, 1, 2], [0, 2, 3]]);
    maker.shape(square, grey_wall, None, false);
    maker.emitter(Emitter::Constant {
        radiance: Rgb::splat(radiance),
    });
    maker.build(Backend::default())
}

fn probed(built: &Built, path: &PathSettings, rows: u32, spp: u32) -> LatLong {
    let place = seen(built, Vec2::new(4.5, 4.5));
    brute_force(&built.scene, path, &place, rows, spp)
}

/// The place on the first surface that a pixel sees.
fn seen(built: &Built, pixel: Vec2) -> Place<'_> {
    let sight = sight(&built.scene, &built.camera, pixel);
    sight.surface.expect("there is a surface").1
}

#[test]
fn brute_force_finds_pi_under_a_sky_of_one() {
    let built = floor(1.0);
    let mut path = settings();
    let view = probed(&built, &path, 32, 64);
    // The integral of the cosine over the upper hemisphere; below the horizon nothing.
    let sum = view.integral();
    assert!(
        (sum - Rgb::splat(PI)).abs().max_element() < 0.005 * PI,
        "{sum}"
    );
    let (upper, lower) = view.pixels.split_at(view.pixels.len() / 2);
    assert!(upper.iter().all(|p| p.x > 0.0) && lower.iter().all(|p| *p == Rgb::ZERO));
    // The first row looks along the normal, the last above the horizon nearly along it.
    assert!((view.pixels[0].x - 1.0).abs() < 0.01);
    // A sky that is hidden as emitters are leaves what the floor itself sends up: nothing.
    path.hide_emitters = true;
    assert_eq!(probed(&built, &path, 8, 4).integral(), Rgb::ZERO);
}

/// Two closed rooms, each with its lamp; the camera stands in the left one.
fn two_rooms() -> Built {
    let mut maker = SceneMaker::new(
        Vec3::new(-2.0, 0.0, -0.9),
        Vec3::new(-2.0, -0.2, 1.0),
        70.0,
        32,
    );
    let wall = maker.diffuse(0.6);
    let black = maker.diffuse(0.0);
    let mut corners = Vec::new();
    let mut triangles = Vec::new();
    for x in [-2.0, 2.0] {
        let twintree::scene::Geometry::Mesh(cube) = inside_of_cube(1.0) else {
            panic!("a cube is a mesh");
        };
        let first = corners.len() as u32;
        let moved = cube.triangles.positions().iter();
        corners.extend(moved.map(|p| *p + Vec3::new(x, 0.0, 0.0)));
        let all = cube.triangles.triangles().iter();
        triangles.extend(all.map(|t| t.map(|i| i + first)));
        let up = Affine3A::from_translation(Vec3::new(x, 0.3, 0.2))
            * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
            * Affine3A::from_scale(Vec3::splat(0.25));
        let lamp = maker.exact(AnalyticKind::Rectangle, up);
        maker.shape(lamp, black, Some(8.0), false);
    }
    maker.shape(mesh(corners, triangles), wall, None, false);
    maker.build(Backend::default())
}

/// So many photons and paths, in so many batches.
fn how((photons, batches): (u64, u32), (paths, batches_of_paths): (u64, u32)) -> LearnSettings {
    LearnSettings {
        photons: Budget::Exactly { photons, batches },
        paths,
        batches: batches_of_paths,
        memory: 32 << 20,
        mixture: None,
        trial: false,
        photon: PhotonSettings {
            max_bounces: 8,
            roulette_after: 3,
            seed: 5,
        },
        model: ModelKind::Constant,
    }
}

fn taught(built: &Built, photons: u64, paths: u64, model: ModelKind) -> Learned {
    let settings = LearnSettings {
        trial: true,
        model,
        ..how((photons, 6), (paths, 6))
    };
    let path = PathSettings {
        max_depth: 10,
        ..support::settings()
    };
    learn(&built.view(&path, None), &settings).expect("the field is learned")
}

#[test]
fn the_learned_distribution_is_a_density_and_close_to_brute_force() {
    let built = two_rooms();
    let path = PathSettings {
        hide_emitters: true,
        ..settings()
    };
    let place = seen(&built, Vec2::new(16.5, 24.5));
    let truth = brute_force(&built.scene, &path, &place, 16, 256);
    for model in ModelKind::ALL {
        let taught = taught(&built, 600_000, 300_000, *model);
        let view = learned(&taught.guide, &place, 64);
        let whole = view.integral();
        assert!((whole - Rgb::ONE).abs().max_element() < 0.02, "{whole}");
        let view = learned(&taught.guide, &place, 16);
        let unknowing = Field::random(Vec3::splat(-3.0), Vec3::splat(3.0), *model, 1);
        let unknowing = learned(&Guide::new(unknowing), &place, 16);
        let (good, bad) = (overlap(&truth, &view), overlap(&truth, &unknowing));
        println!("{model:?}: overlap {good} learned, {bad} random");
        assert!(good > 0.75 && bad < 0.6, "{model:?}: {good}, {bad}");
        // What it expects to arrive, over the whole cell, is about what arrives at this point of
        // it.
        let expected = place.ask(&taught.guide).irradiance().x;
        let arrives = truth.integral().x;
        println!("irradiance {expected} learned, {arrives} traced");
        assert!(
            (expected / arrives - 1.0).abs() < 0.3,
            "{expected}, {arrives}"
        );
    }
}

#[test]
fn the_camera_meets_its_own_room_and_the_other_one_is_not_refined() {
    let built = two_rooms();
    let path = settings();
    let photons = Budget::Exactly {
        photons: 400_000,
        batches: 1,
    };
    let met = look(&built.view(&path, None), photons).points;
    assert!(met.len() > 10_000, "{}", met.len());
    assert!(met.iter().all(|p| p.position.x < -0.99));
    // Every wall is met, on its inner side.
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        for side in [axis, -axis] {
            let on = |p: &&SurfacePoint| p.normal.dot(side) > 0.99;
            assert!(met.iter().filter(on).count() > 300, "{side}");
        }
    }
    let taught = taught(&built, 400_000, 0, ModelKind::Constant);
    let cells_in = |x: f32| {
        let field = &taught.guide.field;
        let mut cells: Vec<u32> = (0..400)
            .map(|i| {
                let at = Vec2::new((i % 20) as f32, (i / 20) as f32) / 10.0 - 0.95;
                field.cell(Vec3::new(x + at.x, -1.0, at.y), Vec3::Y)
            })
            .collect();
        cells.sort_unstable();
        cells.dedup();
        cells.len()
    };
    let (seen, unseen) = (cells_in(-2.0), cells_in(2.0));
    println!("{seen} cells on the floor of the room that is seen, {unseen} on the other");
    assert!(seen > 4 * unseen, "{seen} and {unseen}");
    // The picture of the cells shows the ones of this room.
    let (pixels, count) = cells::seen(&built.view(&path, None), &taught.guide.field);
    assert!(count > 20 && pixels.iter().all(|p| p.max_element() > 0.0));
}

#[test]
fn what_learning_hands_over_is_what_guides() {
    let built = two_rooms();
    let taught = taught(&built, 50_000, 20_000, ModelKind::Constant);
    let trainer = Trainer::from_bytes(&taught.trainer.to_bytes()).unwrap();
    let frozen = trainer.freeze();
    let x = Vec3::new(-2.3, -1.0, 0.4);
    for i in 0..100 {
        let u = Vec2::new(i as f32 / 100.0, 0.37);
        let draw = |f: &Field| f.at(x, Some(Vec3::Y), Rgb::ONE).sample(u, u);
        assert_eq!(draw(&frozen), draw(&taught.guide.field));
    }
}

/// Says stop once it was asked `times` times.
fn stopping_after(times: u32) -> impl Fn() -> bool + Sync {
    let asked = AtomicU32::new(0);
    move || asked.fetch_add(1, Ordering::Relaxed) >= times
}

#[test]
fn learning_that_is_stopped_has_learned_from_the_first_records() {
    let built = two_rooms();
    let path = settings();
    let view = built.view(&path, None);
    // Batches double, from 1000 records on: five of them begin with the three that 7000 come in.
    // Up to 4096 paths and 8192 photons are traced at one go, which is where it asks.
    for (asked, stopped, whole) in [
        (3, how((31_000, 5), (0, 5)), how((7000, 3), (0, 3))),
        (
            7,
            how((15_000, 4), (31_000, 5)),
            how((15_000, 4), (7000, 3)),
        ),
        (0, how((31_000, 5), (0, 5)), how((0, 1), (0, 1))),
    ] {
        let stop = stopping_after(asked);
        let stopped = learn_until(&view, &stopped, &stop).expect("a field");
        let whole = learn(&view, &whole).expect("a field");
        let records = |l: &Learned| (l.counts.emitted, l.paths);
        assert_eq!(records(&stopped), records(&whole));
        assert!(asked == 0 || stopped.trainer.to_bytes() == whole.trainer.to_bytes());
    }
}

#[test]
fn learning_further_that_is_stopped_goes_on_where_it_was() {
    let built = two_rooms();
    let path = settings();
    let view = built.view(&path, None);
    let few = how((7000, 3), (0, 3));
    let base = to_file(&view, &few, learn(&view, &few).expect("a field"), 1);
    let further = |base, photons, share, asked| {
        let more = More {
            photons,
            paths: 0,
            share,
        };
        let stop = stopping_after(asked);
        extend(&view, &few, base, &more, &stop).expect("a field").0
    };
    let stopped = further(&base, 300_000, None, 33);
    let taken = stopped.sample_ranges.photons.count() - 7000;
    assert!(taken > 0 && taken < 300_000, "{taken}");
    assert!(stopped.to_bytes() == further(&base, taken, None, u32::MAX).to_bytes());
    assert_eq!(stopped.sample_ranges.missing(), None);
    let rest = further(&stopped, 300_000 - taken, None, u32::MAX);
    assert!(rest.to_bytes() == further(&base, 300_000, None, u32::MAX).to_bytes());
    // A share that was stopped lacks what the others count on.
    let share = further(&base, 600_000, Some((0, 2)), 33);
    assert_eq!(share.sample_ranges.photons.count(), taken);
    assert_eq!(share.sample_ranges.photons.next(), 607_000);
}
