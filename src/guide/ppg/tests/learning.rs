//! What records teach.

use super::{floor, mean_over_sphere, taught, unit_box};
use crate::guide::Cells;
use crate::guide::ppg::{PpgTrainer, SdTree, Settings, Target};
use crate::math::{Rgb, Vec3};

const LAMP: Vec3 = Vec3::new(0.6, 0.0, 0.8);

/// A bright lamp of 9 degrees in a dim sky.
fn lamp(_: Vec3, w: Vec3) -> Rgb {
    Rgb::splat(if w.dot(LAMP) > 0.988 { 100.0 } else { 0.1 })
}

fn iterations(sky: impl Fn(Vec3, Vec3) -> Rgb + Copy) -> Vec<Vec<crate::guide::PathSample>> {
    let of = |k: u64| floor(20_000 << k, k, sky);
    (0..5).map(of).collect()
}

#[test]
fn a_lamp_is_found_and_the_irradiance_is_right() {
    for target in [Target::Radiance, Target::SecondMoment] {
        let settings = Settings {
            target,
            ..unit_box()
        };
        let tree = taught(settings, &iterations(lamp)).freeze();
        let local = tree.at(Vec3::new(0.4, 0.3, 0.25), Vec3::Z, None).unwrap();
        // Of uniform directions above one in 83 meets the lamp.
        assert!(local.pdf(LAMP) > 5.0, "{target:?} {}", local.pdf(LAMP));
        assert!(local.pdf(-LAMP) < 0.01, "{target:?} {}", local.pdf(-LAMP));
        let flux = mean_over_sphere(1024, |w| lamp(w, w).x * w.z.max(0.0));
        let truth = flux * 4.0 * std::f64::consts::PI;
        let found = f64::from(local.irradiance().x);
        // A leaf has thousands of records; the estimate of one has a relative spread of 8.
        assert!((found / truth - 1.0).abs() < 0.3, "{found} {truth}");
    }
}

/// From one half of the sky comes 1 always, from the other 10 at one time in ten: the same mean,
/// but the square is ten times as large.
#[test]
fn the_second_moment_takes_more_samples_where_light_is_seldom() {
    let sky = |x: Vec3, w: Vec3| {
        let seldom = (x.x * 7919.0).fract() < 0.1;
        let even = w.x > 0.0;
        Rgb::splat(if even {
            1.0
        } else {
            f32::from(u8::from(seldom)) * 10.0
        })
    };
    let share = |target| {
        let settings = Settings {
            target,
            ..unit_box()
        };
        let tree = taught(settings, &iterations(sky)).freeze();
        let local = tree.at(Vec3::new(0.4, 0.3, 0.25), Vec3::Z, None).unwrap();
        let half = |side: f32| {
            mean_over_sphere(512, |w| {
                local.pdf(w) * f32::from(u8::from(side * w.x > 0.0))
            })
        };
        half(-1.0) / half(1.0)
    };
    let (mean, square) = (share(Target::Radiance), share(Target::SecondMoment));
    assert!((mean - 1.0).abs() < 0.2, "{mean}");
    assert!((square / 10f64.sqrt() - 1.0).abs() < 0.2, "{square}");
}

#[test]
fn space_is_divided_where_records_are_and_cells_become_parts_of_cells() {
    let mut trainer = PpgTrainer::new(unit_box()).unwrap();
    let mut before = trainer.freeze();
    for (i, samples) in iterations(lamp).iter().enumerate() {
        trainer.train(&[samples]);
        let tree = trainer.freeze();
        let parts = tree.parts_of(&before);
        assert_eq!(parts.len(), tree.cell_count() as usize);
        for x in [
            Vec3::splat(0.1),
            Vec3::new(0.9, 0.2, 0.25),
            Vec3::splat(7.0),
        ] {
            for n in [Vec3::Z, Vec3::NEG_X] {
                let part = parts[tree.cell(x, n) as usize];
                assert_eq!(part, before.cell(x, n), "{i} {x} {n}");
            }
        }
        trainer.refine();
        before = tree;
    }
    // Eight octants of normals, seven of which have met nothing.
    assert!(before.cell_count() > 40, "{}", before.cell_count());
}

/// Records cut into parts of any size, on any number of threads.
#[test]
fn the_same_records_give_the_same_bits() {
    let iterations = iterations(|x, w| Rgb::new(1.0 + x.x, w.z * w.z, 10f32.powf(4.0 * w.x)));
    let learn = |threads: usize, part: usize| -> SdTree {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let settings = Settings {
            spatial_filter: true,
            ..unit_box()
        };
        pool.unwrap().install(|| {
            let mut trainer = PpgTrainer::new(settings).unwrap();
            for samples in &iterations {
                let parts: Vec<_> = samples.chunks(part).collect();
                trainer.train(&parts);
                trainer.refine();
            }
            trainer.train(&[&iterations[0]]);
            trainer.freeze()
        })
    };
    let one = learn(1, usize::MAX);
    for (threads, part) in [(2, 1 << 13), (7, 100_000), (7, 999)] {
        assert_eq!(
            one,
            learn(threads, part),
            "{threads} threads, parts of {part}"
        );
    }
}

#[test]
fn trees_keep_within_the_memory() {
    let sky = |x: Vec3, w: Vec3| Rgb::splat(((x.x * 40.0).sin() * 30.0 * w.x).exp());
    for memory in [20_000, 200_000, 2 << 20] {
        let settings = Settings {
            memory,
            threshold: 10.0,
            share: 1e-4,
            ..unit_box()
        };
        let mut trainer = taught(settings, &iterations(sky));
        trainer.refine();
        assert!(trainer.bytes() <= memory, "{} {memory}", trainer.bytes());
        assert!(trainer.bytes() > memory / 8, "{} {memory}", trainer.bytes());
    }
}

#[test]
fn the_unit_of_light_does_not_matter() {
    let tree = |scale: f32| {
        let scaled = move |x, w| lamp(x, w) * scale;
        taught(unit_box(), &iterations(scaled)[..3]).freeze()
    };
    let density = |tree: &SdTree| {
        let local = tree.at(Vec3::splat(0.25), Vec3::Z, None).unwrap();
        (local.pdf(LAMP), local.pdf(Vec3::Z))
    };
    let one = density(&tree(1.0));
    for exponent in [-90, -30, 30, 90] {
        assert_eq!(density(&tree(2f32.powi(exponent))), one, "2^{exponent}");
    }
}
