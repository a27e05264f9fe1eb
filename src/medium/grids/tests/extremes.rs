//! Optical depths from 1e-8 to 1e6 and beyond, places far away, grids of any size.

use super::*;
use crate::medium::grids::draw::{exponential, uniform};

/// No ray takes more draws than this.
const MAX_DRAWS: u32 = 1 << 20;
/// Rays per optical depth.
const DRAWS: f64 = 2e5;

fn counted<'a>(rng: &'a mut Pcg32, count: &'a mut u32) -> impl FnMut() -> f32 + use<'a> {
    move || {
        *count += 1;
        assert!(*count < MAX_DRAWS, "a ray does not end");
        rng.next_f32()
    }
}

#[test]
fn chances_below_the_digits_of_a_draw_are_taken_as_often_as_they_should() {
    // Chances of `uniform` by the second draw, given that the first is 0.
    for depth in [1e-8, 1e-7, 1e-6] {
        let medium = constant(depth);
        let steps = 1_000_000;
        let hits = (0..steps).filter(|i| {
            // The first place decides on the tentative collision, the next ones are free.
            let mut draws = [0.0, (*i as f32 + 0.5) / steps as f32].into_iter();
            let mut u = || draws.next().unwrap_or(0.0);
            let org = Vec3::new(0.5, 0.5, -1.0);
            let flight = medium.sample(org, Vec3::Z, 9.0, &mut Rgb::ONE.clone(), &mut u);
            flight.collision.is_some()
        });
        let chance = hits.count() as f64 / f64::from(steps) / 65536.0;
        assert!(
            (chance / f64::from(depth) - 1.0).abs() < 2e-3,
            "{depth}: {chance}"
        );
    }
}

#[test]
fn draws_are_uniform_at_both_ends() {
    let mut rng = Pcg32::new(14, 0);
    let mut u = || rng.next_f32();
    // What lies beyond a quarter of the steps of a single draw, and what it averages.
    let (mut sum, mut near_0, mut near_1) = (0.0, 0, 0);
    let count = 40_000_000u32;
    for _ in 0..count {
        let x = uniform(&mut u);
        assert!((0.0..1.0).contains(&x));
        sum += x;
        near_0 += u32::from(x < 1.5e-6);
        near_1 += u32::from(x > 1.0 - 1.5e-6);
    }
    let n = f64::from(count);
    assert!((sum / n - 0.5).abs() < SIGMAS / (12.0 * n).sqrt());
    for near in [near_0, near_1] {
        let expected = 1.5e-6 * n;
        assert!(
            (f64::from(near) - expected).abs() < SIGMAS * expected.sqrt(),
            "{near}"
        );
    }
    for x in [0.0, 1.0, f32::NAN, -1.0, 0.999_999_94] {
        let depth = exponential(&mut || x);
        assert!(x.is_nan() || (0.0..100.0).contains(&depth), "{x}: {depth}");
    }
}

#[test]
fn constant_media_of_any_depth_have_their_transmittance() {
    let mut rng = Pcg32::new(15, 0);
    let org = Vec3::new(0.5, 0.25, -3.0);
    for exponent in -8..=6 {
        let depth = 10f64.powi(exponent);
        let medium = constant(depth as f32);
        let [mut ratio, mut escaped] = [(); 2].map(|()| Mean::default());
        let mut distance = 0.0;
        for _ in 0..DRAWS as u32 {
            let mut draws = 0;
            let mut u = counted(&mut rng, &mut draws);
            ratio.add(medium.transmittance(org, Vec3::Z, f32::INFINITY, &mut u));
            let mut weights = Rgb::ONE;
            let flight = medium.sample(org, Vec3::Z, f32::INFINITY, &mut weights, &mut u);
            escaped.add(Rgb::splat(f32::from(flight.collision.is_none())));
            distance += flight.collision.map_or(0.0, |t| f64::from(t) - 3.0);
        }
        // Both are 0 or 1 in a medium whose majorant is its density, or closer to the mean. Where
        // five draws in all decide, their number is as good as Poisson's.
        let expected = (-depth).exp();
        let spread = (expected * (1.0 - expected) / DRAWS).sqrt();
        for mean in [&ratio, &escaped] {
            let off = (mean.value().x - expected).abs();
            let bound = SIGMAS * spread + 5.0 / DRAWS;
            assert!(off < bound, "{depth}: {} for {expected}", mean.value().x);
        }
        if (1..=4).contains(&exponent) {
            // The standard deviation of an exponential distance is its mean.
            let mean = distance / DRAWS * depth;
            let error = SIGMAS / DRAWS.sqrt() + 1e-6 * depth;
            assert!((mean - 1.0).abs() < error, "{depth}: {mean}");
        }
    }
}

#[test]
fn thin_channels_keep_their_light_beside_thick_ones() {
    let mut rng = Pcg32::new(16, 0);
    for sigma_t in [
        Vec3::new(1e6, 1.0, 1e-3),
        Vec3::new(1e-8, 1e4, 0.5),
        Vec3::new(0.0, 40.0, 1e30),
    ] {
        let mut values = sigma_t.to_array().into_iter().cycle();
        let value = || values.next().unwrap();
        let density = grid([20; 3], 3, Affine3A::IDENTITY, Lookup::default(), value);
        let medium = Heterogeneous::new(density, 1.0, Albedo::Constant(Rgb::ONE)).unwrap();
        let org = Vec3::new(-1.0, 0.5, 0.3);
        let [mut ratio, mut escaped, mut all] = [(); 3].map(|()| Mean::default());
        for _ in 0..100_000 {
            let mut draws = 0;
            let mut u = counted(&mut rng, &mut draws);
            ratio.add(medium.transmittance(org, Vec3::X, 5.0, &mut u));
            let mut weights = Rgb::ONE;
            let flight = medium.sample(org, Vec3::X, 5.0, &mut weights, &mut u);
            let is_through = flight.collision.is_none();
            escaped.add(if is_through { flight.factor } else { Rgb::ZERO });
            all.add(flight.factor);
        }
        let through = (-sigma_t.as_dvec3()).map(f64::exp);
        for (mean, what) in [(ratio, "transmittance"), (escaped, "escapes")] {
            let off = (mean.value() - through).abs();
            let bound = SIGMAS * mean.error() + 1e-6;
            assert!(
                off.cmple(bound).all(),
                "{sigma_t} {what}: {} {off}",
                mean.value()
            );
            assert!(bound.max_element() < 0.02);
        }
        // With an albedo of 1 nothing is lost: all that does not escape is scattered.
        all.check(DVec3::ONE, 0.02, "energy");
    }
}

#[test]
fn size_and_distance_change_nothing() {
    let mut rng = Pcg32::new(18, 0);
    for size in [1e-15f32, 1e-6, 1.0, 1e6, 1e15] {
        let place = Affine3A::from_scale(Vec3::splat(size));
        let value = || 1.0 / size;
        let density = grid([8, 2, 5], 1, place, Lookup::default(), value);
        let medium = Heterogeneous::new(density, 2.0, Albedo::Constant(Rgb::ONE)).unwrap();
        for away in [0.0, 1.0, 1e4, 1e6] {
            let org = Vec3::new(0.3, -away, 0.4) * size;
            let mut mean = Mean::default();
            for _ in 0..100_000 {
                let mut u = || rng.next_f32();
                let flight =
                    medium.sample(org, Vec3::Y, f32::INFINITY, &mut Rgb::ONE.clone(), &mut u);
                mean.add(Rgb::splat(f32::from(flight.collision.is_none())));
            }
            mean.check(DVec3::splat((-2f64).exp()), 0.04, &format!("{size} {away}"));
            let depth = medium.optical_depth(org, Vec3::Y, f32::INFINITY);
            assert!((depth.x - 2.0).abs() < 1e-5, "{size} {away}: {depth}");
        }
    }
}

#[test]
fn rays_that_are_none_and_weights_that_are_none_end() {
    let mut rng = Pcg32::new(19, 0);
    let mut u = || rng.next_f32();
    let medium = {
        let mut values = [1.0, 50.0, f32::MAX].into_iter().cycle();
        let value = || values.next().unwrap();
        let density = grid([5; 3], 3, odd_place(), Lookup::default(), value);
        Heterogeneous::new(density, f32::MAX, Albedo::Constant(Rgb::ONE)).unwrap()
    };
    let odd = [0.0, 1.0, -1.0, f32::NAN, f32::INFINITY, f32::MAX, 1e-45];
    for i in 0..100_000 {
        let mut pick = || odd[(u() * 7.0) as usize];
        let mut vector = || Vec3::new(pick(), pick(), pick());
        let (mut org, dir, mut weights) = (vector(), vector(), vector());
        let distance = pick();
        if i % 2 == 0 {
            org = odd_place().transform_point3(Vec3::splat(0.5));
        }
        let _ = medium.sample(org, dir, distance, &mut weights, &mut u);
        let left = medium.transmittance(org, dir, distance, &mut u);
        assert!(
            left.cmpge(Rgb::ZERO).all() && left.cmple(Rgb::ONE).all(),
            "{left}"
        );
    }
    let density = medium.density().clone();
    for scale in [-1.0, f32::NAN, f32::INFINITY] {
        let albedo = Albedo::Constant(Rgb::ONE);
        assert!(Heterogeneous::new(density.clone(), scale, albedo).is_err());
    }
    for albedo in [-0.1, 1.1, f32::NAN] {
        let albedo = Albedo::Constant(Rgb::new(0.5, albedo, 0.5));
        assert!(Heterogeneous::new(density.clone(), 1.0, albedo).is_err());
    }
}
