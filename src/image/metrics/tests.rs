//! Agreement with numpy, scikit-image and FLIP's own program (`tests/vectors/metrics/metrics.py`),
//! and what they leave open: numbers that are not finite, fireflies, variances.

use super::blocks::KnownNoise;
use super::errors::{Errors, psnr};
use super::flip::Exposures;
use super::ztest::{ZTest, ztest};
use super::{Pair, fireflies, flip, ssim};
use crate::image::{Image, read};
use crate::math::{Pcg32, Rgb};
use std::path::Path;

const VECTORS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/metrics/");
const IMAGES: [&str; 3] = ["noisy", "biased", "tinted"];

fn picture(name: &str) -> Image {
    read(&Path::new(VECTORS).join(format!("{name}.exr"))).expect(name)
}

/// Each pair of the vectors, with the numbers that the other programs give it.
fn vectors() -> impl Iterator<Item = (Pair, serde_json::Value)> {
    let text = std::fs::read_to_string(Path::new(VECTORS).join("metrics.json")).expect("vectors");
    let table: serde_json::Value = serde_json::from_str(&text).expect("vectors");
    let reference = picture("reference");
    IMAGES.into_iter().map(move |name| {
        let pair = Pair::new(&picture(name), &reference).expect("one size");
        (pair, table[name].clone())
    })
}

/// Agreement to 1e-4 absolutely, or relatively for numbers above 1.
fn agree(name: &str, ours: f64, theirs: &serde_json::Value) {
    let theirs = theirs.as_f64().expect(name);
    let error = (ours - theirs).abs() / theirs.abs().max(1.0);
    assert!(error < 1e-4, "{name}: {ours} is not {theirs}");
}

#[test]
fn plain_errors_agree_with_numpy() {
    for (pair, theirs) in vectors() {
        let ours = Errors::of(&pair);
        let [blocks_4, blocks_16] = ours.rel_mse_of_blocks.map(Option::unwrap);
        for (name, value) in [
            ("l1", ours.l1),
            ("mse", ours.mse),
            ("rmse", ours.rmse()),
            ("relmse", ours.rel_mse),
            ("relmse_trimmed", ours.rel_mse_trimmed),
            ("relmse_4x4", blocks_4),
            ("relmse_16x16", blocks_16),
            ("mean_ratio", ours.mean_ratio),
        ] {
            agree(name, value, &theirs[name]);
        }
    }
}

#[test]
fn ssim_and_psnr_agree_with_scikit_image() {
    for (pair, theirs) in vectors() {
        let shown = pair.shown(0.0);
        let similarity = |pair, range| ssim::ssim(pair, range).expect("large enough");
        agree("ssim", similarity(&shown, 1.0), &theirs["ssim"]);
        agree(
            "ssim_linear_60",
            similarity(&pair, 60.0),
            &theirs["ssim_linear_60"],
        );
        agree(
            "ssim_linear_2",
            similarity(&pair, 2.0),
            &theirs["ssim_linear_2"],
        );
        agree("psnr", psnr(&shown, 1.0), &theirs["psnr"]);
        agree(
            "psnr_linear_60",
            psnr(&pair, 60.0),
            &theirs["psnr_linear_60"],
        );
    }
}

#[test]
fn flip_agrees_with_its_authors_program() {
    for (pair, theirs) in vectors() {
        let exposures = Exposures::of(pair.reference());
        agree("start", exposures.start, &theirs["start_exposure"]);
        agree("stop", exposures.stop, &theirs["stop_exposure"]);
        assert_eq!(exposures.count as u64, theirs["exposures"]);
        for (kind, map) in [
            ("ldr", flip::ldr(&pair.shown(0.0))),
            ("hdr", flip::hdr(&pair)),
        ] {
            agree(kind, flip::mean(&map), &theirs[format!("flip_{kind}")]);
            let rows = [0, 7, 20, pair.height() - 1];
            for (row, y) in theirs[format!("flip_{kind}_map")]
                .as_array()
                .unwrap()
                .iter()
                .zip(rows)
            {
                for (i, value) in row.as_array().unwrap().iter().enumerate() {
                    let at = y * pair.width() + 11 * i;
                    agree(&format!("{kind} at {}, {y}", 11 * i), map[at].into(), value);
                }
            }
        }
    }
}

/// A picture of one row or column of greys.
fn greys(width: u32, values: &[f32]) -> Image {
    let pixels: Vec<Rgb> = values.iter().map(|v| Rgb::splat(*v)).collect();
    Image::from_rgb(width, values.len() as u32 / width, &pixels)
}

#[test]
fn equal_images_have_no_error() {
    let image = picture("noisy");
    let pair = Pair::new(&image, &image).unwrap();
    let errors = Errors::of(&pair);
    assert_eq!([errors.l1, errors.mse, errors.rel_mse], [0.0; 3]);
    assert_eq!(errors.mean_ratio, 1.0);
    assert!((ssim::ssim(&pair, 1.0).unwrap() - 1.0).abs() < 1e-12);
    assert_eq!(psnr(&pair, 1.0), f64::INFINITY);
    assert_eq!(flip::mean(&flip::hdr(&pair)), 0.0);
    assert_eq!(fireflies::count(&pair), 0);
}

#[test]
fn numbers_that_are_not_finite_count_as_black_and_are_counted() {
    let bad = greys(2, &[f32::NAN, 1.0, f32::INFINITY, 1.0]);
    let good = greys(2, &[2.0, 1.0, 2.0, 1.0]);
    let pair = Pair::new(&bad, &good).unwrap();
    assert_eq!((pair.not_finite(), pair.reference_not_finite()), (2, 0));
    assert_eq!(Errors::of(&pair).mse, 2.0);
    // Where the reference does not know, nothing is an error.
    let pair = Pair::new(&good, &bad).unwrap();
    assert_eq!((pair.not_finite(), pair.reference_not_finite()), (0, 2));
    assert_eq!(Errors::of(&pair).mse, 0.0);
    for map in [flip::hdr(&pair), flip::ldr(&pair.shown(0.0))] {
        assert_eq!(map, [0.0; 4]);
    }
    assert_eq!(ssim::ssim(&pair, 1.0), None);
}

#[test]
fn sizes_that_differ_are_told() {
    let error = Pair::new(&greys(2, &[1.0; 4]), &greys(3, &[1.0; 6])).unwrap_err();
    let expected = "the image has 2 x 2 pixels, the reference 3 x 2";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn the_trimmed_error_does_not_see_a_speck() {
    let mut values = vec![1.1; 2000];
    let reference = greys(50, &vec![1.0; 2000]);
    values[777] = 1e6;
    let errors = Errors::of(&Pair::new(&greys(50, &values), &reference).unwrap());
    assert!(errors.rel_mse > 1e8, "{errors:?}");
    let expected = 0.01 / 1.01;
    assert!(
        (errors.rel_mse_trimmed / expected - 1.0).abs() < 1e-5,
        "{errors:?}"
    );
}

#[test]
fn fireflies_are_brighter_than_all_around_them() {
    // A lamp of 10 in the middle column; specks beside it may be its blur, those further off are
    // not.
    let mut reference = vec![0.1; 35];
    for y in 0..5 {
        reference[y * 7 + 3] = 10.0;
    }
    let mut image = reference.clone();
    image[2 * 7 + 2] = 30.0;
    assert_eq!(count(&image, &reference), 0);
    image[2 * 7] = 30.0;
    image[4 * 7 + 6] = 2.0;
    assert_eq!(count(&image, &reference), 2);
    image[4 * 7 + 2] = 41.0;
    assert_eq!(count(&image, &reference), 3);
    // The mean of the reference is about 1.5: what is below four hundredths of it is dark.
    image[6] = 0.35;
    assert_eq!(count(&image, &reference), 3);

    fn count(image: &[f32], reference: &[f32]) -> usize {
        fireflies::count(&Pair::new(&greys(7, image), &greys(7, reference)).unwrap())
    }
}

/// The test where nothing is known but the variances of pixels.
fn by_variance(pair: &Pair, variance: &[Rgb], of_reference: &[Rgb]) -> Option<ZTest> {
    let known = [variance, of_reference].map(|variance| KnownNoise {
        variance: variance.to_vec(),
        noise: None,
    });
    ztest(pair, [&known[0], &known[1]])
}

/// Noise that four pixels in a row share: means over blocks are as unsure as the layer `noise`
/// tells, and would seem far too sure without it.
#[test]
fn blocks_are_as_unsure_as_the_noise_of_neighbours_makes_them() {
    let mut rng = Pcg32::new(6, 5);
    let mut normal = || (0..12).map(|_| rng.next_f32()).sum::<f32>() - 6.0;
    let mut shared = || -> Vec<Rgb> {
        let one = |_| [Rgb::new(normal(), normal(), normal()) * 0.1; 4];
        (0..256 * 64).flat_map(one).collect()
    };
    let (noise, error) = (shared(), shared());
    let pixels: Vec<Rgb> = error.iter().map(|e| *e + 1.0).collect();
    let picture = Image::from_rgb(256, 256, &pixels);
    let truth = Image::from_rgb(256, 256, &vec![Rgb::ONE; 256 * 256]);
    let pair = Pair::new(&picture, &truth).unwrap();
    let exact = KnownNoise {
        variance: vec![Rgb::ZERO; 256 * 256],
        noise: None,
    };
    let deviations = |noise: Option<Vec<Rgb>>| {
        let known = KnownNoise {
            variance: vec![Rgb::splat(0.01); 256 * 256],
            noise,
        };
        let test = ztest(&pair, [&known, &exact]).unwrap();
        test.deviations.map(|d| d.expect("there are blocks"))
    };
    // 768 means over blocks of 16 x 16 pixels: their deviation is known to 2.6 %, the factor to 5
    // %.
    let [one, four, sixteen] = deviations(Some(noise));
    assert!((one - 1.0).abs() < 0.02, "{one}");
    assert!((four - 1.0).abs() < 0.05, "{four}");
    assert!((sixteen - 1.0).abs() < 0.15, "{sixteen}");
    let [one, four, sixteen] = deviations(None);
    assert!((one - 1.0).abs() < 0.02, "{one}");
    assert!((four - 2.0).abs() < 0.1, "{four}");
    assert!((sixteen - 2.0).abs() < 0.2, "{sixteen}");
}

#[test]
fn noise_is_inside_the_band_as_often_as_it_should_be_and_bias_is_not() {
    // 40 000 pixels: the share's standard deviation is sqrt(0.001 * 0.999 / 120 000) < 1e-4.
    let mut rng = Pcg32::new(3, 5);
    let mut normal = || (0..12).map(|_| rng.next_f32()).sum::<f32>() - 6.0;
    let pixels: Vec<Rgb> = (0..40_000)
        .map(|_| Rgb::new(normal(), normal(), normal()) * 0.1 + 1.0)
        .collect();
    let picture = Image::from_rgb(200, 200, &pixels);
    let (zero, known) = (vec![Rgb::ZERO; 40_000], vec![Rgb::splat(0.01); 40_000]);
    let test = |truth: f32, variance: &[Rgb]| {
        let truth = Image::from_rgb(200, 200, &vec![Rgb::splat(truth); 40_000]);
        by_variance(&Pair::new(&picture, &truth).unwrap(), variance, &zero).unwrap()
    };
    // Twelve uniform numbers have lighter tails than the normal distribution: 0.9995 are inside.
    let fair = test(1.0, &known);
    assert!((0.999..0.9999).contains(&fair.inside), "{fair:?}");
    assert!(fair.of_mean.iter().all(|z| z.abs() < 4.0), "{fair:?}");
    // A bias of 1 %, a tenth of a pixel's deviation, is plain in the mean of 40 000: 20 of its own.
    let bias = test(1.01, &known);
    assert!(
        bias.of_mean.iter().all(|z| (z + 20.0).abs() < 4.0),
        "{bias:?}"
    );
    // Variances too small by four: the band is 1.645 wide, and holds 0.90.
    let small: Vec<Rgb> = known.iter().map(|v| *v / 4.0).collect();
    assert!((test(1.0, &small).inside - 0.90).abs() < 0.01);
    let pair = Pair::new(&picture, &picture).unwrap();
    assert_eq!(by_variance(&pair, &zero, &zero).unwrap().inside, 1.0);
    assert_eq!(by_variance(&pair, &zero[1..], &zero), None);
}

#[test]
fn rounding_to_sixteen_bits_is_not_a_difference() {
    let mut rng = Pcg32::new(8, 1);
    let exact: Vec<f32> = (0..10_000).map(|_| 0.1 + rng.next_f32()).collect();
    let halves: Vec<f32> = exact
        .iter()
        .map(|x| half::f16::from_f32(*x).to_f32())
        .collect();
    let zero = vec![Rgb::ZERO; 10_000];
    let [exact, halves] = [exact, halves].map(|list| greys(100, &list));
    let pair = Pair::new(&halves, &exact).unwrap();
    assert_eq!(by_variance(&pair, &zero, &zero).unwrap().inside, 1.0);
}
