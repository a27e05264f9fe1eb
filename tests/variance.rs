//! What a film tells of its own error is true: for pixels and for means over blocks, with Sobol
//! points, shared paths, samples spread by noise; and so is the noise that it reports.
//!
//! Each kind of render is made with [`RENDERS`] seeds. Their spread around their mean is the true
//! error, and z is that over the deviation told. With 2304 pixels, or 9 blocks of 16 x 16, times
//! the seeds the deviation of z is known to 1 and 5 % (more where the noise has heavy tails).

mod support;

use rayon::prelude::*;
use support::{Built, SceneMaker, Silent, grey, how, inside_of_cube};
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::material::Plastic;
use twintree::film::Film;
use twintree::film::{Layers, Metadata};
use twintree::image::metrics::blocks::KnownNoise;
use twintree::integrate::progress::{Limits, Spent};
use twintree::integrate::render::resume;
use twintree::integrate::training::Learner;
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::math::{Affine3A, Vec3};
use twintree::scene::description::SamplerKind;

const RENDERS: u64 = 24;
const SIZE: u32 = 48;
const SPP: u64 = 64;

/// A room with a lamp that shines at the ceiling and a glossy ball: light is indirect, and found at
/// every pixel.
fn room(lamp: f32) -> Built {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, -0.9), Vec3::Z, 70.0, SIZE);
    let wall = maker.diffuse(0.6);
    maker.shape(inside_of_cube(1.0), wall, None, false);
    let plastic = maker.material(Plastic {
        eta: 1.5,
        diffuse_reflectance: grey(0.4),
        specular_reflectance: grey(1.0),
        nonlinear: false,
    });
    maker.sphere(Vec3::new(0.3, -0.5, 0.4), 0.3, plastic, None, false);
    let black = maker.diffuse(0.0);
    let up = Affine3A::from_translation(Vec3::new(0.0, 0.2, 0.2))
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(0.25));
    let rectangle = maker.exact(AnalyticKind::Rectangle, up);
    maker.shape(rectangle, black, Some(lamp), false);
    maker.build(Backend::default())
}

/// Renders with many seeds; a field is learned along with the image if that is asked for.
fn films(scene: &Built, path: &PathSettings, learns: bool) -> Vec<Film> {
    let one = |seed| {
        let path = PathSettings {
            max_depth: 6,
            seed: 50 + seed,
            ..path.clone()
        };
        let view = scene.view(&path, None);
        let mut learner =
            learns.then(|| Learner::new(&view, &how(20_000, 1 << 30)).expect("a field"));
        let mut film = Film::new(&scene.film);
        let limits = Limits {
            spp: SPP,
            time: None,
            noise: None,
        };
        resume(
            &view,
            learner.as_mut(),
            &mut film,
            &limits,
            Spent::default(),
            &Silent,
        );
        film
    };
    (0..RENDERS).into_par_iter().map(one).collect()
}

/// Means of the green channel over blocks of `side` pixels.
fn means(values: &[f64], side: usize) -> Vec<f64> {
    let across = SIZE as usize / side;
    let mean = |block: usize| {
        let (x, y) = (block % across * side, block / across * side);
        let pixels = (0..side * side).map(|i| (y + i / side) * SIZE as usize + x + i % side);
        pixels.map(|at| values[at]).sum::<f64>() / (side * side) as f64
    };
    (0..across * across).map(mean).collect()
}

/// A render as others see it.
struct Seen {
    picture: Vec<f64>,
    known: KnownNoise,
    noise: f64,
}

fn seen(film: &Film) -> Seen {
    let image = film.image(Layers::ALL, &Metadata::default());
    Seen {
        picture: image.rgb().iter().map(|p| f64::from(p.y)).collect(),
        known: KnownNoise::of(&image).expect("the layers are there"),
        noise: f64::from(film.noise().expect("there are samples").value),
    }
}

/// Standard deviation of z of means over blocks of 1, 4, 16 pixels, and the noise told over the
/// true one.
fn told_and_true(films: &[Film]) -> ([f64; 3], f64) {
    let seen: Vec<Seen> = films.iter().map(seen).collect();
    let n = seen.len() as f64;
    let count = (SIZE * SIZE) as usize;
    let average = |i: usize| seen.iter().map(|s| s.picture[i]).sum::<f64>() / n;
    let mean: Vec<f64> = (0..count).map(average).collect();
    let unbiased = n / (n - 1.0);
    let deviations = [1, 4, 16].map(|side| {
        // A film of nine blocks knows this factor to a half: all films together.
        let factors = seen.iter().map(|s| s.known.linked(SIZE as usize, side));
        let linked = factors.sum::<f64>() / n / (side * side) as f64;
        let mut squares = Vec::new();
        for s in &seen {
            let difference = |i: usize| s.picture[i] - mean[i];
            let errors: Vec<f64> = (0..count).map(difference).collect();
            let variance: Vec<f64> = s.known.variance.iter().map(|v| f64::from(v.y)).collect();
            let told = means(&variance, side);
            let errors = means(&errors, side);
            let z = errors.iter().zip(told).map(|(e, v)| e * e / (v * linked));
            squares.extend(z.filter(|z| z.is_finite()));
        }
        (squares.iter().sum::<f64>() / squares.len() as f64 * unbiased).sqrt()
    });
    let floor = 0.01 * (mean.iter().sum::<f64>() / count as f64).powi(2);
    let mut actual = 0.0;
    for s in &seen {
        let term = |i: usize| (s.picture[i] - mean[i]).powi(2) / (mean[i] * mean[i] + floor);
        let mut terms: Vec<f64> = (0..count).map(term).collect();
        terms.sort_unstable_by(f64::total_cmp);
        terms.truncate(count - count / 1000);
        actual += terms.iter().sum::<f64>() / terms.len() as f64 * unbiased;
    }
    let told = seen.iter().map(|s| s.noise * s.noise).sum::<f64>();
    (deviations, (told / actual).sqrt())
}

fn check(what: &str, path: &PathSettings, learns: bool) {
    let (deviations, noise) = told_and_true(&films(&room(4.0), path, learns));
    println!("{what}: deviation of z {deviations:.2?}, noise told over true {noise:.3}");
    for (deviation, side) in deviations.iter().zip([1, 4, 16]) {
        assert!(
            (0.8..1.25).contains(deviation),
            "{what}: {side} px: {deviation}"
        );
    }
    assert!((0.85..1.15).contains(&noise), "{what}: noise {noise}");
}

fn sobol() -> PathSettings {
    PathSettings {
        sampler: SamplerKind::Sobol,
        ..support::settings()
    }
}

#[test]
fn of_independent_samples() {
    check("independent", &support::settings(), false);
}

#[test]
fn of_sobol_points() {
    check("Sobol", &sobol(), false);
}

#[test]
fn of_shared_paths() {
    let path = PathSettings {
        guided: GuidedSettings {
            reuse: 32,
            ..GuidedSettings::PLAIN
        },
        ..sobol()
    };
    check("shared", &path, true);
}

#[test]
fn of_samples_spread_by_noise() {
    let path = PathSettings {
        guided: GuidedSettings {
            adaptive: true,
            ..GuidedSettings::PLAIN
        },
        ..sobol()
    };
    check("spread", &path, true);
}

/// The unit of light is arbitrary: a lamp a thousand times weaker leaves the noise what it is.
#[test]
fn noise_does_not_depend_on_the_unit_of_light() {
    let noise = |lamp: f32| {
        let path = PathSettings {
            max_depth: 6,
            ..sobol()
        };
        let (film, _) = room(lamp).render(&path, 16);
        film.noise().expect("there are samples").value
    };
    let (bright, dim) = (noise(4.0), noise(0.004));
    assert!((dim / bright - 1.0).abs() < 1e-3, "{bright} {dim}");
}
