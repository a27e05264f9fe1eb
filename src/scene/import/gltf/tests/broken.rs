//! Files that make no sense, and files that ask for more than there is: words, never a panic.

use super::*;

#[test]
fn numbers_out_of_range_are_errors_that_name_them() {
    let edits: [(&str, Value, &str); 9] = [
        ("/nodes/0/mesh", json!(7), "no mesh 7"),
        ("/scenes/0/nodes/0", json!(9), "no node 9"),
        ("/nodes/0/children", json!([0]), "twice"),
        (
            "/meshes/0/primitives/0/attributes/POSITION",
            json!(5),
            "no accessor 5",
        ),
        ("/accessors/0/bufferView", json!(3), "no buffer view 3"),
        ("/accessors/0/count", json!(1u64 << 60), "promised"),
        ("/accessors/0/componentType", json!(1), "no known type"),
        (
            "/bufferViews/0/byteOffset",
            json!(u64::MAX),
            "beyond its buffer",
        ),
        ("/asset/version", json!("1.0"), "version"),
    ];
    for (pointer, value, words) in edits {
        let mut file = File::triangle();
        let (parent, key) = pointer.rsplit_once('/').unwrap();
        let parent = file.json.pointer_mut(parent).unwrap();
        match key.parse::<usize>() {
            Ok(index) => parent[index] = value,
            Err(_) => parent[key] = value,
        }
        let error = file.error();
        assert!(error.contains(words), "{pointer}: {error}");
        assert!(error.contains("a.gltf"), "{error}");
    }
}

#[test]
fn an_index_beyond_the_vertices_is_an_error() {
    let mut file = File::triangle();
    let indices = file.integers(5125, "SCALAR", &[0u32, 1, 3]);
    file.primitive()["indices"] = indices.into();
    assert!(file.error().contains("names vertices [0, 1, 3]"));
}

#[test]
fn text_that_is_no_json_is_an_error_with_its_line() {
    let error = load_text("{\n\"asset\": 5}", &DAffine3::IDENTITY, Arc::default());
    let error = error.unwrap_err().to_string();
    assert!(error.contains("a.gltf:2:"), "{error}");
}

#[test]
fn what_is_required_and_unknown_is_an_error_and_what_is_used_a_warning() {
    let mut file = File::triangle();
    file.json["extensionsUsed"] = json!(["EXT_made_up"]);
    let warnings = file.load().warnings;
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("EXT_made_up is not supported"));
    file.json["extensionsRequired"] = json!(["EXT_made_up"]);
    assert!(file.error().contains("requires EXT_made_up"));
}

#[test]
fn points_and_lines_and_animations_are_told_to_be_left_out() {
    let mut file = File::triangle();
    file.primitive()["mode"] = 1.into();
    file.json["animations"] = json!([{}]);
    let parts = file.load();
    assert!(parts.shapes.is_empty());
    let all = parts.warnings.join("\n");
    assert!(
        all.contains("--at SECONDS") && all.contains("points and lines"),
        "{all}"
    );
}

#[test]
fn a_byte_order_mark_is_skipped_and_wide_text_named() {
    let text = File::triangle().text();
    let marked = format!("\u{feff}{text}");
    let parts = load_text(&marked, &DAffine3::IDENTITY, Arc::default()).unwrap();
    assert_eq!(parts.shapes.len(), 1);
    let wide: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let wide = [&[0xff, 0xfe], wide.as_slice()].concat();
    let error = load_bytes(&wide, &DAffine3::IDENTITY, Arc::default()).unwrap_err();
    assert!(error.to_string().contains("UTF-16"), "{error}");
}

/// Few bytes that ask for many: zeros without bytes, the same bytes thousands of times,
/// compression.
#[test]
fn files_that_unpack_to_more_than_the_limit_are_refused() {
    let mut zeros = File::triangle();
    zeros.json["accessors"][0] = json!({"componentType": 5126, "count": 1 << 28, "type": "VEC3"});
    let mut crowd = File::triangle();
    let many = crowd.accessor(json!({"componentType": 5126, "count": 1 << 28, "type": "VEC3"}));
    crowd.json["nodes"][0]["extensions"] = json!({
        "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": many}},
    });
    let mut again = File::triangle();
    let bytes = vec![0u8; 300_000];
    let view = again.view(&bytes);
    let positions = again.accessor(json!({
        "bufferView": view, "componentType": 5121, "count": 100_000, "type": "VEC3",
    }));
    let primitive = json!({"attributes": {"POSITION": positions}});
    again.json["meshes"][0]["primitives"] = vec![primitive; 1000].into();
    let mut compressed = File::triangle();
    for _ in 0..3 {
        let view = compressed.view(&[0xa0; 64]);
        compressed.json["bufferViews"][view]["extensions"]["EXT_meshopt_compression"] = json!({
            "buffer": 0, "byteOffset": 0, "byteLength": 64, "byteStride": 256,
            "count": 2_000_000, "mode": "ATTRIBUTES",
        });
    }
    for (name, file) in [
        ("zeros", zeros),
        ("crowd", crowd),
        ("again", again),
        ("compressed", compressed),
    ] {
        let error = file.error();
        assert!(error.contains("--limit-decoded"), "{name}: {error}");
    }
    // What is as large as its file is not held against the limit.
    let mut honest = File::triangle();
    let positions = honest.accessor(json!({"componentType": 5126, "count": 3, "type": "VEC3"}));
    honest.primitive()["attributes"]["POSITION"] = positions.into();
    honest.load();
}

#[test]
fn numbers_out_of_range_are_told_and_brought_back() {
    let told = |edit: &dyn Fn(&mut Value)| {
        let mut file = File::triangle();
        file.json["materials"] = json!([{"pbrMetallicRoughness": {}, "extensions": {}}]);
        file.primitive()["material"] = 0.into();
        file.json["extensions"]["KHR_lights_punctual"]["lights"] = json!([{"type": "spot"}]);
        file.json["nodes"][0]["extensions"] = json!({"KHR_lights_punctual": {"light": 0}});
        edit(&mut file.json);
        file.load().warnings.join("\n")
    };
    assert_eq!(told(&|_| ()), "");
    let cases: [(&str, Value, &str); 13] = [
        (
            "/materials/0/pbrMetallicRoughness/roughnessFactor",
            json!(1.5),
            "roughnessFactor is 1.5",
        ),
        (
            "/materials/0/pbrMetallicRoughness/metallicFactor",
            json!(-1),
            "metallicFactor is -1",
        ),
        (
            "/materials/0/pbrMetallicRoughness/baseColorFactor",
            json!([2, 0, 0, 1]),
            "baseColorFactor",
        ),
        (
            "/materials/0/emissiveFactor",
            json!([3, 0, 0]),
            "above 1, and taken as it is",
        ),
        ("/materials/0/alphaMode", json!("BLENDED"), "none of OPAQUE"),
        (
            "/materials/0/extensions/KHR_materials_ior",
            json!({"ior": 0.5}),
            "ior is 0.5",
        ),
        (
            "/materials/0/extensions/KHR_materials_transmission",
            json!({"transmissionFactor": 2}),
            "transmissionFactor is 2",
        ),
        (
            "/materials/0/extensions/KHR_materials_pbrSpecularGlossiness",
            json!({"glossinessFactor": -2}),
            "glossinessFactor is -2",
        ),
        (
            "/extensions/KHR_lights_punctual/lights/0/intensity",
            json!(-1),
            "intensity is -1",
        ),
        (
            "/extensions/KHR_lights_punctual/lights/0/intensity",
            json!(1e300),
            "intensity",
        ),
        (
            "/extensions/KHR_lights_punctual/lights/0/spot",
            json!({"outerConeAngle": 9}),
            "outerConeAngle",
        ),
        (
            "/extensions/KHR_lights_punctual/lights/0/range",
            json!(9),
            "range",
        ),
        ("/scene", json!(4), "scene 4 is asked for"),
    ];
    for (pointer, value, words) in cases {
        let told = told(&|json| {
            let (parent, key) = pointer.rsplit_once('/').unwrap();
            let parent = if parent.is_empty() {
                json
            } else {
                json.pointer_mut(parent).unwrap()
            };
            parent[key] = value.clone();
        });
        assert!(told.contains(words), "{pointer}: {told}");
    }
    // Several scenes: one is shown. Textures without coordinates: told.
    let two = told(&|json| json["scenes"] = json!([{"nodes": [0]}, {"nodes": []}]));
    assert!(two.contains("scene 0 of 2"), "{two}");
}

/// What is done to a file.
type Edit<'a> = &'a dyn Fn(&mut File);

#[test]
fn skins_that_make_no_sense_are_errors_or_told() {
    let with = |edit: &dyn Fn(&mut File)| {
        let mut file = File::triangle();
        let joints = file.integers(5121, "SCALAR", &[0u8; 12]);
        file.json["accessors"][joints]["type"] = "VEC4".into();
        file.json["accessors"][joints]["count"] = 3.into();
        let weights = file.floats(&[[1.0, 0.0, 0.0, 0.0]; 3]);
        file.primitive()["attributes"]["JOINTS_0"] = joints.into();
        file.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
        file.json["skins"] = json!([{"joints": [1]}]);
        file.json["nodes"] = json!([{"mesh": 0, "skin": 0}, {"translation": [0, 4, 0]}]);
        file.json["scenes"] = json!([{"nodes": [0, 1]}]);
        edit(&mut file);
        file
    };
    let plain = with(&|_| ()).load();
    assert_eq!(
        (plain.warnings.len(), corners(&plain, 0)[0]),
        (0, Vec3::Y * 4.0)
    );
    let errors: [(Edit, &str); 3] = [
        (&|f| f.json["nodes"][0]["skin"] = 3.into(), "no skin 3"),
        (
            &|f| f.json["skins"][0]["joints"] = json!([7]),
            "node 7 as a joint",
        ),
        (
            &|f| {
                let none = f.accessor(json!({"componentType": 5126, "count": 0, "type": "MAT4"}));
                f.json["skins"][0]["inverseBindMatrices"] = none.into();
            },
            "0 matrices for 1 joints",
        ),
    ];
    for (edit, words) in errors {
        let error = with(edit).error();
        assert!(error.contains(words), "{error}");
    }
    let weights = |rows: [[f32; 4]; 3]| {
        with(&|f| {
            let weights = f.floats(&rows);
            f.primitive()["attributes"]["WEIGHTS_0"] = weights.into();
        })
        .load()
    };
    let half = [0.5, 0.0, 0.0, 0.0];
    let parts = weights([half; 3]);
    assert!(parts.warnings[0].contains("do not sum to 1"), "{parts:?}");
    assert_eq!(corners(&parts, 0)[0], Vec3::Y * 4.0);
    let parts = weights([[0.0; 4], half, half]);
    let told = parts.warnings.join("\n");
    assert!(told.contains("1 vertices have no weight"), "{told}");
    let parts = with(&|f| {
        let joints = f.integers(5121, "SCALAR", &[9u8; 12]);
        f.json["accessors"][joints]["type"] = "VEC4".into();
        f.json["accessors"][joints]["count"] = 3.into();
        f.primitive()["attributes"]["JOINTS_0"] = joints.into();
    })
    .load();
    let told = parts.warnings.join("\n");
    assert!(
        told.contains("weights are on joints that are not there"),
        "{told}"
    );
    let parts = with(&|f| f.json["scenes"] = json!([{"nodes": [0]}])).load();
    assert!(parts.warnings[0].contains("not in the scene"), "{parts:?}");
    // Eight joints a vertex: the second four count as well.
    let eight = with(&|f| {
        let weights = f.floats(&[half; 3]);
        let attributes = &mut f.primitive()["attributes"];
        attributes["WEIGHTS_0"] = weights.into();
        attributes["WEIGHTS_1"] = weights.into();
        attributes["JOINTS_1"] = attributes["JOINTS_0"].clone();
    })
    .load();
    assert_eq!(
        (eight.warnings.len(), corners(&eight, 0)[0]),
        (0, Vec3::Y * 4.0)
    );
}
