//! Encodings of numbers: indices, quantised vertices, sparse accessors, strides, `.glb`.

use super::*;

const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];

#[test]
fn a_triangle_without_indices_is_flat_and_where_it_says() {
    let parts = File::triangle().load();
    assert_eq!(parts.shapes.len(), 1);
    assert_eq!(corners(&parts, 0), UNIT);
    assert!(mesh(&parts, 0).normals.is_none());
    assert_eq!(*parts.warnings, [""; 0]);
}

#[test]
fn indices_of_all_three_widths_name_the_same_corners() {
    for code in [5121, 5123, 5125] {
        let mut file = File::triangle();
        let indices = match code {
            5121 => file.integers(code, "SCALAR", &[2u8, 0, 1]),
            5123 => file.integers(code, "SCALAR", &[2u16, 0, 1]),
            _ => file.integers(code, "SCALAR", &[2u32, 0, 1]),
        };
        file.primitive()["indices"] = indices.into();
        assert_eq!(corners(&file.load(), 0), [Vec3::Y, Vec3::ZERO, Vec3::X]);
    }
}

#[test]
fn quantised_vertices_are_fractions_if_normalised_and_numbers_if_not() {
    let mut file = File::triangle();
    let values = [0i16, 0, 0, 32767, 0, 0, 0, -32767, 0];
    let positions = file.integers(5122, "VEC3", &values);
    file.json["accessors"][positions]["normalized"] = true.into();
    file.primitive()["attributes"]["POSITION"] = positions.into();
    file.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    let expected = [Vec3::ZERO, Vec3::X, Vec3::NEG_Y];
    assert_eq!(corners(&file.load(), 0), expected);
    file.json["accessors"][positions]["normalized"] = false.into();
    assert_eq!(corners(&file.load(), 0), expected.map(|v| v * 32767.0));
}

#[test]
fn sparse_values_replace_those_of_the_base_or_zeros() {
    let mut file = File::triangle();
    let indices = file.view(&[1, 0, 2, 0]);
    let values = [[0.0f32, 0.0, 5.0], [0.0, 3.0, 0.0]];
    let values = file.view(bytemuck::cast_slice(&values));
    let sparse = json!({
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values},
    });
    file.json["accessors"][0]["sparse"] = sparse;
    let expected = [Vec3::ZERO, Vec3::Z * 5.0, Vec3::Y * 3.0];
    assert_eq!(corners(&file.load(), 0), expected);
    let base = file.json["accessors"][0].as_object_mut().unwrap();
    base.remove("bufferView");
    assert_eq!(corners(&file.load(), 0), expected);
}

#[test]
fn interleaved_vertices_are_told_apart_by_their_stride() {
    let mut file = File::triangle();
    let rows: [[f32; 8]; 3] = [
        [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.25, 0.5],
        [2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.75, 0.5],
        [0.0, 2.0, 0.0, 0.0, 0.0, 3.0, 0.25, 1.0],
    ];
    let view = file.view(bytemuck::cast_slice(&rows));
    file.json["bufferViews"][view]["byteStride"] = 32.into();
    for (name, offset, kind) in [
        ("POSITION", 0, "VEC3"),
        ("NORMAL", 12, "VEC3"),
        ("TEXCOORD_0", 24, "VEC2"),
    ] {
        let accessor = file.accessor(json!({
            "bufferView": view, "byteOffset": offset, "componentType": 5126,
            "count": 3, "type": kind,
        }));
        file.primitive()["attributes"][name] = accessor.into();
    }
    let parts = file.load();
    assert_eq!(corners(&parts, 0), UNIT.map(|v| v * 2.0));
    let mesh = mesh(&parts, 0);
    assert_eq!(mesh.normals.as_deref(), Some(&[Vec3::Z; 3][..]));
    let uvs = mesh.uvs.as_ref().unwrap();
    assert_eq!(uvs[2].to_array(), [0.25, 1.0]);
}

/// A `.glb` with the same JSON and bytes.
fn binary(file: &File) -> Vec<u8> {
    let mut json = file.json.clone();
    json["buffers"] = json!([{"byteLength": file.bytes.len()}]);
    let mut json = json.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let mut bytes = file.bytes.clone();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let total = 12 + 8 + json.len() + 8 + bytes.len();
    let mut glb = b"glTF".to_vec();
    glb.extend(2u32.to_le_bytes());
    glb.extend((total as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", json), (b"BIN\0", bytes)] {
        glb.extend((chunk.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(chunk);
    }
    glb
}

#[test]
fn one_binary_file_holds_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.glb");
    let glb = binary(&File::triangle());
    let open = |bytes: &[u8]| {
        std::fs::write(&path, bytes).unwrap();
        let mut parts = Parts::default();
        let gltf = GltfOptions {
            show: Default::default(),
            boundary: None,
            to_world: DAffine3::IDENTITY,
            material: None,
        };
        let options = ImportOptions::new(Arc::new(Asked::default()));
        load(&path, &gltf, &options, &mut parts).map(|()| parts)
    };
    assert_eq!(corners(&open(&glb).unwrap(), 0), UNIT);
    // Cut anywhere it is an error, never a panic.
    for length in (0..glb.len()).step_by(7) {
        assert!(open(&glb[..length]).is_err(), "{length}");
    }
}

#[test]
fn views_that_meshoptimizer_compressed_are_read_like_others() {
    let mut file = File::triangle();
    // Four vertices of 16-bit numbers, of which the first bytes of x (0, 1, 2, 3) and y (0, 0, 1,
    // 1) differ.
    let x = [1, 0b0010_1010, 0, 0, 0];
    let y = [1, 0b0000_1000, 0, 0, 0];
    let mut encoded = vec![0xa0];
    encoded.extend(x.iter().chain(&[0]).chain(&y).chain(&[0; 5 + 32]));
    let view = file.view(&encoded);
    let compression = json!({
        "buffer": 0, "byteOffset": file.json["bufferViews"][view]["byteOffset"],
        "byteLength": encoded.len(), "byteStride": 8, "count": 4, "mode": "ATTRIBUTES",
    });
    file.json["bufferViews"][view] = json!({
        "buffer": 1, "byteLength": 32, "byteStride": 8,
        "extensions": {"EXT_meshopt_compression": compression},
    });
    let positions = file.accessor(json!({
        "bufferView": view, "componentType": 5123, "count": 4, "type": "VEC3",
    }));
    let indices = file.integers(5121, "SCALAR", &[0u8, 1, 3]);
    file.primitive()["attributes"]["POSITION"] = positions.into();
    file.primitive()["indices"] = indices.into();
    let expected = [Vec3::ZERO, Vec3::X, Vec3::new(3.0, 1.0, 0.0)];
    assert_eq!(corners(&file.load(), 0), expected);
    let short = encoded.len() - 1;
    let extension = &mut file.json["bufferViews"][view]["extensions"];
    extension["EXT_meshopt_compression"]["byteLength"] = short.into();
    assert!(file.error().contains("end early"));
}
