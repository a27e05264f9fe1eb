use super::*;
use crate::math::Vec2;
use crate::math::rng::Pcg32;

fn phases() -> Vec<PhaseFunction> {
    let hg = |g| PhaseFunction::from(PhaseLobe::henyey_greenstein(g));
    let blend = PhaseFunction::blend(&hg(0.9), &PhaseLobe::Rayleigh.into(), 0.3).unwrap();
    let of = [-0.8, -0.2, 0.0, 5e-4, 2e-3, 0.5, 0.9];
    of.map(hg).into_iter().chain([blend]).collect()
}

/// Shares of equal parts of the range of cosines, by quadrature and by samples.
#[test]
fn phase_functions_are_sampled_as_they_are_evaluated() {
    const BINS: usize = 40;
    const SAMPLES: u32 = 200_000;
    let mut rng = Pcg32::new(7, 0);
    let before = Vec3::new(0.6, -0.48, 0.64);
    for phase in phases() {
        let (mut counts, mut around) = ([0.0; BINS], Vec3::ZERO);
        for _ in 0..SAMPLES {
            let (lobe, u) = (rng.next_f32(), Vec2::new(rng.next_f32(), rng.next_f32()));
            let after = phase.sample(before, lobe, u);
            assert!((after.length() - 1.0).abs() < 1e-5);
            let bin = (0.5 * (after.dot(before) + 1.0) * BINS as f32) as usize;
            counts[bin.min(BINS - 1)] += 1.0;
            around += after - before * after.dot(before);
        }
        let (mut total, mut chi_square) = (0.0, 0.0);
        for (bin, count) in counts.iter().enumerate() {
            let steps = 4000;
            let cosine = |i: usize| {
                let at = bin as f64 + (i as f64 + 0.5) / f64::from(steps);
                (2.0 * at / BINS as f64 - 1.0) as f32
            };
            let width = 2.0 / BINS as f64 / f64::from(steps);
            let density = (0..steps as usize).map(|i| f64::from(phase.eval(cosine(i))));
            let share = density.sum::<f64>() * width * std::f64::consts::TAU;
            total += share;
            let expected = share * f64::from(SAMPLES);
            chi_square += (count - expected) * (count - expected) / expected;
        }
        assert!((total - 1.0).abs() < 1e-3, "{phase:?}: {total}");
        // 39 degrees of freedom: 84 is exceeded once in 50 000 times.
        assert!(chi_square < 84.0, "{phase:?}: {chi_square}");
        let around = around / SAMPLES as f32;
        assert!(around.length() < 0.01, "{phase:?}: {around}");
    }
}

#[test]
fn a_blend_of_too_many_is_refused() {
    let mut all = phases()[6];
    for _ in 0..3 {
        all = PhaseFunction::blend(&all, &PhaseFunction::isotropic(), 0.1).unwrap();
    }
    assert!(PhaseFunction::blend(&all, &all, 0.5).is_err());
}

fn medium(extinction: Rgb, albedo: Rgb) -> Medium {
    Medium {
        name: "fog".into(),
        extinction: Homogeneous { extinction, albedo }.into(),
        phase: PhaseFunction::isotropic(),
    }
}

fn segment(length: f32) -> Segment {
    Segment {
        origin: Vec3::ZERO,
        direction: Vec3::X,
        length,
    }
}

/// What comes through a slab, and what is scattered in it once, by channel: closed forms, with
/// densities that differ a hundredfold, along paths of two segments (so that the second is sampled
/// by what the first has left).
#[test]
fn light_of_all_channels_comes_through() {
    let sigma = Rgb::new(0.05, 0.8, 5.0);
    let albedo = Rgb::new(1.0, 0.5, 0.9);
    let fog = medium(sigma, albedo);
    let mut rng = Pcg32::new(3, 1);
    let samples = 400_000;
    let (mut passed, mut scattered) = ([[0.0f64; 2]; 3], [[0.0f64; 2]; 3]);
    for _ in 0..samples {
        let mut weights = ChannelWeights::default();
        let mut u = || rng.next_f32();
        let first = fog.extinction.sample(&segment(0.4), &mut weights, &mut u);
        let second = fog.extinction.sample(&segment(0.6), &mut weights, &mut u);
        for c in 0..3 {
            let (a, b) = (f64::from(first.factor[c]), f64::from(second.factor[c]));
            if first.collision.is_some() {
                add(&mut scattered[c], a);
                continue;
            }
            match second.collision {
                Some(_) => add(&mut scattered[c], a * b),
                None => add(&mut passed[c], a * b),
            }
        }
    }
    for c in 0..3 {
        let through = (-f64::from(sigma[c])).exp();
        check(passed[c], samples, through, &format!("through {c}"));
        let once = f64::from(albedo[c]) * (1.0 - through);
        check(scattered[c], samples, once, &format!("scattered {c}"));
    }
}

fn add(sums: &mut [f64; 2], x: f64) {
    sums[0] += x;
    sums[1] += x * x;
}

/// Within four standard errors, which are themselves below 1 %.
fn check([sum, squares]: [f64; 2], samples: u32, expected: f64, what: &str) {
    let n = f64::from(samples);
    let mean = sum / n;
    let error = ((squares / n - mean * mean) / n).sqrt();
    assert!(error < 0.01 * expected, "{what}: {error} of {expected}");
    assert!(
        (mean - expected).abs() < 4.0 * error,
        "{what}: {mean}, not {expected}"
    );
}

#[test]
fn what_only_absorbs_is_exact() {
    let glass = medium(Rgb::new(0.0, 1.0, 1e6), Rgb::ZERO);
    let mut weights = ChannelWeights::default();
    let flight = glass
        .extinction
        .sample(&segment(2.0), &mut weights, &mut || unreachable!());
    assert_eq!(flight.collision, None);
    assert_eq!(flight.factor, Rgb::new(1.0, (-2.0f32).exp(), 0.0));
    assert_eq!(weights, ChannelWeights::default());
}

#[test]
fn extremes_neither_hang_nor_lose_light() {
    let mut rng = Pcg32::new(5, 2);
    for depth in [1e-8, 1.0, 1e6] {
        for length in [1e-6, 1.0, 1e6, f32::INFINITY] {
            let density = if length.is_finite() {
                depth / length
            } else {
                depth
            };
            let fog = medium(Rgb::new(density, 0.0, density), Rgb::ONE);
            let mut total = Rgb::ZERO;
            for _ in 0..1000 {
                let mut weights = ChannelWeights::default();
                let flight = fog
                    .extinction
                    .sample(&segment(length), &mut weights, &mut || rng.next_f32());
                assert!(flight.factor.is_finite() && flight.factor.min_element() >= 0.0);
                total += flight.factor / 1000.0;
            }
            // Nothing is absorbed: what is scattered and what comes through are all there is.
            for c in [0, 2] {
                assert!((total[c] - 1.0).abs() < 0.2, "{depth} {length}: {total}");
            }
        }
    }
}
