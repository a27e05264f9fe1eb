//! Photons, points and settings that make no sense.

use super::super::{GmmTrainer, Sample, Settings};
use super::fit;
use crate::guide::tests::synthetic::odd_number;
use crate::guide::{Photon, SurfacePoint};
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

fn photon() -> Photon {
    Photon {
        position: Vec3::splat(0.5),
        direction: Vec3::Z,
        power: Rgb::ONE,
        distance: 1.0,
        normal: Vec3::Z,
    }
}

/// A photon with one thing wrong.
fn odd(rng: &mut Pcg32) -> Photon {
    let number = odd_number(rng);
    let mut p = photon();
    let vector = match rng.next_u32() % 5 {
        0 => &mut p.position,
        1 => &mut p.direction,
        2 => &mut p.power,
        3 => &mut p.normal,
        _ => {
            p.distance = number;
            return p;
        }
    };
    vector[rng.next_u32() as usize % 3] = number;
    p
}

fn point() -> SurfacePoint {
    SurfacePoint {
        position: Vec3::splat(0.5),
        normal: Vec3::Z,
    }
}

#[test]
fn odd_photons_and_points_never_panic_and_teach_nothing_odd() {
    let mut rng = Pcg32::new(1, 1);
    let mut points = vec![point()];
    for _ in 0..200 {
        let p = odd(&mut rng);
        points.push(SurfacePoint {
            position: p.position,
            normal: p.normal,
        });
    }
    let mut trainer = GmmTrainer::new(Settings::new(Vec3::ZERO, Vec3::ONE), &points).unwrap();
    for _ in 0..20 {
        let photons: Vec<Photon> = (0..500).map(|_| odd(&mut rng)).collect();
        trainer.train(&photons, 500);
        trainer.train(&[], u64::MAX);
    }
    let field = trainer.freeze();
    let local = field
        .at(Vec3::splat(0.5), Vec3::Z)
        .expect("sound photons were among them");
    let s = local.sample(0.5, Vec2::splat(0.5));
    assert!(s.pdf.is_finite() && s.pdf > 0.0 && s.direction.is_finite());
    assert!(local.irradiance().is_finite());
}

#[test]
fn one_photon_and_a_thousand_copies_are_a_lobe() {
    for copies in [1, 2, 7, 1000] {
        let mut trainer =
            GmmTrainer::new(Settings::new(Vec3::ZERO, Vec3::ONE), &[point()]).unwrap();
        trainer.train(&vec![photon(); copies], copies as u64);
        let field = trainer.freeze();
        let local = field.at(Vec3::splat(0.5), Vec3::Z).unwrap();
        let (there, beside) = (local.pdf(Vec3::Z), local.pdf(Vec3::X));
        assert!(
            there > 2.0 * beside && beside > 0.0,
            "{copies}: {there} {beside}"
        );
        assert!(there.is_finite());
    }
}

#[test]
fn nothing_known_is_nothing_said() {
    let settings = Settings::new(Vec3::ZERO, Vec3::ONE);
    let none = GmmTrainer::new(settings.clone(), &[point()])
        .unwrap()
        .freeze();
    assert!(none.is_empty() && none.at(Vec3::ZERO, Vec3::Z).is_none());
    let mut trainer = GmmTrainer::new(settings, &[]).unwrap();
    trainer.train(&[photon(); 100], 100);
    assert!(trainer.freeze().is_empty());
    assert_eq!(fit(&[], 64, 0.9, 1), None);
    let sample = |x: f32, weight| Sample {
        place: Vec2::new(x, 0.5),
        weight,
    };
    let odd = [
        sample(f32::NAN, 1.0),
        sample(0.5, 0.0),
        sample(0.5, f32::INFINITY),
    ];
    assert_eq!(fit(&odd, 64, 0.9, 1), None);
}

#[test]
fn settings_out_of_range_are_refused() {
    let good = Settings::new(Vec3::ZERO, Vec3::ONE);
    assert!(GmmTrainer::new(good.clone(), &[]).is_ok());
    // A scene that is a point.
    assert!(GmmTrainer::new(Settings::new(Vec3::ONE, Vec3::ONE), &[]).is_ok());
    let changes: [fn(&mut Settings); 9] = [
        |s| s.min = Vec3::NAN,
        |s| s.min = Vec3::splat(2.0),
        |s| s.batches = 0,
        |s| s.photons = 0,
        |s| s.step = 0,
        |s| s.min_radius = 0.0,
        |s| s.validity = 1.5,
        |s| s.rate = 0.2,
        |s| s.defensive = 0.0,
    ];
    for (i, change) in changes.iter().enumerate() {
        let mut bad = good.clone();
        change(&mut bad);
        assert!(GmmTrainer::new(bad, &[]).is_err(), "{i}");
    }
}
