//! Suns and lamps behind glass and in mirrors: aiming at them changes the noise, never the mean.

mod support;

use support::{Built, SceneMaker, film_mean, grey, how};
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::material::{Conductor, Dielectric, Plastic};
use twintree::film::Film;
use twintree::guide::ModelKind;
use twintree::integrate::camera_sample::PathNumber;
use twintree::integrate::debug::inspect::trace_sample;
use twintree::integrate::guiding::Guide;
use twintree::integrate::manifold::{ManifoldSampling, find_chains};
use twintree::integrate::training::{garbage, learn};
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::light::{Emitter, SunSky};
use twintree::math::{Affine3A, Quat, Rgb, Vec3};
use twintree::photon::schedule::Budget;

/// Photons for chains as for an image of two million samples.
const BUDGET: Budget = Budget::AsNeeded {
    samples: 1 << 21,
    time: None,
};

/// A floor in the sun, with a ball of glass, one of metal and one of varnish over it, all moved by
/// `aside`. The larger the sun, the easier paths meet it by themselves.
fn balls(aside: f32, sun_degrees: Option<f32>) -> Built {
    lit_balls(aside, |maker| {
        if let Some(degrees) = sun_degrees {
            maker.emitter(sun(degrees));
        }
    })
}

/// The same in the light of a lamp: a ball, and a disk that shines from one side.
fn lamplit_balls(aside: f32) -> Built {
    lit_balls(aside, |maker| {
        let black = maker.diffuse(0.0);
        let bulb = Vec3::new(0.9, 2.7, 0.6);
        maker.sphere(bulb, 0.25, black, Some(20.0), false);
        let facing = Vec3::new(0.5, -1.0, 0.2).normalize();
        let place = Affine3A::from_translation(Vec3::new(-1.2, 2.0, -0.3))
            * Affine3A::from_quat(Quat::from_rotation_arc(Vec3::Z, facing))
            * Affine3A::from_scale(Vec3::splat(0.3));
        let disk = maker.exact(AnalyticKind::Disk, place);
        maker.shape(disk, black, Some(25.0), false);
    })
}

/// A sun that is the same at a point of the floor whatever its size.
fn sun(degrees: f32) -> Emitter {
    Emitter::SunSky {
        settings: SunSky {
            sky: false,
            sun: true,
            sun_direction: Vec3::new(0.3, 0.9, 0.2).normalize(),
            turbidity: 3.0,
            albedo: Rgb::splat(0.2),
            sky_scale: 1.0,
            sun_scale: 20.0 / (degrees * degrees),
            sun_radius_degrees: degrees,
            stretch: 1.0,
            z_up: false,
        },
        scale: 1.0,
        to_world: Affine3A::IDENTITY,
    }
}

fn lit_balls(aside: f32, light: impl FnOnce(&mut SceneMaker)) -> Built {
    let eye = Vec3::new(0.0, 2.4, -1.2);
    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 50.0, 32);
    let floor = maker.diffuse(0.5);
    let up = Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(3.0));
    let ground = maker.exact(AnalyticKind::Rectangle, up);
    maker.shape(ground, floor, None, false);
    let glass = maker.material(Dielectric {
        eta: 1.5,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    });
    maker.sphere(Vec3::new(-0.4 + aside, 0.45, 0.1), 0.35, glass, None, false);
    let metal = maker.material(Conductor {
        eta: grey(0.2),
        k: grey(3.9),
        specular_reflectance: grey(1.0),
    });
    maker.sphere(Vec3::new(0.4 + aside, 0.5, 0.3), 0.3, metal, None, false);
    let varnish = maker.material(Plastic {
        eta: 1.5,
        diffuse_reflectance: grey(0.5),
        specular_reflectance: grey(1.0),
        nonlinear: false,
    });
    maker.sphere(
        Vec3::new(0.1 + aside, 0.25, -0.5),
        0.25,
        varnish,
        None,
        false,
    );
    maker.emitter(Emitter::Constant {
        radiance: Rgb::splat(0.1),
    });
    light(&mut maker);
    maker.build(Backend::default())
}

fn path(seed: u64) -> PathSettings {
    PathSettings {
        max_depth: 8,
        guided: GuidedSettings {
            manifold: true,
            ..GuidedSettings::PLAIN
        },
        seed,
        ..support::settings()
    }
}

/// A field that knows nothing, and aims.
fn aiming(scene: &Built, at: &Built, chance: f32) -> Guide {
    let mut guide = garbage(&scene.scene, ModelKind::Gauss, 9);
    guide.manifold = find_chains(&at.view(&path(3), None), BUDGET).map(ManifoldSampling::new);
    assert!(guide.manifold.is_some(), "nothing to aim at");
    guide.set_manifold_rate(chance);
    guide
}

/// A field that was learned from photons, and aims.
fn learned(scene: &Built) -> Guide {
    let path = path(3);
    let learned = learn(&scene.view(&path, None), &how(100_000, 0));
    learned.expect("a field is learned").guide
}

/// Block means of two renders agree, and both are precise enough for that to say something.
fn agree(what: &str, a: &Film, b: &Film) {
    support::agree(what, a, b);
    let ((_, ea), (mean, eb)) = (film_mean(a), film_mean(b));
    assert!(
        ea.hypot(eb) < 0.003 * mean,
        "{what}: too noisy to see one per cent"
    );
}

#[test]
fn whoever_aims_and_at_whatever_finds_the_unguided_mean() {
    let scene = balls(0.0, Some(4.0));
    let (plain, _) = scene.render(&path(1), 8192);
    let elsewhere = balls(0.15, Some(4.0));
    for (what, at, chance) in [
        ("always", &scene, 1.0),
        ("seldom", &scene, 0.1),
        ("with seeds of another scene", &elsewhere, 1.0),
    ] {
        let guide = aiming(&scene, at, chance);
        let (film, _) = scene.render_guided(&path(2), 3072, Some(&guide));
        agree(what, &film, &plain);
    }
    for (what, path) in [
        (
            "short paths",
            PathSettings {
                max_depth: 4,
                ..path(2)
            },
        ),
        (
            "strict normals",
            PathSettings {
                strict_normals: true,
                ..path(2)
            },
        ),
        (
            "shared",
            PathSettings {
                guided: GuidedSettings {
                    reuse: 16,
                    ..path(2).guided
                },
                ..path(2)
            },
        ),
    ] {
        // What is shared makes neighbours alike: their errors are more than their own variances
        // tell.
        let other = PathSettings {
            guided: GuidedSettings {
                reuse: 1,
                ..path.guided
            },
            seed: 7,
            ..path.clone()
        };
        let (plain, _) = scene.render(&other, 8192);
        let guide = aiming(&scene, &scene, 0.5);
        let (film, _) = scene.render_guided(&path, 3072, Some(&guide));
        agree(what, &film, &plain);
    }
}

#[test]
fn whoever_aims_at_lamps_finds_the_unguided_mean() {
    let scene = lamplit_balls(0.0);
    let (plain, _) = scene.render(&path(1), 8192);
    for (what, at) in [
        ("lamps", &scene),
        ("lamps of another scene", &lamplit_balls(0.15)),
    ] {
        let guide = aiming(&scene, at, 1.0);
        let (film, _) = scene.render_guided(&path(2), 3072, Some(&guide));
        agree(what, &film, &plain);
    }
}

#[test]
fn aiming_lowers_the_noise_and_is_the_same_for_any_number_of_threads() {
    let scene = balls(0.0, Some(0.5));
    let image = |threads: usize, chance: f32| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| {
            let mut guide = learned(&scene);
            guide.set_manifold_rate(chance);
            scene.render_guided(&path(2), 64, Some(&guide)).0
        })
    };
    let aimed = image(2, 0.5);
    assert!(aimed == image(1, 0.5), "threads change the image");
    // True errors: rare light that a film has missed is missing in its own noise, too.
    let (reference, _) = {
        let mut guide = learned(&scene);
        guide.set_manifold_rate(0.5);
        scene.render_guided(&path(3), 1024, Some(&guide))
    };
    let error = |film: &Film| {
        let places = (0..film.height()).flat_map(|y| (0..film.width()).map(move |x| (x, y)));
        let terms = places.map(|(x, y)| {
            let (value, truth) = (film.pixel(x, y).mean()[1], reference.pixel(x, y).mean()[1]);
            (value - truth).powi(2) / (truth * truth + 0.01)
        });
        // The lamp itself, mirrored in glass, is a few pixels with most of the error in either.
        let mut terms: Vec<f64> = terms.collect();
        terms.sort_unstable_by(f64::total_cmp);
        terms.truncate(terms.len() * 99 / 100);
        terms.iter().sum::<f64>() / terms.len() as f64
    };
    let (without, with) = (error(&image(2, 0.0)), error(&aimed));
    println!("relative error {without:.5}, aimed {with:.5}");
    // The rest of the noise is made by other light.
    assert!(with < 0.8 * without, "{with} is not well below {without}");
}

#[test]
fn nobody_aims_where_nothing_shines_in() {
    let dark = balls(0.0, None);
    assert!(find_chains(&dark.view(&path(1), None), BUDGET).is_none());
    let scene = balls(0.0, Some(4.0));
    let unwilling = PathSettings {
        guided: GuidedSettings::PLAIN,
        ..path(1)
    };
    assert!(find_chains(&scene.view(&unwilling, None), BUDGET).is_none());
}

/// A single sample takes the steps of the render's, also where a path follows several lobes from
/// the camera on.
#[test]
fn a_sample_by_itself_has_the_bits_that_it_has_in_the_render() {
    let scene = balls(0.0, Some(2.0));
    let guide = aiming(&scene, &scene, 0.5);
    let path = path(5);
    let (film, _) = scene.render_guided(&path, 1, Some(&guide));
    let view = scene.view(&path, Some(&guide));
    let mut branched = 0;
    for y in 0..film.height() {
        for x in 0..film.width() {
            let traced = trace_sample(&view, [x, y], PathNumber::plain(0));
            let Rgb { x: r, y: g, z: b } = traced.radiance;
            let radiance = [r, g, b].map(f64::from);
            assert_eq!(radiance, film.pixel(x, y).radiance, "pixel {x}, {y}");
            branched += usize::from(traced.steps.iter().any(|s| s.way != 0));
        }
    }
    assert!(branched > 20, "{branched}");
}
