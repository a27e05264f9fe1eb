//! Paths that have no end: the time and Ctrl-C end them.

use super::support::{Place, read_exr, read_until, signal, wait};
use std::io::BufReader;
use std::time::{Duration, Instant};

/// A white room without a window, which swallows no light. What is put in its place changes that.
const ROOM: &str = r#"<scene version="3.0.0">
  <integrator type="path">
    <integer name="max_depth" value="-1"/><integer name="rr_depth" value="1000000000"/>
  </integrator>
  <sensor type="perspective">
    <transform name="to_world"><lookat origin="0,0,0.9" target="0,0,0" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="40"/><integer name="height" value="20"/></film>
  </sensor>
  <shape type="cube">
    <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></bsdf>
  </shape>
  MORE
</scene>
"#;

const LAMP: &str = r#"<emitter type="point"><rgb name="intensity" value="1"/></emitter>"#;

fn room(more: &str) -> Place {
    Place::with(&ROOM.replace("MORE", more))
}

/// What the walls are made of, and mirrors in its place.
const WHITE: &str = r#"<bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>"#;
const MIRROR: &str = r#"<bsdf type="conductor"><string name="material" value="none"/></bsdf>"#;

#[test]
fn the_time_ends_paths_without_an_end() {
    let mirrors = ROOM.replace(WHITE, MIRROR);
    assert_ne!(mirrors, ROOM);
    for (scene, more, words) in [
        (ROOM, "", ""),
        (ROOM, LAMP, "--sampler sobol"),
        (&mirrors, LAMP, ""),
    ] {
        let start = Instant::now();
        let place = Place::with(&scene.replace("MORE", more));
        place
            .run(&format!("render scene.xml -o a.exr --time 1s {words}"))
            .fails(1, &["no sample was finished", "--max-depth"]);
        assert!(start.elapsed() < Duration::from_secs(30), "{words}");
        assert_eq!(place.files(), ["scene.xml"]);
    }
}

#[test]
fn ctrl_c_ends_paths_without_an_end() {
    for words in ["", "--checkpoint 60s"] {
        let place = room(LAMP);
        let mut child = place.spawn(&format!("render scene.xml -o a.exr {words}"));
        let mut messages = BufReader::new(child.stderr.take().unwrap());
        read_until(&mut messages, "they may have no end");
        signal(&child, "INT");
        assert_eq!(wait(child).code, Some(130));
        assert_eq!(place.files(), ["scene.xml"]);
    }
}

/// A lamp right before the camera covers the left half of its view, where rendering begins, and is
/// as good as nothing to the paths of the other half: one of 10^8 bounces ends there.
const HALF: &str = r#"<shape type="rectangle">
    <transform name="to_world"><scale value="0.0001"/><translate x="-0.0001" z="0.8999"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
    <emitter type="area"><rgb name="radiance" value="1"/></emitter>
  </shape>"#;

/// Pixels of the image that are as bright as the lamp, and those that are black.
fn bright_and_black(place: &Place) -> (usize, usize) {
    let (_, pixels) = read_exr(&place.path("a.exr"));
    let count = |value: f32| pixels.iter().filter(|p| p[0] == value).count();
    (count(1.0), count(0.0))
}

/// What is kept are tiles whose paths have ended, and nothing of a wave in which some had not: the
/// short paths of the other half meet the lamp, if anything, and would make it too bright.
#[test]
fn what_has_ended_is_kept_and_nothing_of_the_rest() {
    let scene = ROOM.replace("MORE", HALF);
    let scene = scene.replace("value=\"40\"", "value=\"64\"");
    // Out of a sphere nothing escapes. Of a million bounces in a cube one is so near to an edge that
    // rounding carries it outside, and that path has an end.
    let scene = scene.replace("\"cube\"", "\"sphere\"");
    let scene = scene.replace(
        "<film",
        "<float name=\"near_clip\" value=\"0.00001\"/><film",
    );
    let place = Place::with(&scene);
    place
        .run("render scene.xml -o a.exr --guide none --time 2s")
        .ok()
        .says(&["given up", "have no sample yet", "wrote a.exr"]);
    let (bright, black) = bright_and_black(&place);
    assert!(bright >= 16 * 20 && black >= 16 * 20, "{bright} {black}");
    assert!(bright + black == 64 * 20, "{bright} {black}");

    let mut child = place.spawn("render scene.xml -o a.exr --guide none --spp 4 --stats s.json");
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    read_until(&mut messages, "they may have no end");
    signal(&child, "INT");
    assert_eq!(wait(child).code, Some(130));
    let (bright, black) = bright_and_black(&place);
    assert!(
        black >= 16 * 20 && bright + black == 64 * 20,
        "{bright} {black}"
    );
}

#[test]
fn a_limit_of_the_length_ends_them_as_the_message_says() {
    let place = room(LAMP);
    place
        .run("render scene.xml -o a.exr --spp 1 --max-depth 100")
        .ok();
    place
        .run("render scene.xml --pixel 1,1 --max-depth unlimited")
        .ok()
        .says(&["goes on after 100000 edges"]);
}
