//! Scenes whose image is known without rendering them.

mod support;

use support::{SceneMaker, grey, inside_of_cube, settings};
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::Material;
use twintree::bsdf::material::{Conductor, Dielectric, Null, ThinDielectric};
use twintree::light::Emitter;
use twintree::math::{Affine3A, Rgb, Vec3};

fn backends() -> Vec<Backend> {
    let mut list = vec![Backend::default()];
    if cfg!(feature = "embree") {
        list.push(Backend::Obvhs);
    }
    list
}

/// The mean must be `truth` within 4 standard errors, and the standard error small enough to see
/// 0.5 %.
fn expect(what: &str, truth: f64, (mean, error): (f64, f64)) {
    println!("{what}: {mean:.5} +- {error:.5}, truth {truth}");
    assert!(
        error < 0.002 * truth.max(0.1),
        "{what}: too noisy to tell: {error}"
    );
    assert!(
        (mean - truth).abs() < 4.0 * error + 1e-5 * truth,
        "{what}: {mean} +- {error} is not {truth}"
    );
}

/// Inside a closed surface of albedo 1/2 that glows with 1/2, every radiance is 1/2 / (1 - 1/2) =
/// 1.
#[test]
fn glowing_closed_box_and_sphere_show_one_everywhere() {
    for backend in backends() {
        let mut maker = SceneMaker::new(Vec3::new(0.1, 0.2, 0.3), Vec3::ONE, 80.0, 16);
        let wall = maker.diffuse(0.5);
        maker.shape(inside_of_cube(1.0), wall, Some(0.5), false);
        expect("box", 1.0, maker.build(backend).mean(&settings(), 256));

        let mut maker = SceneMaker::new(Vec3::new(0.1, 0.2, 0.3), Vec3::ONE, 80.0, 16);
        let wall = maker.diffuse(0.5);
        maker.sphere(Vec3::ZERO, 1.0, wall, Some(0.5), true);
        expect("sphere", 1.0, maker.build(backend).mean(&settings(), 256));
    }
}

/// A point light of intensity pi in the middle of a unit sphere of albedo 1/2: direct radiance 1/2,
/// in all 1.
#[test]
fn point_light_in_a_sphere_shows_one() {
    for backend in backends() {
        let mut maker = SceneMaker::new(Vec3::new(0.3, 0.0, 0.1), Vec3::X, 60.0, 16);
        let wall = maker.diffuse(0.5);
        maker.sphere(Vec3::ZERO, 1.0, wall, None, true);
        maker.emitter(Emitter::Point {
            position: Vec3::ZERO,
            intensity: Rgb::splat(std::f32::consts::PI),
        });
        expect(
            "point light",
            1.0,
            maker.build(backend).mean(&settings(), 512),
        );
    }
}

/// A convex body of albedo a in constant light 1 shows a; of albedo 1 it vanishes.
#[test]
fn convex_body_in_constant_light_shows_its_albedo() {
    for backend in backends() {
        for albedo in [0.25f32, 1.0] {
            let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 20.0, 16);
            let body = maker.diffuse(albedo);
            maker.sphere(Vec3::ZERO, 1.0, body, None, false);
            maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
            let built = maker.build(backend);
            expect(
                "sphere in constant light",
                f64::from(albedo),
                built.mean(&settings(), 256),
            );
        }
    }
}

/// Everything lossless vanishes in constant light: glass, mirror, thin glass, rough glass within
/// its losses.
#[test]
fn white_furnace_hides_lossless_bodies() {
    for backend in backends() {
        let materials = [
            Material::Dielectric(Dielectric {
                eta: 1.5,
                specular_reflectance: grey(1.0),
                specular_transmittance: grey(1.0),
            }),
            Material::ThinDielectric(ThinDielectric {
                eta: 1.5,
                specular_reflectance: grey(1.0),
                specular_transmittance: grey(1.0),
            }),
            Material::Conductor(Conductor {
                eta: grey(0.0),
                k: grey(1.0),
                specular_reflectance: grey(1.0),
            }),
            Material::Null(Null),
        ];
        for material in materials {
            let name = format!("{material:?}");
            let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 45.0, 16);
            let body = maker.material(material);
            maker.sphere(Vec3::ZERO, 1.0, body, None, false);
            maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
            let mut path = settings();
            // Without roulette a lossless path carries its 1 to the end: the image is exact.
            path.rr_depth = u32::MAX;
            path.max_depth = 1000;
            let (mean, _) = maker.build(backend).mean(&path, 16);
            assert!((mean - 1.0).abs() < 1e-3, "{name}: {mean}");
        }
    }
}

/// Irradiance under the middle of a disk of radius r at height h: pi L r^2 / (r^2 + h^2).
#[test]
fn disk_light_over_a_floor_matches_its_form_factor() {
    for backend in backends() {
        let (radius, height, radiance, albedo) = (0.7f32, 1.3f32, 2.0f32, 0.6f32);
        let mut maker = SceneMaker::new(Vec3::new(0.0, 0.5, -0.5), Vec3::ZERO, 0.05, 8);
        let floor = maker.diffuse(albedo);
        let black = maker.diffuse(0.0);
        let flat = Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let ground = maker.exact(
            AnalyticKind::Rectangle,
            flat * Affine3A::from_scale(Vec3::splat(10.0)),
        );
        maker.shape(ground, floor, None, false);
        let down = Affine3A::from_translation(Vec3::Y * height)
            * Affine3A::from_rotation_x(std::f32::consts::FRAC_PI_2)
            * Affine3A::from_scale(Vec3::splat(radius));
        let lamp = maker.exact(AnalyticKind::Disk, down);
        maker.shape(lamp, black, Some(radiance), false);
        let truth = albedo * radiance * radius * radius / (radius * radius + height * height);
        expect(
            "disk",
            f64::from(truth),
            maker.build(backend).mean(&settings(), 4096),
        );
    }
}

/// Irradiance beside a sphere of radius r that touches the floor, at distance d from its centre:
/// all of it lies above the horizon, so pi L (r / d)^2 cos, with cos = r / d. Most of its light
/// arrives at a graze.
#[test]
fn a_lamp_that_touches_the_floor_lights_it_up_to_the_touch() {
    for backend in backends() {
        let (radius, aside, radiance, albedo) = (0.05f32, 0.062f32, 2.0f32, 0.6f32);
        let spot = Vec3::new(aside, 2.0, 0.0);
        let mut maker = SceneMaker::new(spot + Vec3::new(0.0, 0.2, 0.05), spot, 0.3, 8);
        let floor = maker.diffuse(albedo);
        let black = maker.diffuse(0.0);
        let flat = Affine3A::from_translation(Vec3::Y * 2.0)
            * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2);
        let ground = maker.exact(AnalyticKind::Rectangle, flat);
        maker.shape(ground, floor, None, false);
        let center = Vec3::new(0.0, 2.0 + radius, 0.0);
        maker.sphere(center, radius, black, Some(radiance), false);
        let truth = albedo * radiance * (radius / aside.hypot(radius)).powi(3);
        let mean = maker.build(backend).mean(&settings(), 8192);
        expect("touching lamp", f64::from(truth), mean);
    }
}

/// A mask of opacity 0.3 over a black wall in constant light lets 0.7 through, for camera and
/// shadow rays alike.
#[test]
fn masks_let_their_share_through() {
    for backend in backends() {
        let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 10.0, 16);
        let black = maker.diffuse(0.0);
        let veil = maker.material(Material::Mask {
            opacity: grey(0.3),
            inner: black,
        });
        let sheet = maker.exact(
            AnalyticKind::Rectangle,
            Affine3A::from_scale(Vec3::splat(5.0)),
        );
        maker.shape(sheet, veil, None, false);
        maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
        expect("mask", 0.7, maker.build(backend).mean(&settings(), 4096));
    }
}
