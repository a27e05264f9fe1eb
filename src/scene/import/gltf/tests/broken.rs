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
    file.json["extensionsUsed"] = json!(["KHR_materials_iridescence"]);
    let warnings = file.load().warnings;
    assert_eq!(warnings.len(), 1);
    assert!(warnings[0].contains("KHR_materials_iridescence is not supported"));
    file.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    assert!(file.error().contains("KHR_draco_mesh_compression"));
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
        all.contains("animations") && all.contains("points and lines"),
        "{all}"
    );
}
