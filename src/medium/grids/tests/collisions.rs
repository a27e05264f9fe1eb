//! Distances of collisions against analytic densities, by chi-square tests.

use super::*;

const DRAWS: u32 = 1_000_000;
const BINS: usize = 50;

/// Holds collision distances along x through the unit cube to the optical depth `depth(t)`.
///
/// With a million draws in 50 bins a density that is 1 % too high in one half and too low in the
/// other lies at 100 = 1e6 * 0.01^2 above the mean of the statistic, 10 of its standard deviations.
fn check(medium: &Heterogeneous, depth: impl Fn(f64) -> f64, seed: u64) {
    let mut rng = Pcg32::new(seed, 0);
    let mut u = || rng.next_f32();
    let end = depth(1.0);
    // Bins of equal probability, and one for what arrives.
    let share = (1.0 - (-end).exp()) / BINS as f64;
    let mut counts = [0u32; BINS + 1];
    for _ in 0..DRAWS {
        let org = Vec3::new(-0.5, 0.3, 0.6);
        let flight = medium.sample(org, Vec3::X, 9.0, &mut Rgb::ONE.clone(), &mut u);
        let bin = flight.collision.map_or(BINS, |t| {
            let probability = -(-depth(f64::from(t) - 0.5)).exp_m1();
            ((probability / share) as usize).min(BINS - 1)
        });
        counts[bin] += 1;
    }
    let mut expected = vec![share * f64::from(DRAWS); BINS];
    let mut counts = counts.to_vec();
    match (-end).exp() * f64::from(DRAWS) {
        arrive if arrive > 20.0 => expected.push(arrive),
        // Too few to compare: of the deepest media hardly any arrives.
        _ => assert!(counts.pop().unwrap() < 60),
    }
    let z = chi_square_z(&counts, &expected);
    assert!(z.abs() < SIGMAS, "optical depth {end}: z = {z}");
}

#[test]
fn in_a_constant_medium_distances_are_exponential() {
    // The last two are so dense that they are followed from voxel to voxel.
    for (i, sigma_t) in [0.2, 1.0, 8.0, 60.0, 1000.0].into_iter().enumerate() {
        let depth = |t: f64| f64::from(sigma_t) * t;
        check(&constant(sigma_t), depth, i as u64);
    }
}

#[test]
fn along_a_ramp_distances_follow_its_integral() {
    // Between the two centres, at 1/4 and 3/4, the density rises linearly from a to b.
    for (i, (a, b)) in [
        (0.2, 3.0),
        (0.0, 5.0),
        (4.0, 0.0),
        (0.0, 300.0),
        (80.0, 10.0),
    ]
    .into_iter()
    .enumerate()
    {
        let mut values = [a as f32, b as f32].into_iter().cycle();
        let value = || values.next().unwrap();
        let density = grid([2, 1, 1], 1, Affine3A::IDENTITY, Lookup::default(), value);
        let medium = Heterogeneous::new(density, 1.0, Albedo::Constant(Rgb::ONE)).unwrap();
        let depth = |t: f64| {
            let rise = (t - 0.25).clamp(0.0, 0.5);
            let before: f64 = t.min(0.25) * a;
            before + rise * (a + (b - a) * rise) + (t - 0.75).max(0.0) * b
        };
        check(&medium, depth, 10 + i as u64);
    }
}
