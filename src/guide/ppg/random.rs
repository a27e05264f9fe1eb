//! Trees full of garbage: a renderer that is right draws the same mean with any of them.

use super::{PpgTrainer, Settings};
use crate::guide::PathSample;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

impl PpgTrainer {
    /// A trainer over the box `min`..`max` that knows nothing of any scene: small cells, energies
    /// over six decades, directions without light.
    pub fn random(min: Vec3, max: Vec3, seed: u64) -> Self {
        let finite = |v: Vec3| if v.is_finite() { v } else { Vec3::ZERO };
        let (min, max) = (finite(min), finite(max));
        let settings = |min, max| Settings {
            threshold: 1000.0,
            directional_filter: false,
            ..Settings::new(min, max)
        };
        // Only bounds are refused.
        let Ok(mut trainer) = Self::new(settings(min.min(max), min.max(max))) else {
            return Self::random(Vec3::ZERO, Vec3::ONE, seed);
        };
        let mut rng = Pcg32::new(seed, 0x0070_7067);
        for _ in 0..4 {
            trainer.refine();
            trainer.train(&[samples(&mut rng, min, max)]);
        }
        trainer
    }
}

fn samples(rng: &mut Pcg32, min: Vec3, max: Vec3) -> Vec<PathSample> {
    let mut u = || rng.next_f32();
    (0..20_000)
        .map(|_| PathSample {
            position: min + (max - min) * Vec3::new(u(), u(), u()),
            direction: uniform_sphere(Vec2::new(u() * u(), u() * u())),
            radiance: Rgb::new(u(), u() * u(), u()) * 10f32.powf(u() * 6.0 - 3.0),
            pdf: 0.1 + u(),
            distance: 1.0,
            normal: uniform_sphere(Vec2::new(u(), u())),
        })
        .collect()
}
