//! S6, S7, S21, S23: as much light comes out as goes in.

use crate::scenes::{backends, field_of, plain_box, seed, silver};
use crate::support::{Built, SceneMaker, film_mean, grey, inside_of_cube, settings};
use crate::table::Table;
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::Material;
use twintree::bsdf::material::{
    Dielectric, Diffuse, Distribution, Null, RoughConductor, RoughDielectric, Roughness,
    ThinDielectric,
};
use twintree::film::Film;
use twintree::integrate::PathSettings;
use twintree::light::Emitter;
use twintree::math::{Affine3A, DVec3, Rgb, Vec3};

/// No path ends before it leaves.
fn to_the_end() -> PathSettings {
    PathSettings {
        rr_depth: u32::MAX,
        max_depth: 1000,
        ..settings()
    }
}

/// A body of that material in constant light, without roulette: a lossless path carries its 1 to
/// the end.
fn furnace(material: Material, backend: Backend) -> (f64, f64, Built) {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -3.0), Vec3::ZERO, 45.0, 16);
    let body = maker.material(material);
    maker.sphere(Vec3::ZERO, 1.0, body, None, false);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    let built = maker.build(backend);
    let (film, _) = built.render(&to_the_end(), 64);
    assert_eq!(film.invalid_samples(), 0);
    let (mean, error) = film_mean(&film);
    (mean, error, built)
}

#[test]
fn s06_lossless_bodies_vanish() {
    let glass = |eta| {
        Material::Dielectric(Dielectric {
            eta,
            specular_reflectance: grey(1.0),
            specular_transmittance: grey(1.0),
        })
    };
    let thin = Material::ThinDielectric(ThinDielectric {
        eta: 1.5,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    });
    let white = Material::Diffuse(Diffuse {
        reflectance: grey(1.0),
    });
    let list = [
        ("diffuse", white),
        ("mirror", silver(1.0)),
        ("glass", glass(1.5)),
        ("glass, index 1e3", glass(1e3)),
        ("glass, index 1 + 1e-7", glass(1.0 + f32::EPSILON)),
        ("thin glass", thin),
        ("null", Material::Null(Null)),
    ];
    let mut table = Table::default();
    for (name, backend) in backends() {
        for (body, material) in &list {
            let (mean, error, built) = furnace(material.clone(), backend);
            let what = format!("{body} in constant light: |mean - 1|");
            let limit = 1e-5 + 4.0 * error;
            table.hold("S6", &what, name, limit.min(2e-3), (mean - 1.0).abs());
            let guide = field_of(&built);
            let (film, _) = built.render_guided(&to_the_end(), 64, Some(&guide));
            let who = format!("{name}, guided");
            table.finite("S6", &what, &who, &film);
            let (mean, error) = film_mean(&film);
            // Where every sample is 1 the error is rounding alone.
            let z = (mean - 1.0).abs() / (error + 2.5e-6);
            table.hold("S6", &format!("{what}, standard errors"), &who, 4.0, z);
        }
    }
}

/// Mean of `worth` over the normals of GGX facets of roughness `alpha` that are seen at the angle
/// of cosine `mu` (Heitz 2018, "Sampling the GGX distribution of visible normals"), by a lattice in
/// `f64`. It is given the direction of view and the normal.
fn over_visible_normals(alpha: f64, mu: f64, worth: impl Fn(DVec3, DVec3) -> f64) -> f64 {
    const N: u32 = 400;
    let wo = DVec3::new((1.0 - mu * mu).sqrt(), 0.0, mu);
    let stretched = DVec3::new(alpha * wo.x, 0.0, wo.z).normalize();
    let side = DVec3::Y;
    let front = stretched.cross(side);
    let mut sum = 0.0;
    for i in 0..N * N {
        let u = (f64::from(i % N) + 0.5) / f64::from(N);
        let v = (f64::from(i / N) + 0.5) / f64::from(N);
        let (sin, cos) = (v * std::f64::consts::TAU).sin_cos();
        let (x, y) = (u.sqrt() * cos, u.sqrt() * sin);
        let s = 0.5 * (1.0 + stretched.z);
        let y = (1.0 - s) * (1.0 - x * x).sqrt() + s * y;
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let m = side * x + front * y + stretched * z;
        let m = DVec3::new(alpha * m.x, alpha * m.y, m.z.max(1e-300)).normalize();
        sum += worth(wo, m);
    }
    sum / f64::from(N * N)
}

/// Smith's shadowing of a direction of that cosine.
fn g1(alpha: f64, cos: f64) -> f64 {
    let tan = (1.0 - cos * cos) / (cos * cos);
    2.0 / (1.0 + (1.0 + alpha * alpha * tan).sqrt())
}

/// What a mirror that reflects everything once shows of a white world.
fn mirror_shows(alpha: f64, mu: f64) -> f64 {
    over_visible_normals(alpha, mu, |wo, m| {
        let wi = m * (2.0 * wo.dot(m)) - wo;
        if wi.z > 0.0 { g1(alpha, wi.z) } else { 0.0 }
    })
}

/// What an interface of index `eta`, seen from outside, shows of a world that is white on both
/// sides: what comes through it is spread out by the square of the index.
fn interface_shows(eta: f64, alpha: f64, mu: f64) -> f64 {
    over_visible_normals(alpha, mu, |wo, m| {
        let o = wo.dot(m);
        let t = (1.0 - (1.0 - o * o) / (eta * eta)).max(0.0).sqrt();
        let parallel = (eta * o - t) / (eta * o + t);
        let across = (o - eta * t) / (o + eta * t);
        let r = 0.5 * (parallel * parallel + across * across);
        let mirrored = m * (2.0 * o) - wo;
        let through = m * (o / eta - t) - wo / eta;
        let up = if mirrored.z > 0.0 {
            g1(alpha, mirrored.z)
        } else {
            0.0
        };
        let down = if through.z < 0.0 {
            g1(alpha, through.z)
        } else {
            0.0
        };
        r * up + (1.0 - r) * down / (eta * eta)
    })
}

/// A sheet of that material in a white world, seen at so many degrees from its normal.
fn sheet(material: Material, degrees: f32, backend: Backend) -> Film {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let eye = Vec3::new(3.0 * sin, 0.0, 3.0 * cos);
    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 0.01, 8);
    let material = maker.material(material);
    let sheet = maker.exact(
        AnalyticKind::Rectangle,
        Affine3A::from_scale(Vec3::splat(9.0)),
    );
    maker.shape(sheet, material, None, false);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    maker.build(backend).render(&seed(1), 1024).0
}

fn ggx(alpha: f32) -> Roughness {
    Roughness {
        distribution: Distribution::Ggx,
        alpha_u: grey(alpha),
        alpha_v: grey(alpha),
    }
}

#[test]
fn s06_rough_surfaces_keep_what_single_scattering_keeps() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        for alpha in [1e-8f32, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0] {
            for degrees in [0.0f32, 60.0, 85.0] {
                let (a, mu) = (f64::from(alpha), f64::from(degrees).to_radians().cos());
                let mirror = Material::RoughConductor(RoughConductor {
                    eta: grey(0.0),
                    k: grey(1.0),
                    roughness: ggx(alpha),
                    specular_reflectance: grey(1.0),
                });
                let glass = Material::RoughDielectric(RoughDielectric {
                    eta: 1.5,
                    roughness: ggx(alpha),
                    specular_reflectance: grey(1.0),
                    specular_transmittance: grey(1.0),
                });
                for (what, material, truth) in [
                    ("mirror", mirror, mirror_shows(a, mu)),
                    ("glass", glass, interface_shows(1.5, a, mu)),
                ] {
                    let film = sheet(material, degrees, backend);
                    let (mean, error) = film_mean(&film);
                    let what =
                        format!("GGX {what} {alpha:e} at {degrees} degrees: |mean - {truth:.4}|");
                    table.finite("S6", &what, name, &film);
                    let limit = (4.0 * error).clamp(5e-4, 5e-3);
                    table.hold("S6", &what, name, limit, (mean - truth).abs());
                }
            }
        }
    }
}

/// A ball of rough glass loses by single scattering, and gains nothing however often light crosses
/// it.
#[test]
fn s06_rough_glass_gains_nothing() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        for alpha in [1e-8f32, 1e-3, 1e-2, 0.1, 1.0] {
            let glass = Material::RoughDielectric(RoughDielectric {
                eta: 1.5,
                roughness: ggx(alpha),
                specular_reflectance: grey(1.0),
                specular_transmittance: grey(1.0),
            });
            let (mean, _, _) = furnace(glass, backend);
            let what = format!("ball of rough glass {alpha:e}: gain");
            table.hold("S6", &what, name, 5e-3, mean - 1.0);
        }
    }
}

/// Closed rooms whose radiance is 1 everywhere: glow 1/2 and albedo 1/2; a point light of intensity
/// pi in the middle of a sphere of albedo 1/2.
fn rooms_of_one(backend: Backend) -> Vec<(&'static str, Built)> {
    let maker = || SceneMaker::new(Vec3::new(0.3, 0.1, 0.1), Vec3::ONE, 70.0, 16);
    let mut cube = maker();
    let wall = cube.diffuse(0.5);
    cube.shape(inside_of_cube(1.0), wall, Some(0.5), false);
    let mut sphere = maker();
    let wall = sphere.diffuse(0.5);
    sphere.sphere(Vec3::ZERO, 1.0, wall, Some(0.5), true);
    let mut point = maker();
    let wall = point.diffuse(0.5);
    point.sphere(Vec3::ZERO, 1.0, wall, None, true);
    point.emitter(Emitter::Point {
        position: Vec3::ZERO,
        intensity: Rgb::splat(std::f32::consts::PI),
    });
    vec![
        ("glowing cube", cube.build(backend)),
        ("glowing sphere", sphere.build(backend)),
        ("point light in a sphere", point.build(backend)),
    ]
}

fn closed_forms(spp: u64, limit: f64) {
    let mut table = Table::default();
    for (name, backend) in backends() {
        for (room, built) in rooms_of_one(backend) {
            let what = format!("{room}, {} samples: |mean - 1|", spp * 256);
            let (film, _) = built.render(&settings(), spp);
            table.finite("S7", &what, name, &film);
            table.hold("S7", &what, name, limit, (film_mean(&film).0 - 1.0).abs());
            let guide = field_of(&built);
            let (film, _) = built.render_guided(&settings(), spp, Some(&guide));
            let who = format!("{name}, guided");
            table.finite("S7", &what, &who, &film);
            table.hold("S7", &what, &who, limit, (film_mean(&film).0 - 1.0).abs());
        }
    }
}

#[test]
fn s07_closed_forms() {
    closed_forms(512, 2e-3);
}

#[test]
#[ignore = "slow: twelve million samples"]
fn s07_closed_forms_by_a_million_samples() {
    closed_forms(4096, 1e-3);
}

/// Mirrors all around that glow: radiance glow / (1 - reflectance) = 1.
fn hall_of_mirrors(reflectance: f32, backend: Backend) -> Built {
    let mut maker = SceneMaker::new(Vec3::new(0.3, 0.1, 0.1), Vec3::ONE, 70.0, 4);
    let mirror = maker.material(silver(reflectance));
    maker.shape(inside_of_cube(1.0), mirror, Some(1.0 - reflectance), false);
    maker.build(backend)
}

fn endless(max_depth: u32, spp: u64) {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let hall = hall_of_mirrors(0.9375, backend);
        let path = |rr_depth| PathSettings {
            max_depth,
            rr_depth,
            ..settings()
        };
        let what = format!("mirrors, depth {max_depth}, no roulette: |mean - 1|");
        let (film, _) = hall.render(&path(u32::MAX), spp);
        table.finite("S21", &what, name, &film);
        // Sums of powers of the reflectance, rounded: 1e-5 of them.
        table.hold("S21", &what, name, 1e-5, (film_mean(&film).0 - 1.0).abs());
        let what = format!("mirrors, depth {max_depth}, roulette: |mean - 1| in standard errors");
        let (film, _) = hall.render(&path(5), 4096);
        table.finite("S21", &what, name, &film);
        let (mean, error) = film_mean(&film);
        table.hold("S21", &what, name, 4.0, (mean - 1.0).abs() / error);
        let guide = field_of(&hall);
        let (film, _) = hall.render_guided(&path(5), 4096, Some(&guide));
        let who = format!("{name}, guided");
        table.finite("S21", &what, &who, &film);
        let (mean, error) = film_mean(&film);
        table.hold("S21", &what, &who, 4.0, (mean - 1.0).abs() / error);
    }
}

#[test]
fn s21_endless_paths() {
    endless(5_000, 2);
}

#[test]
#[ignore = "slow: ten million bounces"]
fn s21_endless_paths_of_a_hundred_thousand_edges() {
    endless(100_000, 4);
}

/// Walls of albedo 1e-20 that glow with 1: throughputs of 1e-40 and 1e-60 are below the smallest
/// normal number, and radiance is 1 to the last bit.
#[test]
fn s23_denormals() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let mut maker = SceneMaker::new(Vec3::new(0.3, 0.1, 0.1), Vec3::ONE, 70.0, 8);
        let wall = maker.diffuse(1e-20);
        maker.shape(inside_of_cube(1.0), wall, Some(1.0), false);
        let built = maker.build(backend);
        let path = PathSettings {
            rr_depth: u32::MAX,
            ..seed(1)
        };
        let (film, _) = built.render(&path, 16);
        let what = "walls of albedo 1e-20: |mean - 1|";
        table.finite("S23", what, name, &film);
        table.hold("S23", what, name, 1e-6, (film_mean(&film).0 - 1.0).abs());
    }
}

/// Time of a sample among products below the smallest normal number, over that of ordinary ones.
#[test]
#[ignore = "slow: measures time, for which the machine must be quiet"]
fn s23_denormals_cost_no_time() {
    let mut table = Table::default();
    for (name, backend) in backends() {
        let path = PathSettings {
            rr_depth: u32::MAX,
            ..seed(1)
        };
        let time = |radiance: f32| {
            let built = plain_box(0.5, radiance, backend);
            let runs = (0..7).map(|_| built.render(&path, 256).1.elapsed.as_secs_f64());
            runs.fold(f64::INFINITY, f64::min)
        };
        let ratio = time(1e-38) / time(1.0);
        table.hold(
            "S23",
            "radiance 1e-38: time, over that of radiance 1",
            name,
            1.5,
            ratio,
        );
    }
}
