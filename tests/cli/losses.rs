//! What a render needs is taken away: its meshes, its memory. What was made before stays.

use super::support::{Place, Ran, read_channels, signal, wait};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A sheet before the wall.
const SHEET: &str = r#"<shape type="obj"><string name="filename" value="sheet.obj"/></shape>
</scene>"#;
const OBJ: &str = "v -1 -1 0.5\nv 1 -1 0.5\nv 0 1 0.5\nf 1 2 3\n";

const RENDER: &str = "render scene.xml --width 96 --height 72 --format float --spp 300";

/// A place with a mesh, and the numbers of the image when nothing happens to it.
fn with_a_sheet() -> (Place, Vec<(String, Vec<u32>)>) {
    let place = Place::replacing("</scene>", SHEET);
    std::fs::write(place.path("sheet.obj"), OBJ).unwrap();
    place.run(&format!("{RENDER} -o whole.exr")).ok();
    let whole = read_channels(&place.path("whole.exr"));
    (place, whole)
}

/// A render that has just written its first checkpoint.
fn under_way(place: &Place) -> Child {
    let mut child = place.spawn(&format!("{RENDER} -o out.exr --checkpoint 30ms"));
    let start = Instant::now();
    while !place.path("out.exr.checkpoint").exists() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        assert!(start.elapsed() < Duration::from_secs(60), "no checkpoint");
        std::thread::sleep(Duration::from_millis(2));
    }
    child
}

#[test]
fn a_mesh_that_vanishes_during_a_render_is_not_missed() {
    let (place, whole) = with_a_sheet();
    let child = under_way(&place);
    std::fs::remove_file(place.path("sheet.obj")).unwrap();
    wait(child).ok();
    assert!(read_channels(&place.path("out.exr")) == whole);
}

#[test]
fn a_mesh_that_is_gone_or_another_stops_a_resume_and_costs_nothing() {
    let (place, whole) = with_a_sheet();
    let child = under_way(&place);
    signal(&child, "TERM");
    assert_eq!(wait(child).code, Some(75));
    let kept = (place.read("out.exr.checkpoint"), place.read("out.exr"));
    let resume = format!("{RENDER} -o out.exr --resume");
    std::fs::remove_file(place.path("sheet.obj")).unwrap();
    place.run(&resume).fails(2, &["sheet.obj", "scene.xml:"]);
    std::fs::write(place.path("sheet.obj"), OBJ.replace("0 1 0.5", "0 2 0.5")).unwrap();
    place.run(&resume).fails(2, &["the scenes differ"]);
    std::fs::write(place.path("sheet.obj"), &OBJ[..OBJ.len() - 6]).unwrap();
    place.run(&resume).fails(2, &["sheet.obj"]);
    assert!(kept == (place.read("out.exr.checkpoint"), place.read("out.exr")));
    std::fs::write(place.path("sheet.obj"), OBJ).unwrap();
    place.run(&resume).ok();
    assert!(read_channels(&place.path("out.exr")) == whole);
}

/// The number of bytes behind a key of `/proc/PID/status`.
#[cfg(target_os = "linux")]
fn held(child: &Child, key: &str) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let line = status.lines().find_map(|l| l.strip_prefix(key)).unwrap();
    line.trim()
        .trim_end_matches("kB")
        .trim()
        .parse::<u64>()
        .unwrap()
        * 1024
}

/// Memory is bounded by what the program takes for a small scene, and some more.
#[cfg(target_os = "linux")]
#[test]
fn a_tree_that_does_not_fit_is_refused_in_words() {
    let place = Place::new();
    place
        .run("make mesh --kind terrain --triangles 4M -o large.ply")
        .ok();
    std::fs::write(place.path("a.exr"), "an older file").unwrap();
    // A shard does not load OpenImageIO, and the large scene does so after its trees are built.
    let child =
        place.spawn("render scene.xml --shard 1/2 -o small.exr --spp 1000000000 --guide none");
    // By then it renders, with all its threads.
    std::thread::sleep(Duration::from_secs(3));
    // Not enough for 380 MiB of trees.
    let limit = held(&child, "VmSize:") + (200 << 20);
    signal(&child, "KILL");
    wait(child);
    let scene = super::support::SCENE
        .replace("</scene>", SHEET)
        .replace("obj", "ply");
    let scene = scene.replace("sheet", "large");
    std::fs::write(place.path("large.xml"), scene).unwrap();
    let bounded = Command::new("prlimit")
        .arg(format!("--as={limit}:{limit}"))
        .arg(env!("CARGO_BIN_EXE_twintree"))
        .args(["render", "large.xml", "-o", "a.exr", "--spp", "1"])
        .current_dir(place.path("."))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let Ok(child) = bounded else {
        eprintln!("skipped: memory cannot be bounded without prlimit");
        return;
    };
    let ran: Ran = wait(child);
    ran.fails(1, &["the ray tracer takes about", "are available"]);
    assert_eq!(place.read("a.exr"), b"an older file");
}
