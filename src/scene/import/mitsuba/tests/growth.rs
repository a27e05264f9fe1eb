//! What a small file may cost: time in proportion to its length, and no more for parts that are
//! held twice.

use super::Stage;
use crate::image::{Image, WriteOptions, write};
use std::time::{Duration, Instant};

/// Far above what a busy machine takes in linear time, far below what these take in quadratic.
const PATIENCE: Duration = Duration::from_secs(60);

fn timed<T>(what: &str, act: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let value = act();
    let took = start.elapsed();
    assert!(took < PATIENCE, "{what} took {took:?}");
    value
}

#[test]
fn a_hundred_thousand_objects_in_one_line() {
    let stage = Stage::new();
    let sphere = |i: usize| {
        format!(
            "<shape type='sphere' name='elm_{i}'><transform name='to_world'><translate x='{i}'/></transform></shape>"
        )
    };
    let lamp = |i: usize| {
        format!(
            "<emitter type='point' name='lamp_{i}'><point name='position' x='{i}' y='5' z='0'/></emitter>"
        )
    };
    for (what, count) in [("spheres", 100_000), ("lamps", 100_000)] {
        let make = |i| {
            if what == "spheres" {
                sphere(i)
            } else {
                lamp(i)
            }
        };
        let text: String = (0..count).map(make).collect();
        let d = timed(what, || stage.modern(&text));
        assert_eq!(d.shapes.len() + d.emitters.len(), count);
    }
}

#[test]
fn a_hundred_thousand_warnings_in_one_line() {
    let stage = Stage::new();
    let odd = |i: usize| format!("<shape type='sphere'><float name='odd_{i}' value='1'/></shape>");
    let text: String = (0..100_000).map(odd).collect();
    let d = timed("warnings", || stage.modern(&text));
    assert_eq!(d.warnings.len(), 100_000);
}

#[test]
fn a_hundred_thousand_names_and_parameters() {
    let stage = Stage::new();
    let text: String = (0..100_000)
        .map(|i| format!("<default name='n{i}' value='{i}'/><float name='p{i}' value='$n{i}'/>"))
        .collect();
    let d = timed("names", || stage.modern(&text));
    assert!(d.warnings.len() >= 100_000);
}

/// Textures, shapes and integrators that each hold the next one twice, thirty deep.
#[test]
fn what_is_held_twice_does_not_grow_for_ever() {
    let twice = |tag: &str, plugin: &str, names: [&str; 2], inmost: &str| -> String {
        let mut text = inmost.to_owned();
        for i in 1..32 {
            let refs = names
                .map(|n| format!("<ref {n} id='x{}'/>", i - 1))
                .concat();
            text += &format!("<{tag} type='{plugin}' id='x{i}'>{refs}</{tag}>");
        }
        text
    };
    let board = twice(
        "texture",
        "checkerboard",
        ["name='color0'", "name='color1'"],
        "<texture type='checkerboard' id='x0'/>",
    ) + "<shape type='sphere'><bsdf type='diffuse'><ref name='reflectance' id='x31'/></bsdf></shape>";
    let error = timed("textures", || Stage::new().error(&board)).to_string();
    assert!(error.contains("made of more than 256"), "{error}");

    let merge = twice("shape", "merge", ["", ""], "<shape type='merge' id='x0'/>");
    let error = timed("shapes", || Stage::new().error(&merge)).to_string();
    assert!(error.contains("hold others more than"), "{error}");

    let nested = twice(
        "integrator",
        "moment",
        ["", ""],
        "<integrator type='path' id='x0'/>",
    );
    let error = timed("integrators", || Stage::new().error(&nested)).to_string();
    assert!(error.contains("hold others more than"), "{error}");
}

/// Ten levels of files that each include the next one twenty times, and no object in any of them.
#[test]
fn includes_do_not_grow_for_ever() {
    let stage = Stage::new();
    for i in 0..9 {
        let include = format!("<include filename='f{}.xml'/>", i + 1).repeat(20);
        stage.file(
            &format!("f{i}.xml"),
            &format!("<scene version='3.0.0'>{include}</scene>"),
        );
    }
    stage.file("f9.xml", "<scene version='3.0.0'/>");
    let error = timed("includes", || stage.error("<include filename='f0.xml'/>"));
    assert!(
        error.to_string().contains("more than 10000 files"),
        "{error}"
    );
}

/// A texture or an environment map that is enormous beside its file is refused with the numbers,
/// and the limit can be raised.
#[test]
fn images_that_grow_too_much_are_refused() {
    let mut stage = Stage::new().with_files();
    let mut flat = Image::new(1024, 1024, &["R", "G", "B"]);
    flat.pixels.fill(0.25);
    write(&stage.path("flat.exr"), &flat, &WriteOptions::default()).unwrap();
    let texture = "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='flat.exr'/></texture></bsdf></shape>";
    let sky = "<shape type='sphere'/><emitter type='envmap'><string name='filename' value='flat.exr'/></emitter>";
    for inside in [texture, sky] {
        stage.limit(1 << 20);
        let message = stage.error(inside).to_string();
        for part in ["1024 x 1024 pixels", "MiB", "--limit-decoded"] {
            assert!(message.contains(part), "{part}: {message}");
        }
        stage.limit(1 << 30);
        assert_eq!(stage.modern(inside).warnings, [""; 0]);
    }
}

#[test]
fn serialized_meshes_that_grow_too_much_are_refused() {
    use std::io::Write as _;
    let mut stage = Stage::new().with_files();
    // A million vertices at one place and one triangle: 12 MB of zeros, deflated.
    let count = 1_000_000u64;
    let mut content = 0x1000u32.to_le_bytes().to_vec();
    content.push(0);
    content.extend(count.to_le_bytes());
    content.extend(1u64.to_le_bytes());
    content.resize(content.len() + 12 * count as usize, 0);
    content.extend([0u32, 1, 2].iter().flat_map(|i| i.to_le_bytes()));
    let mut file = vec![0x1c, 0x04, 4, 0];
    let mut zlib = flate2::write::ZlibEncoder::new(&mut file, flate2::Compression::best());
    zlib.write_all(&content).unwrap();
    zlib.finish().unwrap();
    std::fs::write(stage.path("a.serialized"), file).unwrap();
    let shape = "<shape type='sphere'/><shape type='serialized'><string name='filename' value='a.serialized'/></shape>";
    stage.limit(1 << 20);
    let message = stage.error(shape).to_string();
    for part in ["1000000 vertices", "MiB", "--limit-decoded"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    stage.limit(1 << 26);
    // It has no area, and that is all that is wrong with it.
    let d = stage.modern(shape);
    assert_eq!(d.shapes.len(), 1);
    assert!(
        d.warnings[0].contains("the shape is left out"),
        "{:?}",
        d.warnings
    );
}
