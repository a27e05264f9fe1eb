use super::scope::{MAX_SPP, MIN_SPP, SHARE};
use super::*;
use crate::film::FilmKind;
use crate::film::filter::Filter;

#[test]
fn one_pixel_in_a_hundred_is_left_out() {
    let mut values = vec![2.0; 200];
    (values[17], values[80]) = (1e3, 3e3);
    let (mean, tail) = trimmed(&mut values);
    assert!((mean - 2.0).abs() < 1e-12);
    assert!((tail - (198.0 * 2.0 + 4e3) / 200.0 / 2.0).abs() < 1e-9);
    assert_eq!(trimmed(&mut []), (0.0, 1.0));
    assert_eq!(trimmed(&mut [0.0; 5]), (0.0, 1.0));
}

#[test]
fn noise_that_nobody_sees_is_no_tail() {
    // The faces of a cube under an even sky are clean, and an edge is not.
    let mut edges = vec![0.0; 1000];
    edges[..10].fill(0.2);
    assert_eq!(trimmed(&mut edges), (0.0, 1.0));
    // A caustic that one pixel of them has met.
    edges[0] = 244.0;
    assert!(trimmed(&mut edges).1 > HEAVY);
}

#[test]
fn no_pixel_outweighs_all_others_and_none_is_forgotten() {
    let calm = vec![1.0; 10_000];
    let mut wild = calm.clone();
    wild[3] = 1e9;
    let most = most(&calm, &wild);
    assert_eq!(cut_mean(&calm, most), 1.0);
    let mean = cut_mean(&wild, most);
    assert!((1.002..1.004).contains(&mean), "{mean}");
}

#[test]
fn a_trial_has_as_many_paths_as_it_may_and_never_too_few() {
    let film = |width, height| FilmDescription {
        width,
        height,
        crop: None,
        filter: Filter::Box { radius: 0.5 },
        kind: FilmKind::Hdr,
        exposure: 0.0,
        extras: Default::default(),
    };
    // 96 x 64 pixels are 24 tiles.
    let small = Scope::new(&film(96, 64), 0);
    assert_eq!((small.share, small.samples), (3, MIN_SPP));
    let large = Scope::new(&film(640, 320), u64::MAX);
    assert_eq!((large.share, large.samples), (SHARE, MAX_SPP));
    // 100 tiles of 800, at 256 pixels and two sets.
    let some = Scope::new(&film(640, 320), 100 * 256 * 2 * 3);
    assert_eq!((some.share, some.samples), (SHARE, 3));
    let few = Scope::new(&film(640, 320), 20 * 256 * 2 * MIN_SPP);
    assert_eq!((few.share, few.samples), (40, MIN_SPP));
    assert_eq!(Scope::new(&film(1, 1), 0).share, 1);
}

#[test]
fn guiding_stops_where_it_is_beaten_unless_light_is_missed() {
    let even = Verdict {
        after: 4,
        again: false,
        guided: 1.0,
        unguided: effort::guided_path(5.0, 5.0) / effort::path(5.0),
        guided_rays: 5.0,
        unguided_rays: 5.0,
        tail: 1.5,
        guided_tail: 1.5,
        light_found: 1.0,
        light_found_error: 0.01,
    };
    assert!((even.gain() - 1.0).abs() < 1e-12 && even.pays());
    let beaten = Verdict {
        unguided: 0.5 * even.unguided,
        ..even
    };
    assert!((beaten.gain() - 0.5).abs() < 1e-12 && !beaten.pays());
    let dark = Verdict {
        light_found: 0.9,
        ..beaten
    };
    assert!(dark.pays());
    let bright = Verdict {
        light_found: 1.1,
        ..beaten
    };
    let uncertain = Verdict {
        light_found_error: 0.06,
        ..beaten
    };
    assert!(bright.pays() && uncertain.pays());
    // What is behind may go on, and by less when it is tried again.
    let behind = Verdict {
        unguided: 0.65 * even.unguided,
        ..even
    };
    assert!(behind.pays() && behind.is_doubtful());
    let still = Verdict {
        again: true,
        ..behind
    };
    assert!(!still.pays() && !still.is_doubtful());
    let wild = Verdict {
        tail: 50.0,
        ..beaten
    };
    assert!(wild.pays());
    // Unless it is guiding that is wild.
    let worse = Verdict {
        guided_tail: 60.0,
        ..wild
    };
    assert!(!worse.pays());
    assert!(Verdict::default().pays());
}

#[test]
fn a_ratio_of_sums_knows_its_own_error() {
    assert_eq!(ratio(&[]), (1.0, 0.0));
    assert_eq!(ratio(&[[0.0, 0.0]; 3]), (1.0, 0.0));
    assert_eq!(ratio(&[[2.0, 1.0], [4.0, 2.0]]), (0.5, 0.0));
    // Of tiles whose noise has a standard deviation of 0.1 of their mean, both ways.
    let mut state = 1_u64;
    let mut noisy = || {
        // Twelve uniform numbers: a variance of 1.
        let sum: f64 = (0..12)
            .map(|_| {
                state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
                (state >> 11) as f64 / (1_u64 << 53) as f64
            })
            .sum();
        1.0 + 0.1 * (sum - 6.0)
    };
    let (mut squares, mut errors) = (0.0, 0.0);
    for _ in 0..400 {
        let tiles: Vec<[f64; 2]> = (0..64).map(|_| [noisy(), noisy()]).collect();
        let (ratio, error) = ratio(&tiles);
        squares += (ratio - 1.0).powi(2);
        errors += error * error;
    }
    // 400 squares: 7 % of noise.
    assert!(
        (0.8..1.2).contains(&(errors / squares)),
        "{}",
        errors / squares
    );
}
