//! Scenes that say something unusual: what is rendered, and that `check` says what `render` does.

use super::support::{Place, read_exr};
use std::io::Write as _;
use std::path::Path;

/// A camera in front of whatever follows.
const VIEW: &str = r#"<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="40"/>
  <transform name="to_world"><lookat origin="0,0,3" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/></film>
</sensor>
"#;

/// A texture of one colour.
fn write_color(path: &Path, [r, g, b]: [f32; 3]) {
    exr::prelude::write_rgb_file(path, 2, 2, |_, _| (r, g, b)).unwrap();
}

/// A grey PNG of one bit a pixel, all black: `side` squared pixels in a few bytes.
fn write_black_png(path: &Path, side: u32) {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut chunk = |kind: &[u8; 4], data: &[u8]| {
        png.extend((data.len() as u32).to_be_bytes());
        let mut crc = flate2::Crc::new();
        crc.update(kind);
        crc.update(data);
        png.extend(kind);
        png.extend(data);
        png.extend(crc.sum().to_be_bytes());
    };
    let mut header = [side.to_be_bytes(), side.to_be_bytes()].concat();
    header.extend([1, 0, 0, 0, 0]);
    chunk(b"IHDR", &header);
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::best());
    let row = vec![0; side.div_ceil(8) as usize + 1];
    for _ in 0..side {
        zlib.write_all(&row).unwrap();
    }
    chunk(b"IDAT", &zlib.finish().unwrap());
    chunk(b"IEND", &[]);
    std::fs::write(path, png).unwrap();
}

/// Included materials take their textures from beside the main scene: the picture has its colour.
#[test]
fn textures_of_included_files_lie_beside_the_scene() {
    let inside = r#"<include filename="frag/mats.xml"/><emitter type="constant"/>
        <shape type="rectangle"><ref id="m"/></shape></scene>"#;
    let place = Place::with(&format!("{VIEW}{inside}"));
    std::fs::create_dir(place.path("frag")).unwrap();
    write_color(&place.path("t.exr"), [0.8, 0.0, 0.0]);
    write_color(&place.path("frag/t.exr"), [0.0, 0.8, 0.0]);
    let material = r#"<scene version="3.0.0"><bsdf type="diffuse" id="m"><texture type="bitmap" name="reflectance"><string name="filename" value="t.exr"/></texture></bsdf></scene>"#;
    std::fs::write(place.path("frag/mats.xml"), material).unwrap();
    place.run("render scene.xml --spp 4 -o a.exr").ok();
    let (_, pixels) = read_exr(&place.path("a.exr"));
    let [r, g, b] = pixels[8 * 16 + 8];
    assert!(
        (r - 0.8).abs() < 0.01 && g == 0.0 && b == 0.0,
        "{r} {g} {b}"
    );
}

/// What a render says of a scene before it begins, `check` says word for word.
#[test]
fn check_says_what_render_says() {
    let dark = r#"<shape type="cube"/></scene>"#;
    let odd = r#"<shape type="cube"><float name="odd" value="1"/></shape><emitter type="constant"/></scene>"#;
    let sun = r#"<shape type="cube"/><emitter type="envmap"><string name="filename" value="sun.exr"/></emitter></scene>"#;
    for (inside, words) in [
        (dark, "nothing in the scene shines"),
        (odd, "no parameter \"odd\""),
        (sun, "1 texels are infinite"),
    ] {
        let place = Place::with(&format!("{VIEW}{inside}"));
        let pixel = |x, y| {
            let v = if (x, y) == (3, 1) {
                f32::INFINITY
            } else {
                0.5f32
            };
            (v, v, v)
        };
        exr::prelude::write_rgb_file(place.path("sun.exr"), 8, 4, pixel).unwrap();
        let warnings = |words: &str| -> Vec<String> {
            let err = place.run(words).ok().err;
            let lines = err.lines().filter(|l| l.starts_with("warning: "));
            lines.map(str::to_owned).collect()
        };
        let check = warnings("check scene.xml");
        assert_eq!(
            check,
            warnings("render scene.xml --spp 1 --guide none -o a.exr")
        );
        assert_eq!(check.len(), 1, "{check:?}");
        assert!(check[0].contains(words), "{check:?}");
        let verdict = place.run("check scene.xml").ok().out;
        assert_eq!(verdict, "scene.xml: 1 warning\n");
    }
}

/// So it is with errors: an environment map that cannot be read is found, with its place and the
/// others.
#[test]
fn check_finds_all_errors_that_render_finds() {
    let inside = r#"
<shape type="sphere"><float name="radius" value="-1"/></shape>
<emitter type="envmap"><string name="filename" value="bad.exr"/></emitter>
<shape type="ply"><string name="filename" value="no.ply"/></shape>
</scene>"#;
    let place = Place::with(&format!("{VIEW}{inside}"));
    std::fs::write(place.path("bad.exr"), "no image").unwrap();
    let first = VIEW.lines().count() + 2;
    let places: Vec<_> = (0..3)
        .map(|i| format!("scene.xml:{}:", first + i))
        .collect();
    let mut parts: Vec<&str> = places.iter().map(String::as_str).collect();
    parts.extend(["\"radius\" is -1", "bad.exr", "no.ply", "3 errors"]);
    let check = place.run("check scene.xml").fails(2, &parts);
    let render = place.run("render scene.xml -o a.exr").fails(2, &parts);
    assert_eq!(check.err, render.err);
    let ran = place
        .run("render scene.xml --lenient --spp 1 -o a.exr")
        .ok();
    ran.says(&[
        "its default is used",
        "mid-grey takes its place",
        "the shape is left out",
    ]);
}

/// 8000 x 8000 pixels in 8 kB: refused with the numbers, unless the limit is raised.
#[test]
fn an_image_that_grows_beyond_measure_is_refused() {
    let sky = r#"<shape type="sphere"/><emitter type="envmap"><string name="filename" value="bomb.png"/></emitter></scene>"#;
    let place = Place::with(&format!("{VIEW}{sky}"));
    write_black_png(&place.path("bomb.png"), 8000);
    let numbers = [
        "8000 x 8000 pixels",
        "732.4 MiB",
        "512.0 MiB",
        "--limit-decoded 733M",
    ];
    for command in ["check scene.xml", "render scene.xml -o a.exr"] {
        let words = format!("{command} --limit-decoded 512M");
        place.run(&words).fails(2, &numbers);
    }
    let model = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    std::fs::write(place.path("a.obj"), model).unwrap();
    let words = "render a.obj --envmap bomb.png --limit-decoded 512M -o a.exr";
    place.run(words).fails(2, &numbers);
}

#[test]
fn files_of_other_programs_are_named_wherever_they_are_given() {
    let place = Place::replacing(
        "</scene>",
        r#"<emitter type="envmap"><string name="filename" value="sky.exr"/></emitter></scene>"#,
    );
    let pointer = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n";
    let files: [(&str, &[u8], &str); 9] = [
        ("sky.exr", pointer, "git lfs pull"),
        ("a.obj", pointer, "git lfs pull"),
        ("a.glb", b"<!DOCTYPE html><html>", "web page"),
        ("a.ply", b"\x1f\x8b\x08\0", "gunzip"),
        ("a.xml.gz", b"\x1f\x8b\x08\0", "gunzip"),
        ("a.blend", b"BLENDER-v300", "Blender"),
        ("a.fbx", b"Kaydara FBX Binary  ", "FBX"),
        ("a.usda", b"#usda 1.0", "USD"),
        ("a.pbrt", b"MakeNamedMaterial", "pbrt"),
    ];
    for (name, content, words) in files {
        std::fs::write(place.path(name), content).unwrap();
        let file = if name == "sky.exr" { "scene.xml" } else { name };
        place.run(&format!("check {file}")).fails(2, &[name, words]);
    }
    let ran = place.run("compare sky.exr -r sky.exr");
    ran.fails(2, &["sky.exr", "git lfs pull"]);
}

/// A spherical camera sees what is around it, latitude by longitude: a lamp to its right is there.
#[test]
fn a_spherical_camera_sees_all_around() {
    let scene = r#"<scene version="0.6.0"><integrator type="path"/>
<sensor type="spherical"><film type="tiledhdrfilm"><integer name="width" value="32"/><integer name="height" value="16"/><rfilter type="box"/></film></sensor>
<shape type="sphere"><point name="center" x="2"/><float name="radius" value="0.6"/><emitter type="area"/></shape>
<shape type="sphere"><point name="center" y="2"/><float name="radius" value="0.5"/><emitter type="area"><rgb name="radiance" value="2"/></emitter></shape></scene>"#;
    let place = Place::with(scene);
    place.run("render scene.xml --spp 4 -o a.exr").ok();
    let (width, pixels) = read_exr(&place.path("a.exr"));
    // Directions are (sin phi sin theta, cos theta, -cos phi sin theta): +x is a quarter along the
    // rows. The far corner of its pixel is 15.9 degrees away, the rim of the ball 17.5.
    for (x, y, expected) in [
        (8, 8, 1.0),
        (24, 8, 0.0),
        (8, 15, 0.0),
        (0, 0, 2.0),
        (31, 0, 2.0),
    ] {
        let found = pixels[y * width + x][0];
        assert!((found - expected).abs() < 1e-3, "{x} {y}: {found}");
    }
}

/// A mesh that is flat as a line is left out with a word, and the rest is rendered.
#[test]
fn a_mesh_without_area_is_left_out() {
    let place = Place::replacing(
        "</scene>",
        r#"<shape type="obj"><string name="filename" value="flat.obj"/></shape></scene>"#,
    );
    let line = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
    std::fs::write(place.path("flat.obj"), line).unwrap();
    let ran = place.run("check scene.xml").ok();
    ran.says(&["flat.obj", "the shape is left out"]);
    // A file without a single face is a mistake.
    std::fs::write(place.path("flat.obj"), "v 0 0 0\n").unwrap();
    place
        .run("check scene.xml")
        .fails(2, &["flat.obj", "no triangle"]);
}
