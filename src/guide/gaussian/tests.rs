//! The disk, which only [`crate::guide::ModelKind::Gauss`] uses; the square is tested with cached
//! mixtures.

use super::{Domain, LOBES, Lobe, Mixture};
use crate::math::{Pcg32, Vec2};

/// Lobes narrow and wide, also across the rim.
fn lobes(rng: &mut Pcg32) -> [Lobe; LOBES] {
    std::array::from_fn(|_| {
        let (sx, sy) = (0.02 + 0.3 * rng.next_f32(), 0.02 + 0.3 * rng.next_f32());
        Lobe {
            weight: rng.next_f32(),
            mean: Domain::Disk.uniform(Vec2::new(rng.next_f32(), rng.next_f32())),
            covariance: [sx * sx, 0.8 * (rng.next_f32() - 0.5) * sx * sy, sy * sy],
        }
    })
}

#[test]
fn densities_over_the_disk_integrate_to_one_and_samples_follow_them() {
    let mut rng = Pcg32::new(5, 6);
    for round in 0..4 {
        let mixture = Mixture::new(&lobes(&mut rng), 0.05, Domain::Disk);
        // Quadrants of the disk, by midpoints and by samples.
        let quadrant = |p: Vec2| usize::from(p.x > 0.45) + 2 * usize::from(p.y > 0.6);
        let mut mass = [0f64; 4];
        let n = 1000;
        for k in 0..n * n {
            let p = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
            if Domain::Disk.contains(p) {
                mass[quadrant(p)] += f64::from(mixture.density(p)) / f64::from(n * n);
            }
        }
        let total: f64 = mass.iter().sum();
        assert!((total - 1.0).abs() < 1e-3, "{round}: {total}");
        let mut counts = [0u32; 4];
        let samples = 1_000_000;
        for _ in 0..samples {
            let p = mixture.sample_by_two(Vec2::new(rng.next_f32(), rng.next_f32()));
            assert!(Domain::Disk.contains(p));
            counts[quadrant(p)] += 1;
        }
        for (c, m) in counts.iter().zip(mass) {
            let expected = m / total * f64::from(samples);
            let z = (f64::from(*c) - expected) / (expected * (1.0 - m)).sqrt();
            assert!(z.abs() < 4.0, "{round}: {counts:?} {mass:?}");
        }
    }
}

#[test]
fn the_mass_inside_is_exact_also_for_thin_lobes_across_the_rim() {
    let mut rng = Pcg32::new(7, 8);
    for round in 0..300 {
        let (sx, sy) = (
            0.004 * 100f32.powf(rng.next_f32()),
            0.004 * 100f32.powf(rng.next_f32()),
        );
        let lobe = Lobe {
            weight: 1.0,
            mean: Domain::Disk.uniform(Vec2::new(rng.next_f32(), rng.next_f32())),
            covariance: [sx * sx, 1.98 * (rng.next_f32() - 0.5) * sx * sy, sy * sy],
        };
        let [a, b, d] = lobe.inverse_cholesky().unwrap_or_default();
        // Points of a golden spiral, spread as the Gaussian.
        let n = 100_000;
        let mut inside = 0u32;
        for i in 0..n {
            let r = (-2.0 * ((f64::from(i) + 0.5) / f64::from(n)).ln()).sqrt() as f32;
            let turn = (f64::from(i) * 0.618_033_988_749_894_9).fract() as f32;
            let (sin, cos) = (std::f32::consts::TAU * turn).sin_cos();
            let x = r * cos / a;
            let y = (r * sin - b * x) / d;
            inside += u32::from(Domain::Disk.contains(lobe.mean + Vec2::new(x, y)));
        }
        let counted = f64::from(inside) / f64::from(n);
        let mass = f64::from(Domain::Disk.mass(&lobe));
        assert!(
            (mass - counted).abs() < 5e-4,
            "{round}: {mass} {counted} {lobe:?}"
        );
    }
}
