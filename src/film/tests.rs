//! Sums, tiles and the noise they report.

use super::filter::{Filter, FilterSampler};
use super::*;
use crate::math::rng::hash_all;
use crate::math::{Pcg32, Rgb, Vec2};

fn film(width: u32, height: u32, crop: Option<[u32; 4]>) -> Film {
    Film::new(&FilmDescription {
        width,
        height,
        crop,
        filter: Filter::Box { radius: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: Default::default(),
    })
}

/// Adds `count` samples to every pixel: exponential radiance of mean `mean(x, y)`, so that the
/// variance of one sample is the mean squared.
fn expose(film: &mut Film, first: u64, count: u64, mean: impl Fn(u32, u32) -> f32) {
    for tile in film.tiles_mut() {
        for i in 0..tile.pixels.len() {
            let (x, y) = (
                tile.x0 + i as u32 % tile.width,
                tile.y0 + i as u32 / tile.width,
            );
            for index in first..first + count {
                let mut rng = Pcg32::new(hash_all([u64::from(x), u64::from(y), index]), 1);
                let mut one = || -(1.0 - rng.next_f32()).ln() * mean(x, y);
                let sample = Sample {
                    radiance: Rgb::new(one(), one(), one()),
                    weight: 1.0,
                    ..Sample::default()
                };
                tile.add(i, index, &sample);
            }
        }
    }
}

#[test]
fn tiles_cover_a_crop_once() {
    let crop = [5, 7, 42, 40];
    let mut film = film(100, 100, Some(crop));
    assert_eq!((film.width(), film.height()), (37, 33));
    let mut seen = vec![0; 100 * 100];
    for tile in film.tiles_mut() {
        for i in 0..tile.pixels.len() as u32 {
            let (x, y) = (tile.x0 + i % tile.width, tile.y0 + i / tile.width);
            seen[(y * 100 + x) as usize] += 1;
            tile.pixels[i as usize].count = u64::from(y * 100 + x);
        }
    }
    for y in 0..100 {
        for x in 0..100 {
            let inside = (5..42).contains(&x) && (7..40).contains(&y);
            assert_eq!(seen[(y * 100 + x) as usize], u32::from(inside));
            if inside {
                assert_eq!(film.pixel(x - 5, y - 7).count, u64::from(y * 100 + x));
            }
        }
    }
}

#[test]
fn passes_add_up_to_the_same_bits_as_one() {
    let (mut one, mut two) = (film(40, 30, None), film(40, 30, None));
    expose(&mut one, 0, 12, |x, _| x as f32);
    expose(&mut two, 0, 5, |x, _| x as f32);
    expose(&mut two, 5, 7, |x, _| x as f32);
    assert_eq!(one, two);
}

#[test]
fn samples_that_are_not_finite_are_dropped_and_counted() {
    let mut film = film(40, 40, None);
    expose(&mut film, 0, 4, |_, _| 1.0);
    let clean = film.clone();
    for (radiance, index) in [(Rgb::new(0.0, f32::NAN, 0.0), 9), (Rgb::INFINITY, 10)] {
        let sample = Sample {
            radiance,
            weight: 1.0,
            ..Sample::default()
        };
        film.tiles_mut()[1].add(17, index, &sample);
    }
    assert_eq!(film.invalid_samples(), 2);
    // The 18th pixel of the second tile, 16 wide.
    assert_eq!(film.first_invalid(), Some((17, 1, 9)));
    assert_eq!(film.pixel(17, 1), clean.pixel(17, 1));
}

/// Sums stay exact where `f32` would have stopped counting: 2^24 and one.
#[test]
fn small_samples_still_count_after_large_ones() {
    let mut pixel = Pixel::default();
    let sample = |x: f32| Sample {
        radiance: Rgb::splat(x),
        weight: 1.0,
        ..Sample::default()
    };
    pixel.add(0, &sample(1e8));
    for index in 1..1001 {
        pixel.add(index, &sample(1e-3));
    }
    assert!((pixel.radiance[0] - 100_000_001.0).abs() < 1e-4);
}

/// The variance that a pixel reports is the variance of its mean over many renders, also under a
/// filter with negative lobes.
#[test]
fn variances_are_those_of_repeated_renders() {
    let sampler = FilterSampler::new(Filter::Mitchell {
        b: 1.0 / 3.0,
        c: 1.0 / 3.0,
    });
    let (renders, samples) = (20_000, 16u64);
    let (mut sum, mut squares, mut reported) = (0.0, 0.0, 0.0);
    let mut rng = Pcg32::new(7, 7);
    for _ in 0..renders {
        let mut pixel = Pixel::default();
        for index in 0..samples {
            let place = sampler.sample(Vec2::new(rng.next_f32(), rng.next_f32()));
            pixel.add(
                index,
                &Sample {
                    radiance: Rgb::splat(1.0 + place.offset.x * 0.3 + rng.next_f32()),
                    weight: place.weight,
                    ..Sample::default()
                },
            );
        }
        let value = pixel.radiance[0] / samples as f64;
        sum += value;
        squares += value * value;
        reported += pixel.variance_of_mean()[0];
    }
    let n = f64::from(renders);
    let truth = squares / n - (sum / n).powi(2);
    assert!((sum / n - 1.5).abs() < 0.01, "{}", sum / n);
    assert!(
        (reported / n / truth - 1.0).abs() < 0.05,
        "{} {truth}",
        reported / n
    );
}

/// What `noise` promises: the root of the relMSE against the converged image.
#[test]
fn noise_is_the_error_that_is_to_be_expected() {
    let mean = |x: u32, _: u32| 0.2 + x as f32 * 0.02;
    let mut film = film(128, 128, None);
    expose(&mut film, 0, 1, mean);
    assert_eq!(film.noise(), None);
    expose(&mut film, 1, 255, mean);
    // The mean of all x.
    let floor = 0.01 * (0.2f64 + 63.5 * 0.02).powi(2);
    let mut error = 0.0;
    for y in 0..128 {
        for x in 0..128 {
            let truth = f64::from(mean(x, y));
            for value in film.pixel(x, y).mean() {
                error +=
                    (value - truth).powi(2) / (truth * truth + floor) / f64::from(128 * 128 * 3);
            }
        }
    }
    let (noise, truth) = (f64::from(film.noise().unwrap().value), error.sqrt());
    assert!((noise / truth - 1.0).abs() < 0.02, "{noise} {truth}");
}

/// One bright speck must not keep a render running (nor hide that the rest is noisy).
#[test]
fn a_speck_does_not_change_the_noise() {
    let mut film = film(128, 128, None);
    expose(&mut film, 0, 64, |_, _| 0.5);
    let before = film.noise().unwrap().value;
    for tile in [0, 9, 30] {
        let sample = Sample {
            radiance: Rgb::splat(1e6),
            weight: 1.0,
            ..Sample::default()
        };
        film.tiles_mut()[tile].add(100, 64, &sample);
    }
    let after = film.noise().unwrap().value;
    assert!((after / before - 1.0).abs() < 0.01, "{before} {after}");
}

/// A film of one value has no noise, and numbers that are all the same are no trouble.
#[test]
fn an_even_film_has_none() {
    let mut film = film(20, 20, None);
    for tile in film.tiles_mut() {
        for i in 0..tile.pixels.len() {
            for index in 0..4 {
                let sample = Sample {
                    radiance: Rgb::ONE,
                    weight: 1.0,
                    ..Sample::default()
                };
                tile.add(i, index, &sample);
            }
        }
    }
    assert_eq!(film.noise().map(|n| n.value), Some(0.0));
}

/// The file that users get, read by a reader that shares no code with the writer.
#[test]
fn layers_and_metadata_reach_the_file() {
    let mut film = film(33, 21, None);
    expose(&mut film, 0, 8, |x, y| 1.0 + (x + y) as f32 * 0.1);
    let metadata = Metadata {
        scene: "kitchen.xml".into(),
        settings: "--spp 8".into(),
        spp: 8,
        seconds: 2.5,
    };
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("film.exr");
    let image = film.image(Layers::ALL, &metadata);
    let variances = film.variances();
    crate::image::write(&path, &image, &Default::default()).unwrap();
    let file = exr::prelude::read_all_flat_layers_from_file(&path).unwrap();
    assert_eq!(file.layer_data.len(), 1);
    let layer = &file.layer_data[0];
    let value = |name: &str, i: usize| {
        let list = &layer.channel_data.list;
        let found = list.iter().find(|c| c.name.eq(name)).expect(name);
        found.sample_data.value_by_flat_index(i).to_f32()
    };
    for i in [0, 100, 33 * 21 - 1] {
        let pixel = film.pixel(i as u32 % 33, i as u32 / 33);
        let red = pixel.mean()[0] as f32;
        assert!((value("R", i) - red).abs() <= red * 5e-4);
        // Floats, not halves: the files of several runs are weighed by these.
        assert_eq!(value("variance.G", i), variances.of(i)[1]);
        assert_eq!(value("samples.Y", i), 8.0);
    }
    let other = &layer.attributes.other;
    let found = |name: &str| {
        let shared = &file.attributes.other;
        let all = other.iter().chain(shared);
        all.clone()
            .find(|(n, _)| **n == *name)
            .map(|(_, v)| v.clone())
    };
    use exr::prelude::AttributeValue::{F32, Text};
    assert_eq!(found("twintree:scene"), Some(Text("kitchen.xml".into())));
    assert_eq!(found("twintree:settings"), Some(Text("--spp 8".into())));
    assert_eq!(found("twintree:spp"), Some(Text("8".into())));
    assert_eq!(found("twintree:seconds"), Some(F32(2.5)));
}
