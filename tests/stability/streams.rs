//! S24, S25: seeds that know nothing of each other, and sample numbers beyond 2^32.

use crate::scenes::{backends, plain_box, seed};
use crate::support::{Built, film_mean};
use crate::table::Table;
use twintree::accel::Backend;
use twintree::integrate::PathSettings;
use twintree::integrate::camera_sample::PathNumber;
use twintree::integrate::debug::inspect::trace_sample;
use twintree::math::PathSampler;
use twintree::scene::description::SamplerKind;

/// Mean and squared standard error of `count` samples of a pixel from number `first` on.
fn pixel(built: &Built, path: &PathSettings, first: u64, count: u64) -> (f64, f64) {
    let view = built.view(path, None);
    let values: Vec<f64> = (first..first + count)
        .map(|i| {
            let traced = trace_sample(&view, [8, 12], PathNumber::plain(i));
            f64::from(traced.radiance.y)
        })
        .collect();
    let mean = values.iter().sum::<f64>() / count as f64;
    let spread: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
    (mean, spread / (count * (count - 1)) as f64)
}

#[test]
fn s25_large_sample_numbers() {
    let mut table = Table::default();
    let starts = [(1u64 << 32) - 10, 1 << 40, u64::MAX - 20_000];
    for (name, backend) in backends() {
        let built = plain_box(0.5, 1.0, backend);
        for sampler in [SamplerKind::Independent, SamplerKind::Sobol] {
            let path = PathSettings { sampler, ..seed(1) };
            let (mean, error) = pixel(&built, &path, 0, 16_384);
            for start in starts {
                let (far, far_error) = pixel(&built, &path, start, 16_384);
                let z = (mean - far).abs() / (error + far_error).sqrt();
                let what = format!("{sampler:?}, samples from {start}: mean, standard errors");
                table.hold("S25", &what, name, 4.0, z);
            }
        }
    }
    let mut same = 0u32;
    for i in 0..1000u64 {
        for start in [1u64 << 32, 1 << 40] {
            let sobol = |seed, pixel, sample| PathSampler::sobol(seed, pixel, 0, sample);
            for make in [PathSampler::independent, sobol] {
                let of = |sample| make(1, 5, sample).next4();
                same += u32::from(of(i) == of(start + i));
            }
        }
    }
    table.hold(
        "S25",
        "samples that repeat 2^32 or 2^40 later",
        "math",
        0.0,
        same.into(),
    );
}

/// The distance between the distribution of `z` and the normal one (Kolmogorov and Smirnov).
fn distance_from_normal(z: &mut [f64]) -> f64 {
    z.sort_by(f64::total_cmp);
    let n = z.len() as f64;
    let mut worst: f64 = 0.0;
    for (i, &x) in z.iter().enumerate() {
        let cdf = f64::from(0.5 * (1.0 + twintree::math::special::erf((x / 2f64.sqrt()) as f32)));
        worst = worst
            .max((cdf - i as f64 / n).abs())
            .max((cdf - (i + 1) as f64 / n).abs());
    }
    worst
}

fn seeds(count: u64, spp: u64) {
    let mut table = Table::default();
    let built = plain_box(0.5, 1.0, Backend::default());
    let means: Vec<(f64, f64)> = (0..count)
        .map(|s| film_mean(&built.render(&seed(s), spp).0))
        .collect();
    let n = count as f64;
    let mean = means.iter().map(|m| m.0).sum::<f64>() / n;
    // A mean of which the value is a part: its distance is smaller by sqrt(1 - 1/n).
    let shrunk = (1.0 - 1.0 / n).sqrt();
    let mut z: Vec<f64> = means.iter().map(|(m, e)| (m - mean) / e / shrunk).collect();
    let distance = distance_from_normal(&mut z);
    // The distance that one set of normal deviates in a hundred exceeds.
    let limit = 1.628 / n.sqrt();
    let what = format!("{count} seeds: distance of their means from the normal distribution");
    table.hold("S24", &what, "default", limit, distance);
}

#[test]
fn s24_seeds() {
    seeds(30, 32);
}

#[test]
#[ignore = "slow: eight million samples"]
fn s24_seeds_of_many_samples() {
    seeds(100, 320);
}
