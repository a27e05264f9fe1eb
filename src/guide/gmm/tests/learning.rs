//! Expectation maximisation and the records around it.

use super::super::{GmmTrainer, LOBES, Lobe, Mixture, Sample, Settings};
use super::fit;
use crate::guide::gaussian::Domain;
use crate::guide::tests::synthetic::square;
use crate::guide::{Photon, SurfacePoint};
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

/// Three lobes well apart.
fn known() -> Mixture {
    let lobe = |weight, x, y, xx, xy, yy| Lobe {
        weight,
        mean: Vec2::new(x, y),
        covariance: [xx, xy, yy],
    };
    let mut lobes = [Lobe::default(); LOBES];
    lobes[0] = lobe(0.5, 0.25, 0.3, 0.004, 0.002, 0.003);
    lobes[1] = lobe(0.3, 0.7, 0.65, 0.001, -0.0005, 0.002);
    lobes[2] = lobe(0.2, 0.3, 0.8, 0.0004, 0.0, 0.0008);
    Mixture::new(&lobes, 0.001, Domain::Square)
}

/// Kullback and Leibler's divergence of a fit from the truth in nats, over a grid.
fn divergence(truth: &Mixture, found: &Mixture) -> f64 {
    let n = 200;
    let sum: f64 = (0..n * n)
        .map(|k| {
            let u = Vec2::new((k % n) as f32 + 0.5, (k / n) as f32 + 0.5) / n as f32;
            let (p, q) = (f64::from(truth.density(u)), f64::from(found.density(u)));
            p * (p / q).ln()
        })
        .sum();
    sum / f64::from(n * n)
}

#[test]
fn a_known_mixture_is_recovered() {
    let truth = known();
    let mut rng = Pcg32::new(1, 1);
    let samples = |n: usize, rng: &mut Pcg32| -> Vec<Sample> {
        let mut draw = || {
            let place = truth.sample(rng.next_f32(), square(rng));
            Sample { place, weight: 1.0 }
        };
        (0..n).map(|_| draw()).collect()
    };
    let mut last = f64::INFINITY;
    for (count, most) in [(200, 0.3), (2000, 0.03), (50_000, 0.006)] {
        let lobes = fit(&samples(count, &mut rng), 192, 0.9, 7).unwrap();
        let off = divergence(&truth, &Mixture::new(&lobes, 0.001, Domain::Square));
        println!("{count} photons: {off:.4} nats");
        assert!(off > -1e-3 && off < most, "{count}: {off}");
        assert!(off < last, "more photons must not teach less: {off} {last}");
        last = off;
    }
}

#[test]
fn weights_count_like_copies() {
    // Two heaps of as many photons; those on the right weigh three times as much.
    let mut rng = Pcg32::new(2, 2);
    let samples: Vec<Sample> = (0..20_000)
        .map(|_| {
            let heap = if rng.next_f32() < 0.5 { 0.2 } else { 0.7 };
            let place = Vec2::new(heap, 0.4) + 0.1 * square(&mut rng);
            let weight = if place.x > 0.5 { 3e-5 } else { 1e-5 };
            Sample { place, weight }
        })
        .collect();
    let mixture = Mixture::new(&fit(&samples, 256, 0.9, 1).unwrap(), 0.0, Domain::Square);
    let n = 100_000;
    let right = (0..n).filter(|_| mixture.sample(rng.next_f32(), square(&mut rng)).x > 0.5);
    let share = right.count() as f64 / f64::from(n);
    assert!((share - 0.75).abs() < 0.012, "{share}");
}

/// A floor of one square metre, lit by `n` photons from two directions, left and right.
fn floor(n: u32, seed: u64) -> Vec<Photon> {
    let mut rng = Pcg32::new(seed, 3);
    (0..n)
        .map(|_| {
            let u = square(&mut rng);
            let side = if u.x < 0.5 { 0.6 } else { -0.6 };
            let jitter = 0.05 * (square(&mut rng) - 0.5);
            let direction = Vec3::new(side + jitter.x, jitter.y, 0.8).normalize();
            Photon {
                position: Vec3::new(u.x, u.y, 0.0),
                direction,
                power: Rgb::splat(2.0),
                distance: 1.0,
                normal: Vec3::Z,
            }
        })
        .collect()
}

fn points(n: u32) -> Vec<SurfacePoint> {
    let point = |i: u32| Vec3::new((i % n) as f32 + 0.5, (i / n) as f32 + 0.5, 0.0) / n as f32;
    (0..n * n)
        .map(|i| SurfacePoint {
            position: point(i),
            normal: Vec3::Z,
        })
        .collect()
}

fn settings() -> Settings {
    Settings {
        batches: 4,
        photons: 300,
        ..Settings::new(Vec3::new(0.0, 0.0, -0.1), Vec3::ONE)
    }
}

#[test]
fn records_know_where_light_comes_from_and_how_much() {
    let mut trainer = GmmTrainer::new(settings(), &points(40)).unwrap();
    for batch in 0..4 {
        trainer.train(&floor(20_000, batch), 20_000);
    }
    let field = trainer.freeze();
    assert!(field.len() > 50, "{}", field.len());
    for (x, side) in [(0.2, 0.6), (0.8, -0.6)] {
        let local = field.at(Vec3::new(x, 0.5, 0.0), Vec3::Z).unwrap();
        let towards = Vec3::new(side, 0.0, 0.8);
        let away = Vec3::new(-side, 0.0, 0.8);
        assert!(
            local.pdf(towards) > 20.0 && local.pdf(away) < 0.01,
            "{}",
            local.pdf(towards)
        );
        // Two watts a photon, as many photons as were sent: 2 W/m^2.
        let e = local.irradiance().y;
        assert!((e - 2.0).abs() < 0.3, "{e}");
    }
    // Below the floor nobody listens, and nothing is known far away.
    assert!(field.at(Vec3::new(0.5, 0.5, 0.0), -Vec3::Z).is_none());
    assert!(field.at(Vec3::splat(50.0), Vec3::Z).is_none());
}

#[test]
fn threads_do_not_change_a_bit() {
    let learn = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| {
            let mut trainer = GmmTrainer::new(settings(), &points(30)).unwrap();
            (0..4).for_each(|batch| trainer.train(&floor(20_000, batch), 20_000));
            let field = trainer.freeze();
            let ask = |i: u32| {
                let at = Vec3::new(0.031 * i as f32, 0.4, 0.0);
                let s = field.at(at, Vec3::Z)?.sample(0.3, Vec2::new(0.2, 0.9));
                Some((s.direction.to_array().map(f32::to_bits), s.pdf.to_bits()))
            };
            (field.len(), (0..32).map(ask).collect::<Vec<_>>())
        })
    };
    let one = learn(1);
    assert!(one == learn(2) && one == learn(5));
}
