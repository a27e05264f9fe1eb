//! Tests of the SD-tree.

mod hostile;
mod learning;
mod sampling;

use super::{PpgTrainer, Settings};
use crate::guide::PathSample;
use crate::guide::tests::synthetic::square;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

/// The mean of a function over points spread evenly over the sphere.
fn mean_over_sphere(side: u32, f: impl Fn(Vec3) -> f32) -> f64 {
    let at = |k: u32| Vec2::new((k % side) as f32 + 0.5, (k / side) as f32 + 0.5) / side as f32;
    let directions = (0..side * side).map(|k| crate::math::equal_area::square_to_sphere(at(k)));
    directions.map(|w| f64::from(f(w))).sum::<f64>() / f64::from(side * side)
}

/// Records of uniform directions above a floor, z up, under a sky.
fn floor(count: usize, seed: u64, sky: impl Fn(Vec3, Vec3) -> Rgb) -> Vec<PathSample> {
    let mut rng = Pcg32::new(seed, 77);
    (0..count)
        .map(|_| {
            let place = square(&mut rng);
            let position = Vec3::new(place.x, place.y, 0.25);
            let mut direction = uniform_sphere(square(&mut rng));
            direction.z = direction.z.abs();
            PathSample {
                position,
                direction,
                radiance: sky(position, direction),
                pdf: 0.5 * std::f32::consts::FRAC_1_PI,
                distance: 1.0,
                normal: Vec3::Z,
            }
        })
        .collect()
}

/// A trainer over the unit box that iterations of records have taught.
fn taught(settings: Settings, iterations: &[Vec<PathSample>]) -> PpgTrainer {
    let mut trainer = PpgTrainer::new(settings).unwrap();
    for samples in iterations {
        trainer.refine();
        trainer.train(&[samples]);
    }
    trainer
}

fn unit_box() -> Settings {
    Settings::new(Vec3::ZERO, Vec3::ONE)
}
