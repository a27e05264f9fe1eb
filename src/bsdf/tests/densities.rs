//! `sample` against `pdf` and `eval`: chi-square over the sphere, total mass, and weights.

use super::models::{beckmann, ggx, glass, gold, smooth};
use super::statistics::{chi_square, significance};
use super::{of_material, resolved};
use crate::bsdf::{Bsdf, LobeFlags, Material, Transport};
use crate::math::{Pcg32, Vec2, Vec3};
use std::f64::consts::TAU;

/// Cells in z and in the azimuth. An even number in z puts the horizon on a border.
const ROWS: usize = 24;
const COLUMNS: usize = 48;
/// Draws for each model and direction.
const DRAWS: usize = 100_000;

/// Directions the light leaves in: normal, oblique, grazing, and from below.
pub(super) fn directions() -> [Vec3; 5] {
    [
        Vec3::new(0.0, 0.0, 1.0),
        Vec3::new(0.6, 0.3, 0.7).normalize(),
        Vec3::new(-0.5, 0.8, 0.15).normalize(),
        Vec3::new(0.2, 0.5, -0.7).normalize(),
        Vec3::new(-0.9, 0.1, -0.2).normalize(),
    ]
}

fn direction(z: f64, phi: f64) -> Vec3 {
    let r = (1.0 - z * z).max(0.0).sqrt();
    Vec3::new((r * phi.cos()) as f32, (r * phi.sin()) as f32, z as f32)
}

fn cell(w: Vec3) -> usize {
    let z = ((f64::from(w.z) * 0.5 + 0.5) * ROWS as f64) as usize;
    let phi = f64::from(w.y).atan2(f64::from(w.x)).rem_euclid(TAU);
    let column = ((phi / TAU) * COLUMNS as f64) as usize;
    z.min(ROWS - 1) * COLUMNS + column.min(COLUMNS - 1)
}

/// Integral of `f` over a rectangle by Gauss's rule with 3 x 3 points, split while the quarters
/// disagree with the whole.
fn integrate(
    f: &impl Fn(f64, f64) -> f64,
    [x, y]: [(f64, f64); 2],
    tolerance: f64,
    depth: u32,
) -> f64 {
    let rule = |(x0, x1): (f64, f64), (y0, y1): (f64, f64)| {
        const NODES: [(f64, f64); 3] = [
            (0.112_701_665_379_258_3, 5.0 / 18.0),
            (0.5, 8.0 / 18.0),
            (0.887_298_334_620_741_7, 5.0 / 18.0),
        ];
        let mut sum = 0.0;
        for (u, wu) in NODES {
            for (v, wv) in NODES {
                sum += wu * wv * f(x0 + (x1 - x0) * u, y0 + (y1 - y0) * v);
            }
        }
        sum * (x1 - x0) * (y1 - y0)
    };
    let (mx, my) = (0.5 * (x.0 + x.1), 0.5 * (y.0 + y.1));
    let quarters = [
        [(x.0, mx), (y.0, my)],
        [(mx, x.1), (y.0, my)],
        [(x.0, mx), (my, y.1)],
        [(mx, x.1), (my, y.1)],
    ];
    let whole = rule(x, y);
    let parts: f64 = quarters.iter().map(|q| rule(q[0], q[1])).sum();
    if depth == 0 || (whole - parts).abs() < tolerance {
        return parts;
    }
    quarters
        .iter()
        .map(|&q| integrate(f, q, 0.25 * tolerance, depth - 1))
        .sum()
}

/// The integral of the density over each cell.
fn expected(bsdf: &Bsdf, wo: Vec3) -> Vec<f64> {
    let f = |z: f64, phi: f64| f64::from(bsdf.pdf(wo, direction(z, phi)));
    (0..ROWS * COLUMNS)
        .map(|i| {
            let (row, column) = ((i / COLUMNS) as f64, (i % COLUMNS) as f64);
            let z = |r: f64| 2.0 * r / ROWS as f64 - 1.0;
            let phi = |c: f64| TAU * c / COLUMNS as f64;
            let bounds = [(z(row), z(row + 1.0)), (phi(column), phi(column + 1.0))];
            integrate(&f, bounds, 1e-6, 6)
        })
        .collect()
}

/// Counts of smooth samples in each cell.
fn observed(bsdf: &Bsdf, wo: Vec3, seed: u64) -> Vec<f64> {
    let mut rng = Pcg32::new(seed, 7);
    let mut counts = vec![0.0; ROWS * COLUMNS];
    for _ in 0..DRAWS {
        let u_lobe = rng.next_f32();
        let u = Vec2::new(rng.next_f32(), rng.next_f32());
        if let Some(s) = bsdf.sample(wo, u_lobe, u, Transport::Radiance) {
            if !s.lobe.has(LobeFlags::DELTA) {
                counts[cell(s.wi)] += 1.0;
            }
        }
    }
    counts
}

/// One chi-square test at the given significance, and the total mass.
pub(super) fn check(what: &str, bsdf: &Bsdf, wo: Vec3, seed: u64, threshold: f64) {
    let density = expected(bsdf, wo);
    let counts = observed(bsdf, wo, seed);
    let mass: f64 = density.iter().sum();
    let drawn = counts.iter().sum::<f64>() / DRAWS as f64;
    // Beckmann's rational masking is up to 0.35 % off its integral.
    let noise = 4.0 * (mass * (1.0 - mass).max(0.0) / DRAWS as f64).sqrt();
    assert!(
        (mass - drawn).abs() < 0.004 + noise,
        "{what} {wo}: mass {mass}, drawn {drawn}"
    );
    if mass < 1e-3 {
        return;
    }
    let scale = counts.iter().sum::<f64>() / mass;
    let due: Vec<f64> = density.iter().map(|d| d * scale).collect();
    let p = chi_square(&counts, &due).expect("cells to compare");
    assert!(p > threshold, "{what} {wo}: p = {p:e}");
}

/// Tests of one share of the models, so that shares run at the same time.
fn samples_follow_densities(share: usize) {
    let models = smooth();
    let threshold = significance(models.len() * directions().len());
    for (i, name) in models.iter().enumerate().filter(|(i, _)| i % 4 == share) {
        for (k, wo) in directions().into_iter().enumerate() {
            let seed = (100 * i + k) as u64;
            check(name, &resolved(name, wo), wo, seed, threshold);
        }
    }
}

/// Sharper, rougher and more strongly refracting facets than the named models have.
#[test]
fn samples_follow_densities_over_roughness_and_index() {
    let mut list: Vec<Material> = Vec::new();
    for alpha in [0.03, 0.7, 1.0] {
        list.push(gold(ggx(alpha)).into());
        list.push(gold(beckmann(alpha)).into());
    }
    for eta in [0.6, 1.3, 2.5] {
        list.push(glass(eta, ggx(0.4)).into());
        list.push(glass(eta, beckmann(0.4)).into());
    }
    let threshold = significance(list.len() * directions().len());
    for (i, material) in list.into_iter().enumerate() {
        for (k, wo) in directions().into_iter().enumerate() {
            let bsdf = of_material(material.clone(), wo);
            check(
                &format!("{material:?}"),
                &bsdf,
                wo,
                (100 * i + k) as u64,
                threshold,
            );
        }
    }
}

#[test]
fn samples_follow_densities_0() {
    samples_follow_densities(0);
}

#[test]
fn samples_follow_densities_1() {
    samples_follow_densities(1);
}

#[test]
fn samples_follow_densities_2() {
    samples_follow_densities(2);
}

#[test]
fn samples_follow_densities_3() {
    samples_follow_densities(3);
}

#[test]
fn weights_are_value_over_density() {
    let mut rng = Pcg32::new(11, 3);
    for name in smooth() {
        for wo in directions() {
            let bsdf = resolved(name, wo);
            for transport in [Transport::Radiance, Transport::Importance] {
                for _ in 0..500 {
                    let u = Vec2::new(rng.next_f32(), rng.next_f32());
                    let Some(s) = bsdf.sample(wo, rng.next_f32(), u, transport) else {
                        continue;
                    };
                    assert!((s.wi.length() - 1.0).abs() < 1e-5, "{name}");
                    if s.lobe.has(LobeFlags::DELTA) {
                        continue;
                    }
                    let (value, pdf) = bsdf.eval_pdf(wo, s.wi, transport);
                    let error = (s.weight - value / pdf).abs().max_element();
                    assert!(
                        error < 1e-4 * s.weight.max_element().max(1.0),
                        "{name} {wo} {}: {} {} {pdf}",
                        s.wi,
                        s.weight,
                        value / pdf
                    );
                    assert!(
                        (s.pdf / pdf - 1.0).abs() < 2e-3,
                        "{name} {wo}: {} {pdf}",
                        s.pdf
                    );
                }
            }
        }
    }
}
