//! What a denoiser is told of a pixel: albedo and normal of what is seen, behind mirrors and glass.

mod support;

use support::{Built, SceneMaker, grey, how, inside_of_cube, mesh, settings};
use twintree::accel::Backend;
use twintree::bsdf::Material;
use twintree::bsdf::material::{Conductor, Dielectric, Plastic, ThinDielectric};
use twintree::film::{Film, Metadata, Pixel};
use twintree::integrate::training::learn;
use twintree::integrate::{GuidedSettings, PathSettings, Roulette};
use twintree::light::Emitter;
use twintree::math::{Rgb, Vec3};

/// Half the side of what is in view; the view is narrow, so that all angles are nearly right.
const HALF: f32 = 3.0;

/// A square at that height, which looks up.
fn square(z: f32) -> twintree::scene::Geometry {
    let corners = [(-HALF, -HALF), (HALF, -HALF), (HALF, HALF), (-HALF, HALF)];
    let corners = corners.map(|(x, y)| Vec3::new(x, y, z)).to_vec();
    mesh(corners, vec![[0, 1, 2], [0, 2, 3]])
}

/// A grey floor below something, seen from above, with nothing behind the camera.
fn floor_below(pane: impl Into<Material>) -> Built {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 9.0), Vec3::ZERO, 4.0, 8);
    let floor = maker.diffuse(0.5);
    maker.shape(square(0.0), floor, None, false);
    let pane = maker.material(pane);
    maker.shape(square(1.0), pane, None, false);
    maker.emitter(Emitter::Constant { radiance: Rgb::ONE });
    maker.build(Backend::default())
}

/// Mean albedo (green) and normal over the film.
fn told(film: &Film) -> (f64, [f64; 3]) {
    let pixels = || film.tiles().iter().flat_map(|tile| &tile.pixels);
    let n = pixels().count() as f64;
    let mean = |of: &dyn Fn(&Pixel) -> f64| pixels().map(of).sum::<f64>() / n;
    let normal = |c: usize| mean(&|p: &Pixel| p.seen_normal()[c]);
    (
        mean(&|p: &Pixel| p.seen_albedo()[1]),
        [normal(0), normal(1), normal(2)],
    )
}

/// Reflectance of an interface at a right angle.
fn fresnel(eta: f64) -> f64 {
    ((eta - 1.0) / (eta + 1.0)).powi(2)
}

fn clear(eta: f32) -> Dielectric {
    Dielectric {
        eta,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    }
}

/// One of many choices by lot: 8 x 8 pixels of 1024 samples, a chance of at most 0.08, and at most
/// 0.5 between what is seen: a standard error below 0.5 * 0.27 / 256 = 0.0006.
const TOLERANCE: f64 = 0.003;

#[test]
fn glass_and_water_are_seen_through() {
    let thin = ThinDielectric {
        eta: 1.5,
        specular_reflectance: grey(1.0),
        specular_transmittance: grey(1.0),
    };
    let r = fresnel(1.5);
    let cases = [
        ("pane", Material::ThinDielectric(thin), 2.0 * r / (1.0 + r)),
        // From air into water and no further: what radiance gains there is not albedo.
        ("water", Material::Dielectric(clear(1.33)), fresnel(1.33)),
    ];
    for (name, material, reflected) in cases {
        let (film, _) = floor_below(material).render(&settings(), 1024);
        let (albedo, normal) = told(&film);
        // What is reflected is the sky, whose albedo is 1 and which has no normal.
        let expected = 0.5 * (1.0 - reflected) + reflected;
        assert!(
            (albedo - expected).abs() < TOLERANCE,
            "{name}: {albedo} for {expected}"
        );
        let up = 1.0 - reflected;
        assert!((normal[2] - up).abs() < TOLERANCE, "{name}: {normal:?}");
        assert!(normal[0].hypot(normal[1]) < TOLERANCE, "{name}: {normal:?}");
        // The first surface is still that.
        let pixel = film.pixel(4, 4);
        assert_eq!(pixel.albedo[1] / pixel.count as f64, 1.0, "{name}");
    }
}

/// A mirror of reflectance 0.8 shows a wall of albedo 0.5, upside down.
#[test]
fn a_mirror_shows_the_albedo_and_the_normal_of_what_is_in_it() {
    let mirror = Conductor {
        eta: grey(0.0),
        k: grey(1.0),
        specular_reflectance: grey(0.8),
    };
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 2.0), Vec3::ZERO, 4.0, 8);
    let mirror = maker.material(mirror);
    maker.shape(square(0.0), mirror, None, false);
    let wall = maker.diffuse(0.5);
    maker.shape(inside_of_cube(HALF), wall, None, false);
    let (film, _) = maker.build(Backend::default()).render(&settings(), 4);
    let (albedo, normal) = told(&film);
    assert!((albedo - 0.4).abs() < 1e-5, "{albedo}");
    assert!((normal[2] + 1.0).abs() < 1e-5, "{normal:?}");
}

/// Varnish is followed by lot, and what is under it is told by its share: always less than alone,
/// and the same with every sample that draws no varnish.
#[test]
fn a_varnished_floor_is_told_by_the_share_of_its_base() {
    let (film, _) = floor_below(plastic(0.25)).render(&settings(), 1024);
    let (albedo, normal) = told(&film);
    // Between the base and the sky in the varnish.
    assert!((0.25..0.4).contains(&albedo), "{albedo}");
    assert!((0.8..1.0).contains(&normal[2]), "{normal:?}");
}

fn plastic(reflectance: f32) -> Plastic {
    Plastic {
        eta: 1.5,
        diffuse_reflectance: grey(reflectance),
        specular_reflectance: grey(1.0),
        nonlinear: false,
    }
}

/// Guided paths are split among lobes, and take several ways at once: the mean is the same.
#[test]
fn guided_paths_tell_the_same() {
    for pane in [Material::Dielectric(clear(1.5)), plastic(0.25).into()] {
        let room = floor_below(pane);
        let path = PathSettings {
            guided: GuidedSettings {
                roulette: Roulette::Field,
                reuse: 8,
                manifold: true,
                adaptive: false,
            },
            ..settings()
        };
        let learned = learn(&room.view(&path, None), &how(20_000, 0));
        let guide = learned.expect("the field is learned").guide;
        let (plain, _) = room.render(&path, 1024);
        let (guided, _) = room.render_guided(&path, 1024, Some(&guide));
        let (a, b) = (told(&plain), told(&guided));
        assert!((a.0 - b.0).abs() < TOLERANCE, "{a:?} {b:?}");
        assert!((a.1[2] - b.1[2]).abs() < TOLERANCE, "{a:?} {b:?}");
    }
}

/// Where no mirror is in view the features are those of the first surface, and the sky is white
/// without a normal.
#[test]
fn rough_surfaces_and_the_sky_are_told_as_they_are() {
    let mut maker = SceneMaker::new(Vec3::new(0.0, 0.0, 9.0), Vec3::ZERO, 60.0, 8);
    let floor = maker.diffuse(0.5);
    maker.shape(square(0.0), floor, None, false);
    let (film, _) = maker.build(Backend::default()).render(&settings(), 16);
    let image = film.image(twintree::film::Layers::ALL, &Metadata::default());
    let at = |x, y, name: &str| image.pixel(x, y)[image.channel(name).unwrap()];
    for name in ["albedo", "albedo.first"] {
        assert_eq!(at(4, 4, &format!("{name}.G")), 0.5, "{name}");
    }
    for name in ["normal", "normal.first"] {
        assert_eq!(at(4, 4, &format!("{name}.Z")), 1.0, "{name}");
        assert_eq!(at(0, 0, &format!("{name}.Z")), 0.0, "{name}");
    }
    assert_eq!(at(0, 0, "albedo.G"), 1.0);
    assert_eq!(at(0, 0, "albedo.first.G"), 0.0);
}
