//! Models without a scene, and meshes made by rule.

use super::support::{Place, read_exr};

/// A pyramid: five corners, closed.
const OBJ: &str = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nv 0 2 0\n\
    f 1 2 3 4\nf 1 5 2\nf 2 5 3\nf 3 5 4\nf 4 5 1\n";
/// A triangle with colours: red where it is seen.
const PLY: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
    property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n\
    element face 1\nproperty list uchar int vertex_indices\nend_header\n\
    -1 -1 0 255 0 0\n1 -1 0 255 0 0\n0 1 0 255 0 0\n3 0 1 2\n";
const STL: &str = "solid a\nfacet normal 0 0 1\nouter loop\nvertex -1 -1 0\nvertex 1 -1 0\n\
    vertex 0 1 0\nendloop\nendfacet\nendsolid a\n";
const QUICK: &str = "--width 24 --spp 4 -o out.exr";

fn place() -> Place {
    let place = Place::new();
    for (name, text) in [("a.obj", OBJ), ("a.ply", PLY), ("a.stl", STL)] {
        std::fs::write(place.path(name), text).unwrap();
    }
    place
}

/// The middle of the picture.
fn middle(place: &Place) -> [f32; 3] {
    let (width, pixels) = read_exr(&place.path("out.exr"));
    pixels[pixels.len() / width / 2 * width + width / 2]
}

#[test]
fn a_model_alone_is_rendered_from_the_front_in_its_colours() {
    let place = place();
    place
        .run(&format!(
            "render a.ply --camera orbit:0,0 --sky white {QUICK}"
        ))
        .ok();
    let [r, g, b] = middle(&place);
    // A flat red surface under a white sky: all of the light, no other colour.
    assert!(
        (r - 1.0).abs() < 0.02 && g == 0.0 && b == 0.0,
        "{r} {g} {b}"
    );
    let (width, pixels) = read_exr(&place.path("out.exr"));
    assert_eq!((width, pixels.len()), (24, 24 * 18));
    // The sky beside the model.
    assert!(
        pixels[0].iter().all(|c| (c - 1.0).abs() < 1e-3),
        "{:?}",
        pixels[0]
    );
}

#[test]
fn several_models_stand_where_they_are_put() {
    let place = place();
    let words = "a.obj@material=gold a.stl@translate=5,0,0;rotate=y,90;scale=2 a.ply --ground";
    place.run(&format!("render {words} {QUICK}")).ok();
    let json = place.run(&format!("info {words} --json")).ok().out;
    let info: serde_json::Value = serde_json::from_str(&json).unwrap();
    // Six of the pyramid, one each of the others.
    assert_eq!(info["triangles"], 8);
    assert_eq!(info["shapes"]["disk"], 2);
    assert_eq!(info["lights"]["area"], 1);
    place.run("check a.obj").ok();
}

#[test]
fn words_that_do_not_go_together_are_told() {
    let place = place();
    let cases: [(&str, &[&str]); 15] = [
        ("render scene.xml --ground", &["--ground is for models"]),
        ("render a.obj -D a=b", &["-D a", "scene"]),
        ("render a.obj scene.xml", &["scene.xml: is no model"]),
        ("render a.obj@spin=3", &["spin=3", "rotate=AXIS"]),
        ("render a.obj --material cheese", &["cheese", "clay"]),
        (
            "render a.obj --camera left",
            &["no camera \"left\"", "orbit"],
        ),
        ("render a.obj --envmap absent.hdr", &["absent.hdr"]),
        ("render a.stl@scale=0", &["none of them 0"]),
        (
            "render scene.xml --projection fisheye",
            &["--projection is for models"],
        ),
        ("render a.obj --projection round", &["round", "fisheye"]),
        ("render a.obj --fov 200", &["--fov 200", "180", "fisheye"]),
        ("render a.obj --fov 361", &["up to 360"]),
        (
            "render a.obj --projection spherical --fov 90",
            &["--fov", "panorama"],
        ),
        (
            "render a.obj --projection orthographic --aperture 1",
            &["--aperture", "perspective"],
        ),
        ("render a.obj --focus 2", &["--aperture"]),
    ];
    for (words, parts) in cases {
        place.run(words).fails(2, parts);
    }
}

/// By parallel rays from the front the pyramid is a triangle of width 2 and height 2 in a picture
/// of height 2.1 and a width of 4/3 of that.
#[test]
fn parallel_rays_show_a_model_in_its_true_size() {
    let place = place();
    let view = "--projection orthographic --camera orbit:0,0 --sky white --material matte:0.1";
    place
        .run(&format!(
            "render a.obj {view} --width 120 --spp 4 -o out.exr"
        ))
        .ok();
    let (_, pixels) = read_exr(&place.path("out.exr"));
    let covered = pixels.iter().filter(|p| p[1] < 0.55).count() as f64;
    let share = covered / pixels.len() as f64;
    let expected = 2.0 / (2.1 * 2.1 * 4.0 / 3.0);
    // Of the 3600 pixels, 260 are on its outline and fall to either side.
    assert!((share / expected - 1.0).abs() < 0.02, "{share} {expected}");
}

#[test]
fn a_file_beyond_memory_is_refused_with_numbers() {
    let place = place();
    let file = std::fs::File::create(place.path("big.ply")).unwrap();
    // A hole of 4 TiB: it takes no room on the disk. Where files cannot be so large, nothing is
    // tested.
    if file.set_len(1 << 42).is_err() {
        return;
    }
    let ran = place.run(&format!("render big.ply {QUICK}"));
    ran.fails(1, &["8.00 TiB", "available", "help"]);
}

#[test]
fn meshes_are_made_the_same_each_time_and_can_be_rendered() {
    let place = Place::new();
    for kind in ["terrain", "dragon-curve", "sphere-flake", "torus-knot"] {
        let made = place.run(&format!("make mesh --kind {kind} --triangles 5k -o a.ply"));
        assert!(made.ok().out.contains("a.ply"));
        let first = place.read("a.ply");
        place
            .run(&format!(
                "make mesh --kind {kind} --triangles 5000 -o a.ply"
            ))
            .ok();
        assert!(first == place.read("a.ply"), "{kind}");
        place
            .run(&format!("render a.ply --accel-build compact {QUICK}"))
            .ok();
    }
    place
        .run("make mesh --kind terrain --triangles 9G -o a.ply")
        .fails(2, &["too many"]);
    place
        .run("make mesh --kind terrain -o a.obj")
        .fails(2, &["a.obj", ".ply"]);
}

#[test]
fn fifty_thousand_instances_are_one_mesh() {
    let place = Place::new();
    let count = 50_000usize;
    let mut bytes: Vec<u8> = Vec::new();
    let corners = [[0f32, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.5, 0.0]];
    bytes.extend(corners.iter().flatten().flat_map(|x| x.to_le_bytes()));
    for i in 0..count {
        let place = [(i % 250) as f32, (i / 250) as f32, 0.0];
        bytes.extend(place.iter().flat_map(|x| x.to_le_bytes()));
    }
    std::fs::write(place.path("a.bin"), &bytes).unwrap();
    let json = serde_json::json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "extensions": {
            "EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 1}},
        }}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"uri": "a.bin", "byteLength": bytes.len()}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 12 * count},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3},
            {"bufferView": 1, "componentType": 5126, "type": "VEC3", "count": count},
        ],
    });
    std::fs::write(place.path("a.gltf"), json.to_string()).unwrap();
    place
        .run(&format!("render a.gltf --stats stats.json {QUICK}"))
        .ok();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("stats.json")).unwrap();
    assert_eq!(stats["triangles"], 1);
    let trees = stats["accel_memory_bytes"].as_u64().unwrap();
    assert!(trees < 1200 * count as u64, "{trees} bytes");
}
