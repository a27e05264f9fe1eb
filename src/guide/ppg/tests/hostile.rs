//! Records and settings that make no sense.

use super::{floor, mean_over_sphere, taught, unit_box};
use crate::guide::PathSample;
use crate::guide::ppg::{PpgTrainer, Settings};
use crate::guide::tests::synthetic::odd_number;
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

fn sample() -> PathSample {
    PathSample {
        position: Vec3::splat(0.5),
        direction: Vec3::Z,
        radiance: Rgb::ONE,
        pdf: 1.0,
        distance: 1.0,
        normal: Vec3::Z,
    }
}

/// A record with one thing wrong.
fn odd(rng: &mut Pcg32) -> PathSample {
    let number = odd_number(rng);
    let mut s = sample();
    let vector = match rng.next_u32() % 7 {
        0 => &mut s.position,
        1 => &mut s.direction,
        2 => &mut s.radiance,
        3 => &mut s.normal,
        4 => {
            s.direction = Vec3::splat(number);
            return s;
        }
        5 => {
            s.pdf = number;
            return s;
        }
        _ => {
            s.distance = number;
            return s;
        }
    };
    vector[rng.next_u32() as usize % 3] = number;
    s
}

fn check(trainer: &PpgTrainer) {
    let tree = trainer.freeze();
    for x in [
        Vec3::splat(0.5),
        Vec3::splat(f32::MAX),
        Vec3::splat(-1e30),
        Vec3::NAN,
    ] {
        let Some(local) = tree.at(x, Vec3::Z, Some(Vec3::Z)) else {
            continue;
        };
        let s = local.sample(0.5, Vec2::new(0.2, 0.7));
        assert!(s.pdf > 0.0 && s.pdf.is_finite() && s.direction.is_finite());
        assert!(local.irradiance().is_finite());
    }
}

#[test]
fn odd_records_never_panic_and_teach_nothing_odd() {
    let mut rng = Pcg32::new(1, 1);
    let mut trainer = PpgTrainer::new(unit_box()).unwrap();
    for _ in 0..10 {
        let samples: Vec<PathSample> = (0..3000).map(|_| odd(&mut rng)).collect();
        trainer.train(&[samples]);
        check(&trainer);
        trainer.refine();
        check(&trainer);
    }
    let tree = trainer.freeze();
    assert!(tree.at(Vec3::splat(0.5), Vec3::Z, None).is_some());
}

#[test]
fn nothing_one_record_and_a_thousand_copies_are_learned_from() {
    for copies in [0, 1, 2, 1000, 100_000] {
        let samples = vec![sample(); copies];
        let mut trainer = taught(unit_box(), &[samples.clone(), samples]);
        trainer.train(&[[]; 2]);
        trainer.refine();
        trainer.train(&[vec![sample(); copies]]);
        check(&trainer);
        let tree = trainer.freeze();
        let local = tree.at(Vec3::splat(0.5), Vec3::Z, None);
        assert_eq!(local.is_some(), copies > 0);
        if let Some(local) = local {
            assert!(local.pdf(Vec3::Z) > 0.3, "{}", local.pdf(Vec3::Z));
            let integral = mean_over_sphere(1024, |w| local.pdf(w)) * 4.0 * std::f64::consts::PI;
            assert!((integral - 1.0).abs() < 1e-3, "{integral}");
        }
    }
}

#[test]
fn darkness_is_no_light() {
    let dark = floor(5000, 3, |_, _| Rgb::ZERO);
    let mut trainer = taught(unit_box(), &[dark.clone(), dark]);
    trainer.refine();
    let tree = trainer.freeze();
    assert!(tree.at(Vec3::splat(0.25), Vec3::Z, None).is_none());
}

#[test]
fn a_firefly_does_not_blind_the_tree() {
    let mut samples = floor(10_000, 4, |_, _| Rgb::ONE);
    samples[77].radiance = Rgb::splat(1e30);
    let tree = taught(unit_box(), &[samples]).freeze();
    let local = tree.at(Vec3::splat(0.5), Vec3::Z, None).unwrap();
    assert!(local.pdf(Vec3::Y) >= 0.009 / (4.0 * std::f32::consts::PI));
    assert!(local.irradiance().is_finite());
}

#[test]
fn points_lines_and_far_origins_have_trees() {
    for (min, size) in [(0.0, 0.0), (1e9, 10.0), (1e3, 1e-3), (-1e30, 2e30)] {
        let (min, max) = (Vec3::splat(min), Vec3::splat(min + size));
        let mut samples = floor(20_000, 5, |_, _| Rgb::ONE);
        for s in &mut samples {
            s.position = min + (max - min) * s.position.with_y(0.5);
        }
        let settings = Settings {
            threshold: 10.0,
            memory: 1 << 20,
            ..Settings::new(min, max)
        };
        let trainer = taught(settings, &[samples.clone(), samples]);
        check(&trainer);
    }
}

#[test]
fn bad_settings_are_refused() {
    let refused = |s: Settings| PpgTrainer::new(s).is_err();
    assert!(refused(Settings::new(Vec3::ONE, Vec3::ZERO)));
    assert!(refused(Settings::new(Vec3::NAN, Vec3::ONE)));
    for change in [
        |s: &mut Settings| s.threshold = f64::NAN,
        |s: &mut Settings| s.share = 0.0,
        |s: &mut Settings| s.max_level = 0,
        |s: &mut Settings| s.kept = 1.5,
        |s: &mut Settings| s.defensive = 0.0,
    ] {
        let mut settings = unit_box();
        change(&mut settings);
        assert!(refused(settings));
    }
    assert!(!refused(Settings::new(Vec3::ONE, Vec3::ONE)));
}
