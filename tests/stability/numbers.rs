//! S12, S13, S15: weights, sums and directions.

use crate::table::Table;
use twintree::film::{Pixel, Sample};
use twintree::guide::{Photon, Settings, Trainer};
use twintree::math::equal_area::{DirectionCell, sphere_to_square, square_to_sphere, unit};
use twintree::math::mis::power_heuristic;
use twintree::math::sum::SumUnit;
use twintree::math::warp::uniform_sphere;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};

#[test]
fn s12_power_heuristic() {
    let mut table = Table::default();
    let mut rng = Pcg32::new(1, 2);
    let (mut outside, mut sum): (u32, f64) = (0, 0.0);
    for _ in 0..1_000_000 {
        let any = |rng: &mut Pcg32| 10f32.powf(rng.next_f32() * 78.0 - 40.0);
        let (a, b) = (any(&mut rng), any(&mut rng));
        let (wa, wb) = (power_heuristic(a, b), power_heuristic(b, a));
        outside += u32::from(!(0.0..=1.0).contains(&wa));
        sum = sum.max((f64::from(wa) + f64::from(wb) - 1.0).abs());
    }
    table.hold(
        "S12",
        "densities 1e-40 to 1e38: weights outside [0, 1]",
        "math",
        0.0,
        outside.into(),
    );
    table.hold(
        "S12",
        "densities 1e-40 to 1e38: |sum of weights - 1|",
        "math",
        2e-7,
        sum,
    );
}

/// A pixel's sum of samples whose sizes span 16 decades, against the same in double-double.
fn pixel_error(count: u32) -> f64 {
    let mut rng = Pcg32::new(9, 9);
    let mut pixel = Pixel::default();
    let (mut high, mut low) = (0.0f64, 0.0f64);
    for index in 0..count {
        let x = 10f32.powf(rng.next_f32() * 16.0 - 8.0);
        pixel.add(
            u64::from(index),
            &Sample {
                radiance: Rgb::splat(x),
                weight: 1.0,
                ..Sample::default()
            },
        );
        // Knuth's sum of two numbers, exact.
        let x = f64::from(x);
        let sum = high + x;
        let back = sum - high;
        low += (high - (sum - back)) + (x - back);
        high = sum;
    }
    (pixel.radiance[0] / (high + low) - 1.0).abs()
}

#[test]
fn s13_film_sums() {
    let mut table = Table::default();
    let what = "3e6 samples of 1e-8 to 1e8: error of a pixel's sum, relative";
    // A sum of n terms in f64 is off by n times 2^-53 at most.
    table.hold("S13", what, "film", 3.4e-10, pixel_error(3_000_000));
}

#[test]
#[ignore = "slow: a thousand million samples"]
fn s13_film_sums_of_a_billion() {
    let mut table = Table::default();
    let what = "1e9 samples of 1e-8 to 1e8: error of a pixel's sum, relative";
    table.hold("S13", what, "film", 1.2e-7, pixel_error(1_000_000_000));
}

/// Sums of the field are integers: exact, and the same in any order.
#[test]
fn s13_field_sums() {
    let mut table = Table::default();
    let unit = SumUnit::near(1.0);
    let mut rng = Pcg32::new(9, 8);
    let (mut quanta, mut exact) = (0u128, 0u128);
    for _ in 0..1_000_000 {
        let x = 10f32.powf(rng.next_f32() * 16.0 - 8.0);
        quanta += unit.quanta(x);
        // 2^60 x is a whole number for every f32 from 1e-8 on.
        exact += (f64::from(x) * 2f64.powi(60)) as u128;
    }
    // A thousand times a million: a billion terms.
    let (sum, truth) = (
        unit.to_f64(quanta * 1000),
        (exact * 1000) as f64 * 2f64.powi(-60),
    );
    let what = "1e9 photons of 1e-8 to 1e8: error of a link's sum, relative";
    table.hold("S13", what, "field", 1e-15, (sum / truth - 1.0).abs());

    let bytes = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let mut rng = Pcg32::new(2, 2);
            let photons: Vec<Photon> = (0..200_000)
                .map(|_| Photon {
                    position: Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()),
                    direction: uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())),
                    power: Rgb::splat(10f32.powf(rng.next_f32() * 8.0 - 4.0)),
                    distance: 1.0,
                    normal: Vec3::Z,
                })
                .collect();
            let mut trainer =
                Trainer::build(Settings::new(Vec3::ZERO, Vec3::ONE)).expect("settings");
            trainer.train(&photons, 200_000);
            trainer.refine_rounds(3);
            trainer.to_bytes()
        })
    };
    let one = bytes(1);
    let differ = [2, 7].iter().filter(|&&t| bytes(t) != one).count();
    table.hold(
        "S13",
        "fields by 2 and 7 threads that differ from one thread's",
        "field",
        0.0,
        differ as f64,
    );
}

#[test]
fn s15_direction_map() {
    let mut table = Table::default();
    let mut worst: f64 = 0.0;
    let mut check = |w: Vec3| {
        let back = square_to_sphere(sphere_to_square(w)).as_dvec3();
        // The chord is the angle where it is small, and does not cancel.
        worst = worst.max((back - w.as_dvec3().normalize()).length());
    };
    let mut rng = Pcg32::new(3, 1);
    for _ in 0..1_000_000 {
        check(uniform_sphere(Vec2::new(rng.next_f32(), rng.next_f32())));
    }
    for scale in [1e-38f32, 1e-20, 1.0, 1e20, 1e38] {
        for s in [1.0f32, -1.0] {
            for t in [0.0f32, -0.0, 1e-7, -1e-7, 1e-3] {
                for v in [Vec3::new(s, t, -t), Vec3::new(t, s, t), Vec3::new(-t, t, s)] {
                    check(unit(v * scale).expect("a direction"));
                }
            }
        }
    }
    table.hold(
        "S15",
        "direction to square and back: angle",
        "math",
        1e-6,
        worst,
    );
    for level in [1u8, 5, 10] {
        let cells = 1u64 << (2 * level);
        let start = |i: u64| (i << (32 - 2 * u32::from(level))) as u32;
        let sum: f64 = (0..cells)
            .map(|i| f64::from(DirectionCell::containing(start(i), level).solid_angle()))
            .sum();
        // The angle of a cell is the f32 next to 4 pi over a power of four.
        let error = (sum / f64::from(4.0 * std::f32::consts::PI) - 1.0).abs();
        table.hold(
            "S15",
            &format!("areas of cells of level {level}: sum, relative"),
            "math",
            1e-9,
            error,
        );
    }
}
