//! Scenes that several tests render, and how two images are compared.

use crate::support::{self, Built, SceneMaker, film_mean, grey, inside_of_cube};
use std::sync::Arc;
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::Material;
use twintree::bsdf::material::Conductor;
use twintree::film::Film;
use twintree::guide::ModelKind;
use twintree::integrate::guiding::Guide;
use twintree::integrate::training::{LearnSettings, learn};
use twintree::integrate::{GuidedSettings, PathSettings};
use twintree::math::{Affine3A, Vec3};
use twintree::photon::PhotonSettings;
use twintree::photon::schedule::Budget;
use twintree::scene::import::{ImportOptions, mitsuba};
use twintree::texture::TextureStore;

/// The ray tracers that were compiled, with their names.
pub fn backends() -> Vec<(&'static str, Backend)> {
    let mut list = vec![("obvhs", Backend::Obvhs)];
    if cfg!(feature = "embree") {
        list.insert(0, ("embree", Backend::Embree));
    }
    list
}

/// A closed room with a lamp that shines at the ceiling, a glass ball and one of rough metal,
/// `scale` times as large as its numbers, moved by `offset` times (1, -1, 1). All numbers are short
/// in binary.
pub fn room_file(scale: f64, offset: f64) -> String {
    let at = |x: f64, y: f64, z: f64| {
        let (x, y, z) = (x * scale, y * scale, z * scale);
        format!("x='{x}' y='{y}' z='{z}'")
    };
    let moved = format!("<translate x='{offset}' y='-{offset}' z='{offset}'/>");
    let place = |turn: &str, size: f64, center: String| {
        let size = size * scale;
        format!(
            "<transform name='to_world'>{turn}<scale value='{size}'/><translate {center}/>{moved}</transform>"
        )
    };
    let ball = |center: String, bsdf: &str| {
        let place = place("", 0.25, center);
        format!("<shape type='sphere'>{place}{bsdf}</shape>")
    };
    let wall = "<bsdf type='diffuse'><rgb name='reflectance' value='0.625'/></bsdf>";
    [
        "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='12'/></integrator>".into(),
        "<sensor type='perspective'><float name='fov' value='70'/>".into(),
        format!("<float name='near_clip' value='{}'/>", 1e-3 * scale),
        format!("<float name='far_clip' value='{}'/>", 1e3 * scale),
        format!(
            "<transform name='to_world'><lookat origin='0 0 {}' target='0 {} {scale}' up='0 1 0'/>{moved}</transform>",
            -0.875 * scale,
            -0.25 * scale
        ),
        "<film type='hdrfilm'><integer name='width' value='32'/><integer name='height' value='32'/><rfilter type='box'/></film></sensor>".into(),
        format!(
            "<shape type='cube'><boolean name='flip_normals' value='true'/>{}{wall}</shape>",
            place("", 1.0, at(0.0, 0.0, 0.0))
        ),
        ball(at(0.5, -0.75, 0.25), "<bsdf type='dielectric'/>"),
        ball(
            at(-0.5, -0.75, 0.5),
            "<bsdf type='roughconductor'><float name='alpha' value='0.25'/></bsdf>",
        ),
        format!(
            "<shape type='rectangle'>{}{wall}<emitter type='area'><rgb name='radiance' value='8'/></emitter></shape>",
            place("<rotate x='1' angle='-90'/>", 0.25, at(0.0, 0.25, 0.25))
        ),
        "</scene>".into(),
    ]
    .concat()
}

/// Loads a scene file's text as the program does.
pub fn loaded(text: &str) -> SceneMaker {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("scene.xml");
    std::fs::write(&path, text).expect("the scene is written");
    let options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
    SceneMaker {
        description: mitsuba::load(&path, &options).unwrap_or_else(|e| panic!("{e}")),
    }
}

/// The room at scale 1 in the middle.
pub fn room(backend: Backend) -> Built {
    loaded(&room_file(1.0, 0.0)).build(backend)
}

/// A box of that albedo with a lamp of that radiance that shines at the ceiling.
pub fn plain_box(albedo: f32, radiance: f32, backend: Backend) -> Built {
    let mut maker = SceneMaker::new(
        Vec3::new(0.0, 0.0, -0.9),
        Vec3::new(0.0, -0.2, 1.0),
        70.0,
        16,
    );
    let wall = maker.diffuse(albedo);
    maker.shape(inside_of_cube(1.0), wall, None, false);
    let up = Affine3A::from_translation(Vec3::new(0.0, 0.3, 0.2))
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(0.25));
    let lamp = maker.exact(AnalyticKind::Rectangle, up);
    let black = maker.diffuse(0.0);
    maker.shape(lamp, black, Some(radiance), false);
    maker.build(backend)
}

/// A metal that reflects everything.
pub fn silver(reflectance: f32) -> Material {
    Material::Conductor(Conductor {
        eta: grey(0.0),
        k: grey(1.0),
        specular_reflectance: grey(reflectance),
    })
}

/// The settings of these tests: paths of at most 12 edges, that seed; guided ones share what they
/// find.
pub fn seed(seed: u64) -> PathSettings {
    PathSettings {
        max_depth: 12,
        guided: GuidedSettings {
            reuse: 32,
            ..GuidedSettings::PLAIN
        },
        seed,
        ..support::settings()
    }
}

/// A field learned from photons and camera paths.
pub fn field_of(built: &Built) -> Guide {
    let settings = LearnSettings {
        photons: Budget::Exactly {
            photons: 60_000,
            batches: 4,
        },
        paths: 20_000,
        batches: 4,
        memory: 16 << 20,
        mixture: None,
        trial: true,
        photon: PhotonSettings {
            max_bounces: 11,
            roulette_after: 3,
            seed: 5,
        },
        model: ModelKind::default(),
    };
    let path = seed(3);
    let learned = learn(&built.view(&path, None), &settings).expect("the field is learned");
    assert_eq!(learned.counts.invalid, 0, "photons are finite");
    learned.guide
}

/// By how much the means of two images differ, relative to the first.
pub fn mean_difference(a: &Film, b: &Film) -> f64 {
    let (a, b) = (film_mean(a).0, film_mean(b).0);
    (b / a - 1.0).abs()
}

/// Standard errors between the means of blocks of 8 x 8 pixels of two images with different random
/// numbers: the largest. Of 16 blocks of equal images, it exceeds 4 once in a thousand times.
pub fn worst_block(a: &Film, b: &Film) -> f64 {
    let block = |film: &Film, bx: u32, by: u32| {
        let mut sum = (0.0, 0.0);
        for i in 0..64 {
            let pixel = film.pixel(bx * 8 + i % 8, by * 8 + i / 8);
            sum.0 += pixel.mean()[1];
            sum.1 += pixel.variance_of_mean()[1];
        }
        sum
    };
    let mut worst: f64 = 0.0;
    for by in 0..a.height() / 8 {
        for bx in 0..a.width() / 8 {
            let ((ma, va), (mb, vb)) = (block(a, bx, by), block(b, bx, by));
            if va + vb > 0.0 {
                worst = worst.max((ma - mb).abs() / (va + vb).sqrt());
            }
        }
    }
    worst
}

/// Share of pixels whose sums differ in any bit.
pub fn differing_pixels(a: &Film, b: &Film) -> f64 {
    let mut differ = 0;
    for y in 0..a.height() {
        for x in 0..a.width() {
            differ += u32::from(a.pixel(x, y).radiance != b.pixel(x, y).radiance);
        }
    }
    f64::from(differ) / f64::from(a.width() * a.height())
}
