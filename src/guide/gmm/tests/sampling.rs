//! The map, densities and samples: exact, whatever the mixture.

use super::super::field::LocalMixture;
use super::super::square::{DENSITY, to_hemisphere, to_square};
use super::super::{LOBES, Lobe, Mixture, Mixtures};
use crate::guide::gaussian::Domain;
use crate::guide::tests::synthetic::square;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Vec2, Vec3};

#[test]
fn the_map_is_its_own_inverse_and_keeps_areas() {
    let mut rng = Pcg32::new(1, 2);
    let mut above = [0u32; 4];
    for _ in 0..100_000 {
        let u = square(&mut rng);
        let d = to_hemisphere(u);
        assert!((d.length() - 1.0).abs() < 1e-6 && d.z >= 0.0);
        let back = to_square(d).unwrap();
        assert!((back - u).length() < 3e-6, "{u} {back}");
        above[((d.z * 4.0) as usize).min(3)] += 1;
    }
    // Equal slices of z have equal areas; five standard deviations of a count are 680.
    assert!(above.iter().all(|n| n.abs_diff(25_000) < 680), "{above:?}");
    assert_eq!(to_square(Vec3::new(0.6, 0.0, -0.8)), None);
    assert_eq!(to_square(Vec3::NAN), None);
    assert_eq!(to_square(Vec3::Z), Some(Vec2::splat(0.5)));
    assert_eq!(to_square(Vec3::X), Some(Vec2::new(1.0, 0.5)));
}

/// Lobes of all kinds: narrow and wide, in corners, nearly degenerate.
fn lobes(rng: &mut Pcg32) -> [Lobe; LOBES] {
    std::array::from_fn(|_| {
        let s = Vec2::splat(0.02) + 0.6 * square(rng) * square(rng);
        let correlation = (1.0 - 0.3 * rng.next_f32()) * (2.0 * rng.next_f32() - 1.0) * 0.999;
        Lobe {
            weight: rng.next_f32(),
            mean: square(rng),
            covariance: [s.x * s.x, correlation * s.x * s.y, s.y * s.y],
        }
    })
}

#[test]
fn densities_over_the_square_integrate_to_one() {
    let mut rng = Pcg32::new(3, 4);
    for i in 0..20 {
        let mixture = Mixture::new(&lobes(&mut rng), 0.01, Domain::Square);
        // Midpoints: exact to 1e-4 for the narrowest, half a dozen cells wide across the diagonal.
        let n = 1500;
        let sum: f64 = (0..n * n)
            .map(|k| {
                let u = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
                f64::from(mixture.density(u))
            })
            .sum();
        let total = sum / f64::from(n * n);
        assert!((total - 1.0).abs() < 1e-3, "{i}: {total}");
    }
}

/// Pearson's statistic over 64 cells of the square as a normal deviate (Wilson and Hilferty).
fn chi_square(expected: &[f64], counts: &[u32]) -> f64 {
    let (mut statistic, mut freedom) = (0.0, -1.0);
    let (mut pooled, mut pooled_count) = (0.0, 0.0);
    for (&e, &n) in expected.iter().zip(counts) {
        if e < 5.0 {
            pooled += e;
            pooled_count += f64::from(n);
            continue;
        }
        statistic += (f64::from(n) - e).powi(2) / e;
        freedom += 1.0;
    }
    if pooled >= 5.0 {
        statistic += (pooled_count - pooled).powi(2) / pooled;
        freedom += 1.0;
    }
    let v = 2.0 / (9.0 * freedom);
    ((statistic / freedom).cbrt() - (1.0 - v)) / v.sqrt()
}

#[test]
fn samples_match_their_density() {
    const SAMPLES: u32 = 400_000;
    let field = Mixtures::random(Vec3::ZERO, Vec3::ONE, 7);
    let mut rng = Pcg32::new(5, 6);
    let mut worst = f64::MIN;
    let mut asked = 0;
    while asked < 8 {
        let normal = uniform_sphere(square(&mut rng));
        let Some(local) = field.at(Vec3::splat(0.5) + 0.1 * normal, normal) else {
            continue;
        };
        asked += 1;
        worst = worst.max(deviation(&local, SAMPLES, &mut rng));
    }
    // One in a hundred of the largest of eight deviates is above 3.0; a density 1 % off fails.
    assert!(worst < 3.2, "{worst}");
}

/// Samples of one mixture against its density: the sphere cut by eight slices of z and eight
/// sectors.
fn deviation(local: &LocalMixture, samples: u32, rng: &mut Pcg32) -> f64 {
    let bin = |w: Vec3| {
        let slice = (((w.z + 1.0) * 4.0) as usize).min(7);
        let sector = ((w.y.atan2(w.x) / std::f32::consts::TAU + 0.5) * 8.0) as usize;
        slice * 8 + sector.min(7)
    };
    let mut counts = [0u32; 64];
    for _ in 0..samples {
        let s = local.sample(rng.next_f32(), square(rng));
        assert!(s.pdf > 0.0 && s.pdf.is_finite());
        assert!((s.direction.length() - 1.0).abs() < 1e-5);
        let again = local.pdf(s.direction);
        // On the horizon rounding decides.
        assert!(
            again == 0.0 || (again - s.pdf).abs() <= 1e-4 * s.pdf,
            "{again} {}",
            s.pdf
        );
        counts[bin(s.direction)] += 1;
    }
    let n = 2048;
    let mut expected = [0f64; 64];
    for k in 0..n * n / 2 {
        let (i, j) = (k % n, k / n);
        let z = 1.0 - (i as f32 + 0.5) * 2.0 / n as f32;
        let phi = (j as f32 + 0.5) * std::f32::consts::TAU / (n / 2) as f32;
        let r = (1.0 - z * z).sqrt();
        let w = Vec3::new(r * phi.cos(), r * phi.sin(), z);
        expected[bin(w)] += f64::from(local.pdf(w));
    }
    let cell = 4.0 * std::f64::consts::PI / f64::from(n * n / 2);
    let total: f64 = expected.iter().sum::<f64>() * cell;
    assert!((total - 1.0).abs() < 2e-3, "integrates to {total}");
    let expected = expected.map(|e| e * cell * f64::from(samples));
    chi_square(&expected, &counts)
}

#[test]
fn a_mixture_without_lobes_is_uniform() {
    let odd = Lobe {
        weight: f32::NAN,
        mean: Vec2::splat(0.5),
        covariance: [1.0, 2.0, 1.0],
    };
    let mixture = Mixture::new(&[odd; LOBES], 0.01, Domain::Square);
    assert_eq!(mixture.density(Vec2::splat(0.3)), 1.0);
    assert_eq!(
        mixture.sample(0.9, Vec2::new(0.2, 0.7)),
        Vec2::new(0.2, 0.7)
    );
    assert!((DENSITY * std::f32::consts::TAU - 1.0).abs() < 1e-6);
}

#[test]
fn edge_numbers_stay_inside() {
    let top = 1.0 - 1.0 / 16_777_216.0;
    let field = Mixtures::random(Vec3::ZERO, Vec3::ONE, 3);
    let mut rng = Pcg32::new(8, 8);
    for _ in 0..300 {
        let normal = uniform_sphere(square(&mut rng));
        let Some(local) = field.at(Vec3::splat(0.5), normal) else {
            continue;
        };
        for select in [0.0, 0.01, 0.5, top] {
            for x in [0.0, 0.5, top] {
                for y in [0.0, 0.25, top] {
                    let s = local.sample(select, Vec2::new(x, y));
                    assert!(s.direction.is_finite() && s.pdf > 0.0 && s.pdf.is_finite());
                }
            }
        }
    }
}
