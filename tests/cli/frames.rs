//! Sequences: `render --frames`.

use super::support::{Place, read_channels, signal, wait};
use std::time::{Duration, Instant};

/// The camera moves with the frame.
fn moving() -> Place {
    Place::replacing("origin=\"0, 0, 4\"", "origin=\"0.$frame, 0, 4\"")
}

const FRAMES: &str = "render scene.xml --frames 1-3 --format float -o out.##.exr";

#[test]
fn every_frame_has_a_file_a_seed_and_its_number() {
    let place = moving();
    let said = place.run(FRAMES).ok().err;
    assert!(said.contains("frame 2, 2 of 3, --seed 2"), "{said}");
    let names = ["out.01.exr", "out.02.exr", "out.03.exr", "scene.xml"];
    assert_eq!(place.files(), names);
    let single = "render scene.xml -D frame=2 --seed 2 --format float -o single.exr";
    place.run(single).ok();
    let numbers = |name: &str| read_channels(&place.path(name));
    assert!(numbers("out.02.exr") == numbers("single.exr"));
    assert!(numbers("out.02.exr") != numbers("out.03.exr"));
}

#[test]
fn scenes_and_values_may_hold_the_number() {
    let place = moving();
    let text = place.read("scene.xml");
    std::fs::write(place.path("shot.0007.xml"), &text).unwrap();
    let one = "render shot.####.xml -D frame=2 --frames 7";
    place.run(one).ok();
    let at = "render scene.xml -D frame=#1 --frames 7,8x2 --stats s.#.json -o a.#.png";
    place.run(at).ok();
    for name in ["shot.0007.exr", "a.7.png", "a.8.png", "s.8.json"] {
        assert!(place.path(name).exists(), "{name}");
    }
    let missing = "render shot.####.xml -D frame=2 --frames 7-8";
    place.run(missing).fails(2, &["there is no shot.0008.xml"]);
}

#[test]
fn frames_that_would_be_one_file_are_refused() {
    let place = moving();
    let one = "render scene.xml --frames 1-3 -o out.exr";
    place
        .run(one)
        .fails(2, &["every frame would be written to out.exr", "####"]);
    let shard = "render scene.xml --frames 1-3 --shard 0/2 -o a.#.exr";
    place.run(shard).fails(2, &["--shard"]);
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn what_is_there_is_left_alone_and_an_interrupted_frame_is_not_written() {
    let place = moving();
    std::fs::write(place.path("out.02.exr"), "kept").unwrap();
    place.run(&format!("{FRAMES} --resume")).ok();
    assert_eq!(place.read("out.02.exr"), b"kept");
    assert!(place.path("out.03.exr").exists());
    let long = "render scene.xml --frames 5-9 --width 96 --spp 4 -o long.#.exr";
    let child = place.spawn(&format!("{long} --time 2s"));
    let start = Instant::now();
    while !place.path("long.5.exr").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "no first frame");
        std::thread::sleep(Duration::from_millis(2));
    }
    signal(&child, "INT");
    assert_eq!(wait(child).code, Some(130));
    let whole = |n: u32| read_channels(&place.path(&format!("long.{n}.exr"))).len();
    let there = (5..10).filter(|n| place.path(&format!("long.{n}.exr")).exists());
    let there: Vec<u32> = there.collect();
    assert!(there.len() < 5, "nothing was interrupted");
    assert!(there.iter().all(|&n| whole(n) == 3));
}
