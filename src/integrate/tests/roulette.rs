//! How long paths live.

use crate::accel::Ray;
use crate::camera::CameraRay;
use crate::integrate::guided_path::GuidedPath;
use crate::integrate::path::Path;
use crate::integrate::roulette::{MAX_SURVIVAL, by_field, by_throughput, split_factor};
use crate::math::{PathSampler, Rgb, Vec3};

fn path(throughput: Rgb, eta: f32) -> GuidedPath {
    let camera = CameraRay {
        ray: Ray::new(Vec3::ZERO, Vec3::Z),
        cone_width: 0.0,
        cone_spread: 0.0,
        sees: true,
    };
    let mut path = Path::new(&camera, PathSampler::independent(0, 0, 0), 0);
    (path.throughput, path.eta, path.depth) = (throughput, eta, 7);
    GuidedPath::new(path, 1.0)
}

#[test]
fn by_throughput_a_path_lives_as_its_brightest_channel_says() {
    let chance =
        |r, g, b, eta| by_throughput(&path(Rgb::new(r, g, b), eta).base, 1.0, MAX_SURVIVAL);
    assert_eq!(chance(0.1, 0.5, 0.2, 1.0), 0.5);
    // Inside glass the throughput is scaled by 1/eta^2, which says nothing about what it will
    // bring.
    assert!((chance(0.2, 0.2, 0.2, 1.5) - 0.45).abs() < 1e-6);
    assert_eq!(
        chance(4.0, 1.0, 1.0, 1.0),
        0.95,
        "paths between mirrors end"
    );
    assert_eq!(chance(0.0, 0.0, 0.0, 1.0), 0.0);
}

#[test]
fn a_path_that_was_guided_through_glass_is_not_ended() {
    let mut p = path(Rgb::splat(0.002), 1.0);
    p.reference_throughput = 0.002;
    assert_eq!(
        by_throughput(&p.base, p.reference_throughput, MAX_SURVIVAL),
        0.95
    );
    // Glass that absorbs half since.
    p.base.throughput *= 0.5;
    assert_eq!(
        by_throughput(&p.base, p.reference_throughput, MAX_SURVIVAL),
        0.5
    );
}

#[test]
fn by_the_field_a_path_lives_for_its_share_of_the_sample() {
    let mut p = path(Rgb::splat(1e-6), 1.0);
    // The first vertex sets what is expected; however dark the throughput, nothing is lost yet.
    assert_eq!(by_field(&mut p, 6.0), 1.0);
    assert_eq!(p.pixel_estimate, 6.0);
    // Half of the sample or more is worth going on for certain.
    assert_eq!(by_field(&mut p, 3.0), 1.0);
    assert_eq!(by_field(&mut p, 60.0), 1.0);
    assert!((by_field(&mut p, 1.5) - 0.5).abs() < 1e-6);
    // The field may be wrong.
    assert_eq!(by_field(&mut p, 0.0), 0.1);
    assert_eq!(p.pixel_estimate, 6.0, "what was expected stays");
}

#[test]
fn nonsense_from_a_field_never_ends_a_path() {
    for (expected, expected_contribution) in [(1.0, f32::NAN), (f32::INFINITY, f32::INFINITY)] {
        let mut p = path(Rgb::ONE, 1.0);
        p.pixel_estimate = expected;
        assert_eq!(by_field(&mut p, expected_contribution), 1.0);
        assert_eq!(split_factor(&p, expected_contribution), 1);
    }
}

#[test]
fn a_path_worth_more_than_its_sample_is_split_into_ways_worth_1_2_times_as_much_at_most() {
    let mut p = path(Rgb::ONE, 1.0);
    assert_eq!(split_factor(&p, 1e9), 1, "nothing is expected yet");
    p.pixel_estimate = 3.0;
    for (expected_contribution, n) in [(0.0, 1), (3.5, 1), (3.7, 2), (7.1, 2), (7.3, 3), (1e9, 32)]
    {
        assert_eq!(
            split_factor(&p, expected_contribution),
            n,
            "{expected_contribution}"
        );
    }
    for (so_far, n) in [(2, 16), (5, 6), (20, 1), (32, 1), (33, 1)] {
        p.split_factor = so_far;
        assert_eq!(split_factor(&p, 1e30), n, "{so_far}");
    }
    // No way is in danger of roulette at once.
    assert_eq!(by_field(&mut p, 3.7 / 2.0), 1.0);
}

/// Dividing by the chance makes up for the paths that ended.
#[test]
fn what_survives_stands_for_what_does_not() {
    let mut sampler = PathSampler::independent(5, 6, 7);
    let mut sums = [0f64; 2];
    let n = 200_000;
    for _ in 0..n {
        let u = sampler.next4();
        let mut p = path(Rgb::splat(0.3), 1.0);
        p.pixel_estimate = 10.0;
        let by = [
            by_throughput(&p.base, p.reference_throughput, MAX_SURVIVAL),
            by_field(&mut p, 1.4),
        ];
        for ((sum, chance), u) in sums.iter_mut().zip(by).zip(u) {
            if u < chance {
                *sum += f64::from(1.0 / chance);
            }
        }
    }
    for (sum, chance) in sums.iter().zip([0.3f64, 1.4 / 10.0 * 2.0]) {
        // The variance of each term is 1 / chance - 1: four deviations of their mean.
        let bound = 4.0 * ((1.0 / chance - 1.0) / f64::from(n)).sqrt();
        assert!((sum / f64::from(n) - 1.0).abs() < bound, "{sum}");
    }
}
