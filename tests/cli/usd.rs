//! The recipe that turns USD stages into glTF (tests/usd), with PyPI's usd-core.

use super::support::Place;
use std::process::Command;
use std::sync::Arc;
use twintree::accel::Bounds;
use twintree::bsdf::Material;
use twintree::camera::Projection;
use twintree::light::Emitter;
use twintree::math::{Rgb, Vec3};
use twintree::scene::Geometry;
use twintree::scene::import::ImportOptions;
use twintree::scene::import::gltf::{self, GltfOptions};
use twintree::scene::import::parts::Parts;
use twintree::texture::TextureStore;

/// A Python that has usd-core and numpy: `TWINTREE_USD_PYTHON`, or the one on the path.
fn python() -> Option<String> {
    let named = std::env::var("TWINTREE_USD_PYTHON").unwrap_or("python3".into());
    let tried = Command::new(&named)
        .args(["-c", "import numpy, pxr"])
        .output();
    tried.is_ok_and(|o| o.status.success()).then_some(named)
}

fn bounds(parts: &Parts, name: &str) -> Bounds {
    let shapes = parts.shapes.iter().filter(|s| s.name == name);
    let meshes = shapes.filter_map(|s| match &s.geometry {
        Geometry::Mesh(mesh) => Some(mesh),
        Geometry::Analytic(_) => None,
    });
    let points = meshes.flat_map(|m| m.triangles.positions());
    points.fold(Bounds::EMPTY, |b, p| b.with(*p))
}

fn assert_near(seen: Vec3, expected: Vec3) {
    assert!((seen - expected).length() < 1e-5, "{seen}, not {expected}");
}

#[test]
fn a_stage_becomes_a_model_of_the_same_place_material_and_light() {
    let Some(python) = python() else {
        eprintln!("skipped: no Python with usd-core and numpy (TWINTREE_USD_PYTHON names one)");
        return;
    };
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/usd");
    let place = Place::new();
    let out = place.path("room.glb");
    let done = Command::new(python)
        .arg(root.join("usd_to_gltf.py"))
        .arg(root.join("room.usda"))
        .arg(&out)
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && told.is_empty(), "{told}");
    let options = ImportOptions::new(Arc::new(TextureStore::new(1 << 20)));
    let mut parts = Parts::default();
    gltf::load(&out, &GltfOptions::default(), &options, &mut parts).unwrap();
    // Centimetres with z up became metres with y up.
    let floor = bounds(&parts, "Floor");
    assert_near(floor.min, Vec3::new(-1.0, 0.0, -1.0));
    assert_near(floor.max, Vec3::new(1.0, 0.0, 1.0));
    // Turned by a quarter about z: x became y, which is -z here.
    let wedge = bounds(&parts, "Wedge");
    assert_near(wedge.min, Vec3::new(-0.5, 0.5, -0.5));
    assert_near(wedge.max, Vec3::new(0.0, 0.5, 0.0));
    assert!(parts.shapes.iter().all(|s| s.name != "Hidden"));
    let red = parts.shapes.iter().find(|s| s.name == "Floor").unwrap();
    let mut inner = parts.materials.get(red.material);
    while let Material::TwoSided { front: id, .. } | Material::Blend { first: id, .. } = inner {
        inner = parts.materials.get(*id);
    }
    let Material::MetallicRoughness(m) = inner else {
        panic!("{inner:?}")
    };
    assert_eq!(m.base_color.constant(), Some(Rgb::new(0.8, 0.1, 0.05)));
    assert_eq!(m.roughness.constant(), Some(Rgb::splat(0.25)));
    assert_eq!(m.metallic.constant(), Some(Rgb::splat(0.5)));
    let irradiance = parts.emitters.iter().find_map(|e| match e {
        Emitter::Directional {
            irradiance,
            direction,
        } => Some((*irradiance, *direction)),
        _ => None,
    });
    let (irradiance, direction) = irradiance.unwrap();
    assert_eq!(irradiance, Rgb::splat(3.0));
    assert_near(direction, Vec3::NEG_Y);
    let glow = parts.emitters.iter().find_map(|e| match e {
        Emitter::Area { radiance, .. } => radiance.constant(),
        _ => None,
    });
    assert_eq!(glow, Some(Rgb::new(1.0, 0.5, 0.25)));
    let camera = &parts.cameras[0];
    let Projection::Perspective { fov_degrees, .. } = camera.camera.projection else {
        panic!("{camera:?}")
    };
    let expected = 2.0 * (12f64 / 50.0).atan().to_degrees();
    assert!((fov_degrees - expected).abs() < 1e-4, "{fov_degrees}");
    assert!((camera.camera.to_world.translation.y - 1.0).abs() < 1e-6);
}

#[test]
fn a_stage_is_refused_with_the_script_that_converts_it() {
    let place = Place::new();
    for (name, text) in [("a.usda", "#usda 1.0\n"), ("a.usdz", "PK\u{3}\u{4}")] {
        std::fs::write(place.path(name), text).unwrap();
        let ran = place.run(&format!("render {name}"));
        ran.fails(2, &["tests/usd/usd_to_gltf.py"]);
    }
}
