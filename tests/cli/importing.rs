//! Pictures of small models, each with a fault that users of other renderers met; and input files
//! that are no files.

use super::support::{Place, make_pipe, read_exr, wait};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde_json::{Value, json};
use twintree::image::{Image, WriteOptions, write};

/// A square of material m before the camera.
const SQUARE: &str = "mtllib m.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n\
    vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\nusemtl m\nf 1/1/1 2/2/1 3/3/1 4/4/1\n";
const MATTE: &str = "newmtl m\nKd 1 1 1\nKs 0 0 0\n";
/// How far a mean may be from what it should be.
const TOLERANCE: f32 = 0.02;

/// An image of one row.
fn image(place: &Place, name: &str, channels: &[&str], pixels: &[f32]) {
    let width = (pixels.len() / channels.len()) as u32;
    let mut image = Image::new(width, 1, channels);
    image.pixels = pixels.to_vec();
    write(&place.path(name), &image, &WriteOptions::default()).unwrap();
}

/// The mean of the four by four pixels in the middle of a model under a white sky. What is half
/// transparent differs by 0.5 from it at each of the 16 times 400 samples, so that the mean has a
/// standard deviation of 0.5 / 80: a third of the tolerance.
fn middle(place: &Place, model: &str) -> [f32; 3] {
    let look = "--camera from:0,0,5 --look-at 0,0,0 --sky white --width 16 --height 16";
    let words = format!("render {model} {look} --spp 400 --guide none --format float -o out.exr");
    place.run(&words).ok();
    let (width, pixels) = read_exr(&place.path("out.exr"));
    let mut mean = [0.0; 3];
    for (i, pixel) in pixels.iter().enumerate() {
        if (6..10).contains(&(i % width)) && (6..10).contains(&(i / width)) {
            mean.iter_mut().zip(pixel).for_each(|(m, p)| *m += p / 16.0);
        }
    }
    mean
}

fn assert_color(seen: [f32; 3], expected: [f32; 3], what: &str) {
    let error = seen.iter().zip(expected).map(|(s, e)| (s - e).abs());
    let error = error.fold(0.0, f32::max);
    assert!(error < TOLERANCE, "{what}: {seen:?}, not {expected:?}");
}

#[test]
fn materials_of_obj_files_look_as_the_format_says() {
    let place = Place::new();
    // Red on the left, green on the right.
    let pixels = [[1.0, 0.0, 0.0].repeat(4), [0.0, 1.0, 0.0].repeat(4)].concat();
    image(&place, "two.exr", &["R", "G", "B"], &pixels);
    // What a sheet of glass reflects at normal incidence, and what it lets into a medium of index
    // 1.5.
    let through = 0.04 + 0.96 / 2.25;
    let red = "newmtl m\nKd 0.8 0.1 0.1\nKs 0 0 0\n";
    for (name, mtl, expected) in [
        (
            "left",
            format!("{MATTE}map_Kd -s 0.25 1 1 two.exr\n"),
            [1.0, 0.0, 0.0],
        ),
        (
            "right",
            format!("{MATTE}map_Kd -s 0.25 1 1 -o 0.625 0 two.exr\n"),
            [0.0, 1.0, 0.0],
        ),
        (
            "half red",
            format!("{red}d 0.5\nillum 9\n"),
            [0.9, 0.55, 0.55],
        ),
        (
            "a quarter red",
            format!("{red}Tr 0.75\nillum 6\n"),
            [0.95, 0.775, 0.775],
        ),
        (
            "clear glass",
            "newmtl m\nKd 0 0 0\nd 1\nillum 9\n".into(),
            [through; 3],
        ),
        (
            "a mark",
            format!("\u{feff}{}", red.replace('\n', "\r\n")),
            [0.8, 0.1, 0.1],
        ),
    ] {
        std::fs::write(place.path("m.mtl"), mtl).unwrap();
        std::fs::write(place.path("a.obj"), format!("\u{feff}{SQUARE}")).unwrap();
        assert_color(middle(&place, "a.obj"), expected, name);
    }
}

/// A square of a material, with texture coordinates.
fn gltf(material: Value) -> Value {
    let corners = [
        [-1f32, -1.0, 0.0],
        [1.0, -1.0, 0.0],
        [1.0, 1.0, 0.0],
        [-1.0, 1.0, 0.0],
    ];
    let uvs = [[0f32, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut bytes: Vec<u8> = Vec::new();
    bytes.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes.extend(uvs.iter().flatten().flat_map(|x| x.to_le_bytes()));
    bytes.extend([0u8, 1, 2, 0, 2, 3]);
    let data = BASE64_STANDARD.encode(&bytes);
    json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0,
        }]}],
        "materials": [material],
        "images": [{"uri": "gloss.exr"}], "textures": [{"source": 0}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 6},
        ],
        "buffers": [{
            "byteLength": bytes.len(),
            "uri": format!("data:application/octet-stream;base64,{data}"),
        }],
    })
}

#[test]
fn specular_glossiness_keeps_its_colours_and_its_images() {
    let place = Place::new();
    let seen = |gloss: Value| {
        let material = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": gloss}});
        std::fs::write(place.path("a.gltf"), gltf(material).to_string()).unwrap();
        middle(&place, "a.gltf")
    };
    let gold = json!({
        "diffuseFactor": [0, 0, 0, 1], "specularFactor": [1, 0.77, 0.34], "glossinessFactor": 0.7,
    });
    assert_color(seen(gold), [1.0, 0.77, 0.34], "gold");
    // An image of one colour is as good as a factor: plastic, then copper.
    for (texel, gloss) in [([0.04f32, 0.04, 0.04], 0.4f32), ([0.95, 0.64, 0.54], 0.8)] {
        let [r, g, b] = texel;
        image(
            &place,
            "gloss.exr",
            &["R", "G", "B", "A"],
            &[r, g, b, gloss],
        );
        let diffuse = [0.6, 0.3, 0.2, 1.0];
        let by_factors = seen(json!({
            "diffuseFactor": diffuse, "specularFactor": texel, "glossinessFactor": gloss,
        }));
        let by_image = seen(json!({
            "diffuseFactor": diffuse, "specularGlossinessTexture": {"index": 0},
        }));
        assert_color(by_image, by_factors, "an image");
    }
}

#[test]
fn a_million_triangles_in_one_place_are_rendered_like_one() {
    let place = Place::new();
    let count = 1_000_000;
    let mut ply = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\n\
         property float y\nproperty float z\nelement face {count}\n\
         property list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    let corners = [[-3f32, -3.0, 0.0], [3.0, -3.0, 0.0], [0.0, 3.0, 0.0]];
    ply.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let mut face = vec![3u8];
    face.extend([0u32, 1, 2].iter().flat_map(|x| x.to_le_bytes()));
    ply.extend(face.repeat(count));
    std::fs::write(place.path("a.ply"), &ply).unwrap();
    let told = place.run("check a.ply").err;
    assert!(told.contains("999999 triangles dropped"), "{told}");
    for accel in ["embree", "obvhs"] {
        if accel == "embree" && !cfg!(feature = "embree") {
            continue;
        }
        let seen = middle(
            &place,
            &format!("a.ply --accel {accel} --material clay:0.5,0.4,0.3"),
        );
        assert_color(seen, [0.5, 0.4, 0.3], accel);
    }
}

#[test]
fn pipes_and_devices_are_refused_wherever_a_file_is_read() {
    let place = Place::new();
    let pipe = place.path("pipe");
    make_pipe(&pipe);
    for name in [
        "pipe.obj", "pipe.ply", "pipe.stl", "pipe.glb", "pipe.xml", "pipe.exr",
    ] {
        std::os::unix::fs::symlink(&pipe, place.path(name)).unwrap();
    }
    std::fs::write(place.path("a.obj"), SQUARE.replace("m.mtl", "/dev/zero")).unwrap();
    std::fs::write(place.path("b.obj"), SQUARE).unwrap();
    std::fs::write(place.path("m.mtl"), format!("{MATTE}map_Kd pipe.exr\n")).unwrap();
    let buffer =
        json!({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 9, "uri": "pipe"}]});
    std::fs::write(place.path("a.gltf"), buffer.to_string()).unwrap();
    for words in [
        "check pipe.obj",
        "check pipe.ply",
        "check pipe.stl",
        "check pipe.glb",
        "check pipe.xml",
        "check a.gltf",
        "check b.obj",
        "render a.obj --envmap pipe.exr --spp 1 -o out.exr",
        "render scene.xml --guide double --field pipe --spp 1 -o out.exr",
        "sweep scene.xml --plan pipe --reference pipe.exr -o out",
        "merge pipe.exr -o out.exr",
        "compare --reference pipe.exr pipe.exr",
        "field pipe",
    ] {
        let ran = wait(place.spawn(words));
        assert_ne!(ran.code, Some(0), "{words}");
        ran.says(&["not a regular file"]);
    }
    wait(place.spawn("check a.obj")).says(&["/dev/zero", "a device, not a regular file"]);
}
