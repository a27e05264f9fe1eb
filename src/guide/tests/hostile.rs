//! Extremes: one point, far origins, wild powers, empty fields.

use super::synthetic::{integral, point_light, square, unit_box};
use crate::guide::{FractionRecord, Fractions, LightChoice, ModelKind, Photon, Settings, Trainer};
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

fn photon(position: Vec3, rng: &mut Pcg32) -> Photon {
    Photon {
        position,
        direction: crate::math::warp::uniform_sphere(square(rng)),
        power: Rgb::ONE,
        distance: 1.0,
        normal: Vec3::Z,
    }
}

fn check(settings: Settings, place: impl Fn(&mut Pcg32) -> Vec3) -> Trainer {
    let mut rng = Pcg32::new(12, 1);
    let mut t = Trainer::build(settings).unwrap();
    for _ in 0..12 {
        let p: Vec<_> = (0..20_000)
            .map(|_| photon(place(&mut rng), &mut rng))
            .collect();
        t.train(&p, 20_000);
        t.refine();
        assert!(t.bytes() <= t.settings().memory);
        for p in &p[..200] {
            let key = t.space.grid.key(p.position, p.normal);
            let leaf = &t.space.nodes[t.space.leaf_below(0, key).0 as usize];
            assert!(leaf.level <= t.space.grid.max_level);
        }
    }
    t
}

#[test]
fn photons_at_one_point_on_a_line_and_on_corners_stay_within_limits() {
    let settings = Settings {
        memory: 2 << 20,
        ..unit_box()
    };
    check(settings.clone(), |_| Vec3::splat(0.3));
    check(settings.clone(), |r| {
        Vec3::new(0.3, 0.3, 0.3 + 1e-6 * r.next_f32())
    });
    check(settings.clone(), |r| {
        let corner = |u: u32| (u % 17) as f32 / 16.0;
        Vec3::new(
            corner(r.next_u32()),
            corner(r.next_u32()),
            corner(r.next_u32()),
        )
    });
    // Outside the bounds: clamped into boundary cells.
    let t = check(settings, |r| Vec3::splat(r.next_f32() * 4e9 - 2e9));
    let field = t.freeze();
    for x in [Vec3::splat(f32::MAX), Vec3::splat(-1e30), Vec3::NAN] {
        let local = field.at(x, Some(Vec3::NAN), Rgb::ONE);
        let s = local.sample(Vec2::splat(0.5), Vec2::splat(0.5));
        assert!(s.pdf > 0.0 && s.direction.is_finite());
    }
}

#[test]
fn cells_keep_64_ulp_far_from_the_origin() {
    for (offset, most) in [(0.0f32, 20u8), (1e3, 12), (1e6, 2), (1e9, 0)] {
        let min = Vec3::splat(offset);
        let settings = Settings {
            memory: 4 << 20,
            ..Settings::new(min, min + 10.0)
        };
        let t = check(settings, |r| {
            min + 10.0 * Vec3::new(r.next_f32(), r.next_f32(), 0.5)
        });
        assert!(
            t.space.grid.max_level <= most,
            "{offset}: {}",
            t.space.grid.max_level
        );
    }
}

#[test]
fn the_scale_of_powers_and_of_scenes_does_not_matter() {
    let density = |power: f32, size: f32| {
        let settings = Settings::new(Vec3::ZERO, Vec3::splat(size));
        let mut t = Trainer::build(settings).unwrap();
        for i in 0..3 {
            let mut p = point_light(Vec3::new(0.5, 0.5, 0.7), 20_000, i);
            for p in &mut p {
                p.power *= power;
                p.position *= size;
                p.distance *= size;
            }
            t.train(&p, 20_000);
            t.refine();
        }
        let field = t.freeze();
        let local = field.at(Vec3::new(0.4, 0.3, 0.25) * size, Some(Vec3::Z), Rgb::ONE);
        local.pdf(Vec3::new(0.1, 0.2, 0.45).normalize())
    };
    // Powers of two scale every sum exactly.
    let reference = density(1.0, 1.0);
    assert!(reference > 0.5);
    for exponent in [-90, -30, 30, 90] {
        assert_eq!(density(2f32.powi(exponent), 1.0), reference, "2^{exponent}");
    }
    for size in [2f32.powi(-20), 2f32.powi(20)] {
        let d = density(1.0, size);
        assert!(
            (d / reference - 1.0).abs() < 1e-3,
            "{size}: {d} {reference}"
        );
    }
    for power in [1e-30f32, 1e30] {
        let d = density(power, 1.0);
        assert!(
            (d / reference - 1.0).abs() < 0.05,
            "{power}: {d} {reference}"
        );
    }
}

#[test]
fn a_firefly_does_not_blind_the_field() {
    let mut rng = Pcg32::new(3, 3);
    let mut p: Vec<_> = (0..10_000)
        .map(|_| photon(Vec3::splat(0.5), &mut rng))
        .collect();
    p[77].power = Rgb::splat(1e30);
    let mut t = Trainer::build(unit_box()).unwrap();
    t.train(&p, 10_000);
    let field = t.freeze();
    let local = field.at(Vec3::splat(0.5), None, Rgb::ONE);
    assert!(local.pdf(-p[77].direction) >= 0.009 / (4.0 * std::f32::consts::PI));
    assert!(local.irradiance().is_finite());
}

#[test]
fn an_empty_field_is_uniform() {
    for model in ModelKind::ALL {
        let settings = Settings {
            model: *model,
            ..unit_box()
        };
        let mut t = Trainer::build(settings).unwrap();
        t.train(&[], 1000);
        t.refine();
        let field = t.freeze();
        let local = field.at(Vec3::ONE, Some(Vec3::Z), Rgb::ONE);
        assert!(!local.has_light());
        let s = local.sample(Vec2::splat(0.7), Vec2::new(0.2, 0.9));
        assert_eq!(s.pdf, 0.25 / std::f32::consts::PI);
        assert!((integral(1000, |w| local.pdf(w)) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn bad_settings_are_refused() {
    let refused = |s: Settings| Trainer::build(s).is_err();
    let good = unit_box();
    assert!(refused(Settings::new(Vec3::ONE, Vec3::ZERO)));
    assert!(refused(Settings::new(Vec3::NAN, Vec3::ONE)));
    assert!(refused(Settings {
        max_space_level: 21,
        ..good.clone()
    }));
    assert!(refused(Settings {
        defensive: 0.0,
        ..good.clone()
    }));
    assert!(refused(Settings {
        clamp: f32::NAN,
        ..good.clone()
    }));
    assert!(refused(Settings {
        smoothing: -1.0,
        ..good.clone()
    }));
    // A scene of one point is a scene.
    assert!(!refused(Settings::new(Vec3::ONE, Vec3::ONE)));
}

#[test]
fn cells_that_no_camera_meets_are_not_refined() {
    let photons = |seed| point_light(Vec3::new(0.5, 0.5, 0.3), 50_000, seed);
    let mut t = Trainer::build(unit_box()).unwrap();
    let seen = crate::guide::SurfacePoint {
        position: Vec3::new(0.45, 0.45, 0.25),
        normal: Vec3::Z,
    };
    t.set_importance(&[seen], 1);
    for i in 0..6 {
        t.train(&photons(i), 50_000);
        t.refine();
    }
    let level = |x: Vec3| {
        t.space.nodes[t.space.leaf_below(0, t.space.grid.key(x, Vec3::Z)).0 as usize].level
    };
    assert!(level(Vec3::new(0.45, 0.45, 0.25)) >= 3);
    assert_eq!(level(Vec3::new(0.55, 0.55, 0.25)), 1);
}

/// Two cells' worth of truth: where the field is right the fraction rises, where it is wrong it
/// falls.
#[test]
fn fractions_learn_which_strategy_pays() {
    let mut t = Trainer::build(unit_box()).unwrap();
    for i in 0..6 {
        t.train(&point_light(Vec3::new(0.5, 0.5, 0.3), 50_000, i), 50_000);
        t.refine();
    }
    let field = t.freeze();
    let (good, bad) = (Vec3::new(0.1, 0.1, 0.25), Vec3::new(0.9, 0.9, 0.25));
    assert_ne!(field.cell(good, Vec3::Z), field.cell(bad, Vec3::Z));
    let record = |x: Vec3, guide_pdf: f32, bsdf_pdf: f32| FractionRecord {
        position: x,
        normal: Vec3::Z,
        value: Rgb::ONE,
        pdf: 0.5 * (guide_pdf + bsdf_pdf),
        guide_pdf,
        bsdf_pdf,
        light: 0.0,
        light_probability: 1.0,
        light_choice: LightChoice::NONE,
        reflected: 1.0,
    };
    let mut records = Vec::new();
    for _ in 0..500 {
        records.push(record(good, 2.0, 0.1));
        records.push(record(bad, 0.1, 2.0));
        records.push(record(bad, f32::NAN, 1.0));
    }
    let mut f = Fractions::new(&field);
    assert_eq!(f.chances(0).field, 0.5);
    f.update(&field, &records);
    let at = |x| f.chances(field.cell(x, Vec3::Z)).field;
    assert!(at(good) > 0.8 && at(good) <= 0.9, "{}", at(good));
    assert!(at(bad) < 0.2 && at(bad) >= 0.1, "{}", at(bad));
    assert_eq!(f.chances(u32::MAX).field, 0.5);
    // In parts, too, some of them empty.
    let (first, rest) = records.split_at(601);
    let mut again = Fractions::new(&field);
    again.update_in_parts(&field, &[&[], first, &[], rest, &[]]);
    assert_eq!(f, again);
}

#[test]
fn fields_are_shared_between_threads() {
    fn shared<T: Send + Sync + Clone>() {}
    shared::<crate::guide::Field>();
    shared::<Trainer>();
    shared::<Fractions>();
}
