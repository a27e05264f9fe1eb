//! Sampling and density: partition, normalisation, chi-square.

use super::synthetic::{Patch, chi_square_z, integral, square, unit_box};
use crate::guide::{ModelKind, Product, Settings, Trainer};
use crate::math::equal_area::direction_code;
use crate::math::warp::uniform_sphere;
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

fn random(model: ModelKind, product: Product, seed: u64) -> Trainer {
    Trainer::random(Vec3::ZERO, Vec3::ONE, model, product, seed)
}

fn point(rng: &mut Pcg32) -> Vec3 {
    Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32())
}

#[test]
fn exactly_one_leaf_link_holds_a_position_and_direction() {
    let trainer = random(ModelKind::Constant, Product::None, 1);
    let field = trainer.freeze();
    let mut rng = Pcg32::new(5, 5);
    for _ in 0..20_000 {
        let (x, w) = (point(&mut rng), uniform_sphere(square(&mut rng)));
        let code = direction_code(w);
        let links = field.at(x, None, Rgb::ONE).links();
        let holding: Vec<_> = links.iter().filter(|(q, _)| q.contains(code)).collect();
        assert_eq!(holding.len(), 1);
        // Training finds the same one as sampling.
        let key = trainer.space.grid.key(x, Vec3::Z);
        let link = trainer.product.find(&trainer.space.grid, key, code);
        assert_eq!(trainer.product.links[link as usize].q, holding[0].0);
        let on_path = trainer.product.links[link as usize].r;
        let range = &trainer.space.nodes[on_path as usize];
        assert!(range.level == 0 || key >= range.prefix);
    }
}

#[test]
fn links_of_a_path_cover_the_sphere_and_sum_to_the_normaliser() {
    for seed in 0..5 {
        let field = random(ModelKind::Constant, Product::None, seed).freeze();
        let mut rng = Pcg32::new(seed, 6);
        for _ in 0..200 {
            let local = field.at(point(&mut rng), None, Rgb::ONE);
            let links = local.links();
            let area: f64 = links.iter().map(|l| f64::from(l.0.solid_angle())).sum();
            assert!((area / (4.0 * std::f64::consts::PI) - 1.0).abs() < 1e-6);
            let sum: Rgb = links.iter().map(|l| l.1).sum();
            let total = local.irradiance();
            assert!((sum - total).abs().max_element() <= 1e-6 * total.max_element());
        }
    }
}

#[test]
fn densities_integrate_to_one() {
    for (model, n) in [
        (ModelKind::Constant, 1 << 20),
        (ModelKind::Vmf, 1 << 18),
        (ModelKind::Gauss, 1 << 20),
    ] {
        for product in [Product::None, Product::Horizon, Product::Cosine] {
            let field = random(model, product, 11).freeze();
            let mut rng = Pcg32::new(7, 7);
            for i in 0..4 {
                let normal = (i > 0).then(|| uniform_sphere(square(&mut rng)));
                let local = field.at(point(&mut rng), normal, Rgb::new(1.0, 0.3, 0.1));
                let total = integral(n, |w| local.pdf(w));
                assert!((total - 1.0).abs() < 1e-3, "{model:?} {product:?}: {total}");
                let floor = 0.01 / (4.0 * std::f32::consts::PI);
                assert!(local.pdf(Vec3::Z) >= 0.999 * floor);
            }
        }
    }
}

/// Pearson's statistic of samples against the density integrated over 64 equal cells, as a z-score.
/// A density wrong by 1 % moves it by N * 1e-4, 60 at the sample count below: about 4 deviations.
fn deviation(local: &crate::guide::LocalField, samples: u32, rng: &mut Pcg32) -> f64 {
    const CELLS: usize = 64;
    let mut counts = [0u32; CELLS];
    for _ in 0..samples {
        let s = local.sample(square(rng), square(rng));
        assert!(s.pdf > 0.0 && s.pdf.is_finite());
        assert!((s.direction.length() - 1.0).abs() < 1e-5);
        let again = local.pdf(s.direction);
        assert!((again - s.pdf).abs() <= 1e-5 * s.pdf, "{again} {}", s.pdf);
        counts[(direction_code(s.direction) >> 26) as usize] += 1;
    }
    chi_square_z(&counts, 128, |w| local.pdf(w))
}

fn chi_square(model: ModelKind, product: Product, points: u32) {
    let field = random(model, product, 21).freeze();
    let mut rng = Pcg32::new(31, product as u64);
    let mut worst = f64::MIN;
    for i in 0..points {
        let x = point(&mut rng);
        let normal = (i % 4 != 0).then(|| uniform_sphere(square(&mut rng)));
        let local = field.at(x, normal, Rgb::new(0.2, 1.0, 0.6));
        worst = worst.max(deviation(&local, 600_000, &mut rng));
    }
    // One-sided 1 % over all points (Sidak, at most 12 points): z = 3.14; a 1 % wrong density
    // fails.
    assert!(worst < 3.2, "{model:?} {product:?}: {worst}");
}

#[test]
fn constant_samples_match_their_density() {
    chi_square(ModelKind::Constant, Product::None, 6);
    chi_square(ModelKind::Constant, Product::Horizon, 8);
    chi_square(ModelKind::Constant, Product::Cosine, 8);
}

#[test]
fn vmf_samples_match_their_density() {
    chi_square(ModelKind::Vmf, Product::None, 3);
    chi_square(ModelKind::Vmf, Product::Horizon, 4);
    chi_square(ModelKind::Vmf, Product::Cosine, 4);
}

#[test]
fn gauss_samples_match_their_density() {
    chi_square(ModelKind::Gauss, Product::None, 12);
}

#[test]
fn directions_below_the_horizon_are_rare_with_a_normal() {
    let field = random(ModelKind::Constant, Product::Cosine, 3).freeze();
    let mut rng = Pcg32::new(1, 1);
    let mut below = [0u32; 2];
    for _ in 0..20_000 {
        let (x, n) = (point(&mut rng), uniform_sphere(square(&mut rng)));
        for (b, normal) in below.iter_mut().zip([None, Some(n)]) {
            let s = field
                .at(x, normal, Rgb::ONE)
                .sample(square(&mut rng), square(&mut rng));
            *b += u32::from(s.direction.dot(n) < 0.0);
        }
    }
    // The horizon is resolved to the 16 base cells: more than half of the waste goes.
    assert!(below[0] > 9000 && below[1] < 4500, "{below:?}");
}

#[test]
fn throughput_decides_between_colours() {
    let red = Vec3::X;
    let blue = Vec3::Z;
    let photons: Vec<_> = (0..1000)
        .map(|i| crate::guide::Photon {
            position: Vec3::splat(0.5),
            direction: if i % 2 == 0 { red } else { blue },
            power: if i % 2 == 0 { Rgb::X } else { Rgb::Z },
            distance: 1.0,
            normal: Vec3::Z,
        })
        .collect();
    let mut trainer = Trainer::build(super::synthetic::unit_box()).unwrap();
    trainer.train(&photons, 1000);
    let field = trainer.freeze();
    let at = |t| field.at(Vec3::splat(0.5), None, t);
    assert!(at(Rgb::X).pdf(red) > 20.0 * at(Rgb::X).pdf(blue));
    assert!(at(Rgb::Z).pdf(blue) > 20.0 * at(Rgb::Z).pdf(red));
    // Only its colour matters, not its size.
    for scale in [1e-38f32, 1e-10, 1e30] {
        assert_eq!(at(Rgb::X * scale).pdf(red), at(Rgb::X).pdf(red));
    }
    for odd in [Rgb::ZERO, Rgb::NAN, Rgb::splat(f32::INFINITY), -Rgb::ONE] {
        assert_eq!(at(odd).pdf(red), at(Rgb::ONE).pdf(red));
    }
}

#[test]
fn edge_numbers_pick_links_with_light() {
    let top = 1.0 - 1.0 / 16_777_216.0;
    for model in ModelKind::ALL {
        let field = random(*model, Product::Cosine, 5).freeze();
        let mut rng = Pcg32::new(4, 4);
        for _ in 0..200 {
            let local = field.at(point(&mut rng), Some(Vec3::Y), Rgb::ONE);
            for a in [0.0, 0.01, 0.010_000_001, 0.5, top] {
                for b in [0.0, 2f32.powi(-24), top] {
                    for d in [0.0, top] {
                        let s = local.sample(Vec2::new(a, b), Vec2::splat(d));
                        assert!(s.pdf.is_finite() && s.direction.is_finite());
                        assert!((local.pdf(s.direction) - s.pdf).abs() <= 1e-5 * s.pdf);
                        let chosen = a >= 0.010_000_001;
                        let floor = 0.01 / (4.0 * std::f32::consts::PI);
                        assert!(!chosen || s.pdf > floor, "{model:?} {a} {b} {d}: {}", s.pdf);
                    }
                }
            }
        }
    }
}

#[test]
fn a_cell_draws_from_needles_that_only_its_neighbours_met() {
    // Under a constant sky a needle of light falls on strips of the floor.
    let needle = Vec3::new(0.6, 0.0, 0.8);
    let floor = Patch::floor();
    let mut t = Trainer::build(Settings {
        model: ModelKind::Gauss,
        ..unit_box()
    })
    .unwrap();
    t.set_surface(&floor.surface(20_000, 5), 1.0);
    for batch in 0..4 {
        let mut photons = floor.constant_light(8000, batch);
        for (i, photon) in photons.iter_mut().enumerate() {
            if (4.0 * photon.position.x).fract() < 0.5 && i % 4 == 0 {
                photon.direction = needle;
            }
        }
        t.train(&photons, 8000);
        t.refine_rounds(4);
    }
    let field = t.freeze();
    let mut rng = Pcg32::new(3, 8);
    let mut density = |x: f32| {
        let local = field.at(Vec3::new(x, 0.4, 0.25), None, Rgb::ONE);
        let z = deviation(&local, 600_000, &mut rng);
        assert!(z < 3.2, "{z}");
        local.pdf(needle)
    };
    let (met, known) = (density(0.31), density(0.45));
    assert!(met > 100.0, "{met}");
    // The sky alone has 0.8 / pi.
    assert!(known > 10.0 && known < 0.5 * met, "{known} of {met}");
}
