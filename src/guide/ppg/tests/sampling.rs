//! Samples against their density.

use super::{mean_over_sphere, square};
use crate::guide::ppg::{LocalTree, PpgTrainer};
use crate::guide::tests::synthetic::chi_square_z;
use crate::math::equal_area::direction_code;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Vec2, Vec3};
use std::f64::consts::PI;

/// Samples of one tree against its density.
fn deviation(local: &LocalTree, samples: u32, rng: &mut Pcg32) -> f64 {
    let mut counts = [0u32; 64];
    for _ in 0..samples {
        let s = local.sample(rng.next_f32(), square(rng));
        assert!(s.pdf > 0.0 && s.pdf.is_finite());
        assert!((s.direction.length() - 1.0).abs() < 1e-5);
        let again = local.pdf(s.direction);
        // On the horizon rounding decides.
        assert!(
            again == s.pdf || again == 0.0,
            "{again} {} {}",
            s.pdf,
            s.direction
        );
        counts[(direction_code(s.direction) >> 26) as usize] += 1;
    }
    chi_square_z(&counts, 256, |w| local.pdf(w))
}

#[test]
fn samples_match_their_density_with_a_horizon_and_without() {
    let tree = PpgTrainer::random(Vec3::ZERO, Vec3::ONE, 4).freeze();
    let mut rng = Pcg32::new(31, 7);
    let mut worst = f64::MIN;
    for i in 0..12 {
        let normal = uniform_sphere(square(&mut rng));
        let x = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let horizon = (i % 3 != 0).then_some(normal);
        let local = tree.at(x, normal, horizon).unwrap();
        worst = worst.max(deviation(&local, 400_000, &mut rng));
    }
    // One-sided 1 % over twelve points: z = 3.14; a density that is 1 % off fails.
    assert!(worst < 3.2, "{worst}");
}

#[test]
fn densities_integrate_to_one() {
    let tree = PpgTrainer::random(Vec3::ZERO, Vec3::ONE, 8).freeze();
    let mut rng = Pcg32::new(3, 7);
    for i in 0..20 {
        let normal = uniform_sphere(square(&mut rng));
        let x = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let horizon = (i % 2 != 0).then_some(normal);
        let local = tree.at(x, normal, horizon).unwrap();
        let integral = 4.0 * PI * mean_over_sphere(2048, |w| local.pdf(w));
        // Cells that the points do not resolve hold next to nothing; the horizon's jagged edge.
        assert!((integral - 1.0).abs() < 3e-3, "{i}: {integral}");
    }
}

#[test]
fn nothing_is_drawn_below_the_horizon() {
    let tree = PpgTrainer::random(Vec3::ZERO, Vec3::ONE, 5).freeze();
    let mut rng = Pcg32::new(9, 9);
    for _ in 0..20_000 {
        let normal = uniform_sphere(square(&mut rng));
        let local = tree.at(Vec3::splat(0.5), normal, Some(normal)).unwrap();
        let s = local.sample(rng.next_f32(), square(&mut rng));
        assert!(s.direction.dot(normal) > -1e-6 && s.pdf > 0.0);
        let w = uniform_sphere(square(&mut rng));
        assert_eq!(local.pdf(w) > 0.0, w.dot(normal) >= 0.0);
    }
}

#[test]
fn edge_numbers_draw_sound_directions() {
    let tree = PpgTrainer::random(Vec3::ZERO, Vec3::ONE, 6).freeze();
    let top = 1.0 - 1.0 / 16_777_216.0;
    for (select, x, y) in [
        (0.0, 0.0, 0.0),
        (0.5, 0.0, top),
        (top, top, top),
        (0.009_999, top, 0.0),
    ] {
        for normal in [Vec3::X, Vec3::NEG_Y, Vec3::Z] {
            for horizon in [None, Some(normal)] {
                let local = tree.at(Vec3::splat(0.3), normal, horizon).unwrap();
                let s = local.sample(select, Vec2::new(x, y));
                assert!(s.pdf > 0.0 && s.pdf.is_finite() && s.direction.is_finite());
            }
        }
    }
}
