//! What is shown of a file that holds more than one look: variants, animations, hidden nodes.

use super::super::{Moment, Show};
use super::*;
use crate::bsdf::material::MetallicRoughness;

fn shown(file: &File, show: Show) -> Result<Parts, ImportError> {
    let gltf = GltfOptions {
        show,
        ..GltfOptions::default()
    };
    file.load_as(&gltf)
}

fn at(file: &File, moment: &str) -> Result<Parts, ImportError> {
    let moment: Moment = moment.parse().unwrap();
    let show = Show {
        moment: Some(moment),
        variant: None,
    };
    shown(file, show)
}

#[test]
fn a_variant_is_shown_by_its_name_and_an_unknown_one_lists_them() {
    let mut file = File::triangle();
    let color = |r: f32| json!({"pbrMetallicRoughness": {"baseColorFactor": [r, 0, 0, 1]}});
    file.json["materials"] = json!([color(0.1), color(0.2), color(0.3)]);
    file.json["extensions"] = json!({"KHR_materials_variants": {
        "variants": [{"name": "Beach"}, {"name": "Midnight Blue"}, {"name": "plain"}],
    }});
    file.primitive()["material"] = 0.into();
    file.primitive()["extensions"] = json!({"KHR_materials_variants": {"mappings": [
        {"material": 1, "variants": [0]}, {"material": 2, "variants": [1]},
    ]}});
    let of = |variant: Option<&str>| {
        let variant = variant.map(str::to_owned);
        let moment = None;
        shown(&file, Show { variant, moment })
    };
    let red = |parts: Parts| {
        let Material::TwoSided { front, .. } = parts.materials.get(parts.shapes[0].material) else {
            panic!("{parts:?}")
        };
        match parts.materials.get(*front) {
            Material::MetallicRoughness(m) => {
                let m: &MetallicRoughness = m;
                m.base_color.constant().unwrap().x
            }
            other => panic!("{other:?}"),
        }
    };
    let plain = of(None).unwrap();
    assert!(plain.warnings[0].contains("--variant shows one of: Beach, Midnight Blue, plain"));
    assert_eq!(red(plain), 0.1);
    assert_eq!(red(of(Some("Beach")).unwrap()), 0.2);
    assert_eq!(red(of(Some("midnight blue")).unwrap()), 0.3);
    // It names no material of its own.
    assert_eq!(red(of(Some("plain")).unwrap()), 0.1);
    let error = of(Some("Street")).unwrap_err().to_string();
    assert!(
        error.contains("no variant \"Street\"") && error.contains("\"Beach\", \"Midnight Blue\""),
        "{error}"
    );
}

/// A triangle whose node is moved, turned and scaled, and whose morph target rises.
fn moving() -> File {
    let mut file = File::triangle();
    let up = file.floats(&[[0.0, 0.0, 1.0]; 3]);
    file.primitive()["targets"] = json!([{"POSITION": up}]);
    let times = file.floats(&[[1.0f32], [3.0]]);
    let places = file.floats(&[[0.0f32, 0.0, 0.0], [4.0, 0.0, 0.0]]);
    // Splines: a tangent, a value, a tangent.
    let zero = [0.0f32; 3];
    let sizes = file.floats(&[zero, [1.0; 3], zero, zero, [3.0; 3], zero]);
    let root = std::f32::consts::FRAC_1_SQRT_2;
    let turns = file.floats(&[[0.0f32, 0.0, 0.0, 1.0], [0.0, 0.0, root, root]]);
    let weights = file.floats(&[[0.0f32], [1.0]]);
    let sampler =
        |output: usize, way: &str| json!({"input": times, "output": output, "interpolation": way});
    let channel = |sampler: usize, path: &str| json!({"sampler": sampler, "target": {"node": 0, "path": path}});
    file.json["animations"] = json!([
        {"name": "Go", "samplers": [sampler(places, "LINEAR"), sampler(weights, "LINEAR")],
            "channels": [channel(0, "translation"), channel(1, "weights")]},
        {"name": "Turn", "samplers": [sampler(turns, "STEP"), sampler(sizes, "CUBICSPLINE")],
            "channels": [channel(0, "rotation"), channel(1, "scale")]},
    ]);
    file
}

#[test]
fn a_moment_of_an_animation_moves_nodes_and_morph_targets() {
    let file = moving();
    let first = |moment: &str| corners(&at(&file, moment).unwrap(), 0)[0];
    assert_eq!(first("0"), Vec3::ZERO);
    assert_eq!(first("1.5"), Vec3::new(1.0, 0.0, 0.25));
    assert_eq!(first("99"), Vec3::new(4.0, 0.0, 1.0));
    let second = |moment: &str| corners(&at(&file, moment).unwrap(), 0)[1];
    // Half way between sizes of 1 and 3; a step is not taken before its time.
    assert!((second("Turn:2") - Vec3::X * 2.0).length() < 1e-6);
    assert!((second("1:3") - Vec3::Y * 3.0).length() < 1e-6);
    let warnings = at(&file, "2").unwrap().warnings;
    assert!(warnings[0].contains("Go, Turn"), "{warnings:?}");
    let error = at(&file, "Run:2").unwrap_err().to_string();
    assert!(
        error.contains("\"Run\"") && error.contains("Go, Turn"),
        "{error}"
    );
    let still = file.load().warnings;
    assert!(still[0].contains("--at SECONDS"), "{still:?}");
}

#[test]
fn animations_that_make_no_sense_are_errors() {
    for (path, value) in [
        ("/animations/0/channels/0/target/node", json!(9)),
        ("/animations/0/channels/0/sampler", json!(9)),
        ("/animations/0/samplers/0/input", json!(99)),
        ("/animations/0/samplers/0/interpolation", json!("MAGIC")),
        (
            "/animations/0/samplers/1/interpolation",
            json!("CUBICSPLINE"),
        ),
        ("/animations/0/samplers/0/output", json!(2)),
    ] {
        let mut file = moving();
        *file.json.pointer_mut(path).unwrap() = value;
        let error = at(&file, "2").unwrap_err().to_string();
        assert!(error.contains("a.gltf"), "{path}: {error}");
    }
    // What animates anything else is told.
    let mut file = moving();
    let target = &mut file.json["animations"][0]["channels"][0]["target"];
    *target = json!({"path": "pointer"});
    let warnings = at(&file, "Go:2").unwrap().warnings;
    assert!(warnings[0].contains("1 channels"), "{warnings:?}");
}

#[test]
fn what_hangs_below_a_hidden_node_is_hidden() {
    let mut file = File::triangle();
    let hidden = json!({"KHR_node_visibility": {"visible": false}});
    file.json["nodes"] = json!([{"mesh": 0}, {"children": [2, 3], "extensions": hidden},
        {"mesh": 0, "extensions": {"KHR_node_visibility": {"visible": true}}}, {"camera": 0}]);
    file.json["scenes"] = json!([{"nodes": [0, 1]}]);
    file.json["cameras"] = json!([{"perspective": {"yfov": 1, "znear": 0.1}}]);
    let parts = file.load();
    assert_eq!((parts.shapes.len(), parts.instances.len()), (1, 0));
    assert_eq!(parts.cameras.len(), 1);
}
