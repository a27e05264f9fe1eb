//! One square in every mesh format.

use super::{load, options};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use serde_json::json;
use std::io::Write;
use std::path::Path;
use twintree::math::DAffine3;
use twintree::scene::Description;
use twintree::scene::import::gltf::{self, GltfOptions};
use twintree::scene::import::parts::Parts;

/// The square `[-1, 1]^2` in z = 0, its corners counter-clockwise as they are seen from +z.
const CORNERS: [[f32; 3]; 4] = [[-1., -1., 0.], [1., -1., 0.], [1., 1., 0.], [-1., 1., 0.]];
/// Triangles of the square, in the order of its corners or against it.
fn triangles(against: bool) -> [[u32; 3]; 2] {
    let turn = |[a, b, c]: [u32; 3]| if against { [a, c, b] } else { [a, b, c] };
    [turn([0, 1, 2]), turn([0, 2, 3])]
}

pub fn obj(against: bool, normals: bool) -> Vec<u8> {
    let mut text = String::new();
    for [x, y, z] in CORNERS {
        text += &format!("v {x} {y} {z}\n");
    }
    text += "vn 0 0 1\n";
    for t in triangles(against) {
        let corner = |i: u32| match normals {
            true => format!(" {0}//1", i + 1),
            false => format!(" {}", i + 1),
        };
        text += &format!("f{}\n", t.map(corner).concat());
    }
    text.into_bytes()
}

pub fn ply(against: bool, normals: bool) -> Vec<u8> {
    let mut text = String::from("ply\nformat ascii 1.0\nelement vertex 4\n");
    let names: &[&str] = match normals {
        true => &["x", "y", "z", "nx", "ny", "nz"],
        false => &["x", "y", "z"],
    };
    for name in names {
        text += &format!("property float {name}\n");
    }
    text += "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
    for [x, y, z] in CORNERS {
        text += &format!("{x} {y} {z}{}\n", if normals { " 0 0 1" } else { "" });
    }
    for [a, b, c] in triangles(against) {
        text += &format!("3 {a} {b} {c}\n");
    }
    text.into_bytes()
}

pub fn serialized(against: bool, normals: bool) -> Vec<u8> {
    let mut body: Vec<u8> = (0x1000 | u32::from(normals)).to_le_bytes().to_vec();
    body.push(0);
    body.extend(4u64.to_le_bytes());
    body.extend(2u64.to_le_bytes());
    body.extend(CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes()));
    if normals {
        body.extend(
            [[0f32, 0., 1.]; 4]
                .iter()
                .flatten()
                .flat_map(|x| x.to_le_bytes()),
        );
    }
    let indices = triangles(against).into_iter().flatten();
    body.extend(indices.flat_map(u32::to_le_bytes));
    let mut file = vec![0x1c, 0x04, 4, 0];
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    zlib.write_all(&body).unwrap();
    file.extend(zlib.finish().unwrap());
    file.extend(0u64.to_le_bytes());
    file.extend(1u32.to_le_bytes());
    file
}

pub fn gltf_file(against: bool, normals: bool, mirror: bool, double_sided: bool) -> String {
    let mut bytes: Vec<u8> = CORNERS
        .iter()
        .flatten()
        .flat_map(|x| x.to_le_bytes())
        .collect();
    bytes.extend(
        [[0f32, 0., 1.]; 4]
            .iter()
            .flatten()
            .flat_map(|x| x.to_le_bytes()),
    );
    bytes.extend(
        triangles(against)
            .into_iter()
            .flatten()
            .flat_map(u32::to_le_bytes),
    );
    let mut attributes = json!({"POSITION": 0});
    if normals {
        attributes["NORMAL"] = 1.into();
    }
    let accessor = |view: usize, code: u32, count: usize, kind: &str| json!({"bufferView": view, "componentType": code, "count": count, "type": kind});
    let view =
        |at: usize, length: usize| json!({"buffer": 0, "byteOffset": at, "byteLength": length});
    let data = BASE64_STANDARD.encode(&bytes);
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "scale": [if mirror { -1 } else { 1 }, 1, 1]}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 2, "material": 0}]}],
        "materials": [{"emissiveFactor": [1, 0.5, 0.25], "doubleSided": double_sided}],
        "accessors": [accessor(0, 5126, 4, "VEC3"), accessor(1, 5126, 4, "VEC3"),
            accessor(2, 5125, 6, "SCALAR")],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 24)],
        "buffers": [{"byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{data}")}],
    })
    .to_string()
}

pub fn gltf_scene(dir: &Path, text: &str) -> Description {
    let path = dir.join("a.gltf");
    std::fs::write(&path, text).unwrap();
    let mut parts = Parts::default();
    let how = GltfOptions {
        show: Default::default(),
        boundary: None,
        to_world: DAffine3::IDENTITY,
        material: None,
    };
    gltf::load(&path, &how, &options(), &mut parts).unwrap_or_else(|e| panic!("{e}"));
    Description {
        shapes: parts.shapes,
        groups: parts.groups,
        instances: parts.instances,
        materials: parts.materials,
        emitters: parts.emitters,
        emitter_names: parts.emitter_names,
        ..load(dir, "<sensor type='perspective'/><shape type='sphere'/>")
    }
}
