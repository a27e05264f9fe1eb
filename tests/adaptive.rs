//! Samples spread over the pixels by noise: less error, the same mean.

mod support;

use rayon::prelude::*;
use support::{Built, SceneMaker, Silent, Spread, film_mean, grey, how, inside_of_cube, spreads};
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::material::Dielectric;
use twintree::film::Film;
use twintree::integrate::progress::{Limits, Spent};
use twintree::integrate::render::resume;
use twintree::integrate::training::Learner;
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::math::{Affine3A, Vec3};

/// A closed room lit by a lamp that shines at the ceiling, with a ball of glass, half behind a
/// black board: what is seen of the room is noisy, the board is not at all.
fn room() -> Built {
    let eye = Vec3::new(0.0, 0.0, -0.9);
    let mut maker = SceneMaker::new(eye, Vec3::new(0.0, -0.2, 1.0), 70.0, 32);
    let wall = maker.diffuse(0.6);
    maker.shape(inside_of_cube(1.0), wall, None, false);
    let glass = maker.material(Dielectric {
        eta: 1.5,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    });
    maker.sphere(Vec3::new(0.2, -0.5, 0.4), 0.3, glass, None, false);
    let black = maker.diffuse(0.0);
    let up = Affine3A::from_translation(Vec3::new(0.0, 0.3, 0.2))
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(0.1));
    let lamp = maker.exact(AnalyticKind::Rectangle, up);
    maker.shape(lamp, black, Some(50.0), false);
    let board = Affine3A::from_translation(Vec3::new(0.5, 0.0, -0.5))
        * Affine3A::from_scale(Vec3::splat(0.5));
    let board = maker.exact(AnalyticKind::Rectangle, board);
    maker.shape(board, black, None, false);
    maker.build(Backend::default())
}

const SPP: u64 = 32;

fn render(scene: &Built, adaptive: bool, seed: u64) -> Film {
    let path = PathSettings {
        max_depth: 8,
        guided: GuidedSettings {
            adaptive,
            ..GuidedSettings::PLAIN
        },
        seed,
        ..support::settings()
    };
    let view = scene.view(&path, None);
    let mut learner = Learner::new(&view, &how(5_000, 1 << 30)).expect("a field is learned");
    let mut film = Film::new(&scene.film);
    let limits = Limits {
        spp: SPP,
        time: None,
        noise: None,
    };
    let taught = Some(&mut learner);
    resume(&view, taught, &mut film, &limits, Spent::default(), &Silent);
    film
}

/// Few samples, many times: a bias that goes with what the first samples were like would be largest
/// there.
#[test]
fn spreading_changes_no_mean_and_pixels_tell_their_variance() {
    let scene = room();
    let renders = 128;
    let films: Vec<Film> = (0..renders)
        .into_par_iter()
        .map(|i| render(&scene, true, 100 + i))
        .collect();
    let spread = films.iter().filter(|film| {
        let counts = (0..32 * 32).map(|i| film.pixel(i % 32, i / 32).count);
        let (least, most) = counts.fold((u64::MAX, 0), |(l, m), n| (l.min(n), m.max(n)));
        4 * least < 3 * SPP && 5 * most > 6 * SPP
    });
    let spread = spread.count();
    println!("{spread} of {renders} are spread");
    assert!(spread as u64 > renders / 2, "most are hardly spread");

    let plain = PathSettings {
        max_depth: 8,
        ..support::settings()
    };
    let (plain, _) = scene.render(&plain, 1 << 13);
    let (truth, truth_error) = film_mean(&plain);
    let means: Vec<f64> = films.iter().map(|film| film_mean(film).0).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
    println!("{mean:.5} +- {error:.5}, plain {truth:.5} +- {truth_error:.5}");
    assert!(
        error.hypot(truth_error) < 0.003 * truth,
        "too noisy to see one per cent"
    );
    assert!((mean - truth).abs() < 3.3 * error.hypot(truth_error));

    // What pixels tell, and what it is.
    let spreads = spreads(&films);
    let actual: f64 = spreads.iter().map(|s| s.actual).sum();
    let told: f64 = spreads.iter().map(|s| s.told).sum();
    println!("variance {actual:.3e}, told {told:.3e}");
    assert!((actual / told - 1.0).abs() < 0.15, "{actual} is not {told}");
}

#[test]
fn spreading_lowers_the_error_and_is_the_same_for_any_number_of_threads() {
    let scene = room();
    let image = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| render(&scene, true, 1))
    };
    assert!(image(1) == image(3), "threads change the image");
    let squares = |adaptive: bool| -> f64 {
        let films: Vec<Film> = (0..64)
            .into_par_iter()
            .map(|i| render(&scene, adaptive, 1000 + i))
            .collect();
        let relative = |s: &Spread| s.actual / (s.mean * s.mean + 0.01);
        spreads(&films).iter().map(relative).sum()
    };
    let (even, spread) = (squares(false), squares(true));
    println!("relative variance, spread over even: {}", spread / even);
    assert!(spread < 0.85 * even, "{}", spread / even);
}
