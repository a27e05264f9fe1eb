//! What a render needs is taken away: its meshes, its memory. What was made before stays.

use super::support::{Place, Ran, read_channels, signal, wait};
use std::process::{Child, Command};
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

/// The program waits for a scene that comes through a pipe; meanwhile its memory is bounded.
#[cfg(target_os = "linux")]
#[test]
fn a_tree_that_does_not_fit_is_refused_in_words() {
    let place = Place::with("");
    place
        .run("make mesh --kind terrain --triangles 4M -o large.ply")
        .ok();
    std::fs::write(place.path("a.exr"), "an older file").unwrap();
    let pipe = place.path("slow.xml");
    assert!(
        Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let child = place.spawn("render slow.xml -o a.exr --spp 1");
    let mut writer = std::fs::OpenOptions::new().write(true).open(&pipe).unwrap();
    // Enough for the mesh (170 MB, its file included), not for 400 MB of trees beside it.
    let limit = held(&child, "VmSize:") + (450 << 20);
    let bounded = Command::new("prlimit")
        .args([
            "--pid",
            &child.id().to_string(),
            &format!("--as={limit}:{limit}"),
        ])
        .status();
    if !bounded.is_ok_and(|s| s.success()) {
        eprintln!("skipped: memory cannot be bounded without prlimit");
        signal(&child, "KILL");
        wait(child);
        return;
    }
    let scene = super::support::SCENE
        .replace("</scene>", SHEET)
        .replace("obj", "ply");
    let scene = scene.replace("sheet", "large");
    std::io::Write::write_all(&mut writer, scene.as_bytes()).unwrap();
    drop(writer);
    let ran: Ran = wait(child);
    ran.fails(1, &["the ray tracer takes about", "are available"]);
    assert_eq!(place.read("a.exr"), b"an older file");
}
