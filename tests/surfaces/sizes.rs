//! Pictures of few pixels and of many.

use super::support::{Built, SceneMaker, film_mean, grey, settings};
use std::path::Path;
use twintree::accel::{AnalyticKind, Backend};
use twintree::bsdf::Material;
use twintree::bsdf::material::{Distribution, InvalidNormals, RoughConductor, Roughness};
use twintree::integrate::PathSettings;
use twintree::light::Emitter;
use twintree::math::{Affine3A, Rgb, Vec3};
use twintree::texture::{BitmapSettings, Filter, Texture, TextureStore, UvTransform, Wrap};

/// A texture of waves with 64 by 64 texels, many of them across a surface.
fn waves(dir: &Path, store: &TextureStore, value: fn(f32, f32) -> [f32; 3]) -> Texture {
    let path = dir.join(format!("{}.exr", store.file_count()));
    exr::prelude::write_rgb_file(&path, 64, 64, |x, y| {
        let angle = |i: usize| i as f32 * (std::f32::consts::TAU / 64.0) * 4.0;
        let [r, g, b] = value(angle(x), angle(y));
        (r, g, b)
    })
    .unwrap();
    let settings = BitmapSettings {
        path,
        raw: true,
        gamma: None,
        filter: Filter::Linear,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        to_uv: UvTransform(glam::Affine2::from_scale(glam::Vec2::splat(8.0))),
        channel: None,
    };
    store.open(settings).unwrap_or_else(|e| panic!("{e}"))
}

fn metal(alpha: Texture) -> Material {
    Material::RoughConductor(RoughConductor {
        eta: grey(0.2),
        k: grey(3.9),
        roughness: Roughness {
            distribution: Distribution::Ggx,
            alpha_u: alpha.clone(),
            alpha_v: alpha,
        },
        specular_reflectance: grey(1.0),
    })
}

/// Adds what a material consists of.
type Make<'a> = &'a dyn Fn(&mut SceneMaker) -> Material;

/// A wall of that material under a lamp from the side, `size` pixels wide.
fn wall(size: u32, make: Make) -> Built {
    let eye = Vec3::new(0.0, -2.0, 3.0);
    let mut maker = SceneMaker::new(eye, Vec3::ZERO, 30.0, size);
    let material = make(&mut maker);
    let material = maker.material(material);
    let square = maker.exact(
        AnalyticKind::Rectangle,
        Affine3A::from_scale(Vec3::splat(4.0)),
    );
    maker.shape(square, material, None, false);
    maker.emitter(Emitter::Directional {
        direction: Vec3::new(0.0, -0.8, -0.6),
        irradiance: Rgb::ONE,
    });
    maker.build(Backend::default())
}

/// What enters the light in another way than linearly is not averaged over a pixel: the mean over
/// an image does not depend on how many pixels it has.
#[test]
fn walls_are_as_bright_in_few_pixels_as_in_many() {
    let dir = tempfile::tempdir().unwrap();
    let store = TextureStore::new(16 << 20);
    let heights = waves(dir.path(), &store, |x, y| [0.01 * x.sin() * y.cos(); 3]);
    let normals = waves(dir.path(), &store, |x, y| {
        [0.5 + 0.3 * x.sin(), 0.5 + 0.3 * y.cos(), 0.9]
    });
    let alphas = waves(dir.path(), &store, |x, y| {
        [0.3 + 0.25 * (x.sin() * y.sin()).signum(); 3]
    });
    let under = |maker: &mut SceneMaker| maker.material(metal(grey(0.3)));
    let cases: [(&str, Make); 3] = [
        ("bumps", &|maker| Material::BumpMap {
            displacement: heights.clone(),
            scale: 10.0,
            invalid_normals: InvalidNormals::default(),
            inner: maker.diffuse(0.5),
        }),
        ("normals", &|maker| Material::NormalMap {
            normals: normals.clone(),
            invalid_normals: InvalidNormals::default(),
            inner: under(maker),
        }),
        ("roughness", &|_| metal(alphas.clone())),
    ];
    for (what, make) in cases {
        let path = PathSettings {
            max_depth: 2,
            ..settings()
        };
        let (few, few_error) = film_mean(&wall(8, make).render(&path, 8192).0);
        let (many, error) = film_mean(&wall(128, make).render(&path, 32).0);
        let z = (few - many) / error.hypot(few_error);
        println!("{what}: {few} +- {few_error}, {many} +- {error}");
        assert!(
            z.abs() < 4.0,
            "{what}: {few} and {many}, {z} standard errors"
        );
        assert!(few_error < 0.004 * few, "{what}: too noisy to tell");
    }
}
