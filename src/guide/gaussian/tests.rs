//! The disk, which only [`crate::guide::ModelKind::Gauss`] uses; the square is tested with cached mixtures.

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
