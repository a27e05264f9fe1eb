//! Sun and sky against Mitsuba 3's.

use super::scenes::*;
use super::*;

/// Emitter's coordinates to the world.
fn lights(settings: SunSky, to_world: Affine3A) -> Lights {
    let emitter = Emitter::SunSky {
        settings,
        scale: 1.0,
        to_world,
    };
    setup(vec![], vec![emitter]).lights
}

fn settings(sun_direction: Vec3, turbidity: f32, albedo: f32) -> SunSky {
    SunSky {
        sky: true,
        sun: true,
        sun_direction,
        turbidity,
        albedo: Rgb::splat(albedo),
        sky_scale: 1.0,
        sun_scale: 1.0,
        sun_radius_degrees: 0.2679,
        stretch: 1.0,
        z_up: true,
    }
}

#[test]
fn sun_and_sky_are_mitsubas() {
    let mut made: Option<(Vec<f32>, Lights)> = None;
    let (mut worst_sky, mut worst_sun) = (0.0f32, 0.0f32);
    for line in include_str!("../../../tests/vectors/sky.txt").lines() {
        if line.starts_with('#') {
            continue;
        }
        let v: Vec<f32> = line.split(' ').map(|w| w.parse().unwrap()).collect();
        if made.as_ref().is_none_or(|(key, _)| key[..] != v[..5]) {
            let sun = Vec3::new(v[2], v[3], v[4]);
            made = Some((
                v[..5].to_vec(),
                lights(settings(sun, v[0], v[1]), Affine3A::IDENTITY),
            ));
        }
        let lights = &made.as_ref().unwrap().1;
        let dir = Vec3::new(v[5], v[6], v[7]);
        let expected = Rgb::new(v[8], v[9], v[10]).max(Rgb::ZERO);
        let difference = (lights.environment(dir) - expected).abs().max_element();
        if dir == Vec3::new(v[2], v[3], v[4]) {
            // A sun dimmed below a hundredth of what it is in the zenith counts by what it could
            // be.
            worst_sun = worst_sun.max(difference / expected.max_element().max(200.0));
        } else {
            worst_sky = worst_sky.max(difference / expected.max_element().max(1e-6));
        }
    }
    assert!(
        worst_sky < 0.005 && worst_sun < 0.01,
        "{worst_sky} {worst_sun}"
    );
}

/// The sun's irradiance does not depend on the size of its disk, and the lower half is dark.
#[test]
fn a_sun_of_any_size_has_the_same_power() {
    let irradiance = |degrees: f32| {
        let sun = SunSky {
            sky: false,
            sun_radius_degrees: degrees,
            ..settings(Vec3::new(0.0, 0.6, 0.8), 3.0, 0.3)
        };
        let lights = lights(sun, Affine3A::IDENTITY);
        let mut rng = Pcg32::new(3, 3);
        let mut sum = 0.0;
        for _ in 0..20_000 {
            let u = [(); 3].map(|()| rng.next_f32());
            let s = lights.sample(Vec3::ZERO, Vec3::Z, &mut (), u).unwrap();
            sum += f64::from(lights.radiance(&s.incoming).y / s.pdf * s.dir.z);
        }
        sum / 20_000.0
    };
    let natural = irradiance(0.2679);
    for degrees in [0.0, 0.01, 2.0] {
        assert!((irradiance(degrees) / natural - 1.0).abs() < 0.002);
    }
}

/// Mitsuba 0.x has +y up; a turned emitter turns the sky; a stretched one reaches below the
/// horizon.
#[test]
fn orientation_and_stretch() {
    let sun = Vec3::new(0.3, 0.5, 0.6).normalize();
    let z = lights(settings(sun, 3.0, 0.2), Affine3A::IDENTITY);
    let swap = |d: Vec3| Vec3::new(d.y, d.z, d.x);
    let y_up = |stretch: f32| SunSky {
        z_up: false,
        stretch,
        sun: false,
        ..settings(swap(sun), 3.0, 0.2)
    };
    let y = lights(y_up(1.0), Affine3A::IDENTITY);
    let turn = Affine3A::from_rotation_y(0.7);
    let turned = lights(y_up(1.0), turn);
    let stretched = lights(y_up(1.5), Affine3A::IDENTITY);
    for d in [Vec3::new(0.1, -0.5, 0.4), Vec3::new(-0.6, 0.2, 0.1)] {
        let d = d.normalize();
        // Their units differ in the fourth digit.
        let (a, b) = (z.environment(d), y.environment(swap(d)));
        assert!((a - b).length() < 3e-3 * a.length(), "{a} {b}");
        let c = turned.environment(turn.transform_vector3(swap(d)));
        assert!((b - c).length() < 2e-3 * b.length(), "{b} {c}");
    }
    let below = Vec3::new(0.9, -0.2, 0.1).normalize();
    assert!(y.environment(below) == Rgb::ZERO && stretched.environment(below).x > 0.0);
    assert!(y.environment_pdf(Vec3::ZERO, Vec3::ZERO, below).1 == 0.0);
    let night = SunSky {
        sun_direction: Vec3::NEG_Y,
        ..y_up(1.0)
    };
    assert!(!lights(night, Affine3A::IDENTITY).has_environment());
}
