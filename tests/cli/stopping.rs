//! What ends a render.

use super::support::{Place, read_exr, read_until, signal, wait};
use std::io::{BufReader, Read};
use std::process::Child;

fn stats(place: &Place) -> serde_json::Value {
    serde_json::from_slice(&place.read("s.json")).unwrap()
}

#[test]
fn time_stops_a_render_whose_scene_asks_for_fewer_samples() {
    let place = Place::new();
    let ran = place
        .run("render scene.xml -o a.exr --time 1s --stats s.json")
        .ok();
    ran.says(&["the time is up"]);
    let stats = stats(&place);
    assert_eq!(stats["stopped_by"], "time");
    assert!(stats["spp"].as_u64() > Some(4), "{stats}");
    let seconds = stats["render_seconds"].as_f64().unwrap();
    assert!((0.5..4.0).contains(&seconds), "{seconds}");
}

#[test]
fn samples_stop_a_render_before_its_time() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr --time 1h --spp 3 --stats s.json")
        .ok();
    assert_eq!(stats(&place)["stopped_by"], "samples");
    assert_eq!(stats(&place)["spp"], 3);
}

#[test]
fn noise_stops_a_render() {
    let place = Place::new();
    let ran = place
        .run("render scene.xml -o a.exr --noise 0.05 --stats s.json")
        .ok();
    ran.says(&["stops at a noise of 0.05", "clean enough"]);
    let stats = stats(&place);
    assert_eq!(stats["stopped_by"], "noise");
    assert!(stats["noise"].as_f64().unwrap() <= 0.05, "{stats}");
}

/// Starts a render that would never end, and waits until samples are taken.
fn endless(place: &Place) -> (Child, BufReader<impl Read>) {
    let mut child = place.spawn("render scene.xml -o a.exr --spp 1000000000 --stats s.json");
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    read_until(&mut messages, " samples/s");
    (child, messages)
}

#[test]
fn an_interrupt_writes_the_image_so_far() {
    for name in ["INT", "TERM"] {
        let place = Place::new();
        std::fs::write(place.path("a.exr"), "an older file").unwrap();
        let (child, mut messages) = endless(&place);
        signal(&child, name);
        let ran = wait(child);
        let mut rest = String::new();
        messages.read_to_string(&mut rest).unwrap();
        assert_eq!(ran.code, Some(130), "{name} {rest}");
        assert!(rest.contains("wrote a.exr"), "{rest}");
        assert_eq!(place.files(), ["a.exr", "s.json", "scene.xml"]);
        assert_eq!(stats(&place)["stopped_by"], "interrupt");
        let (_, pixels) = read_exr(&place.path("a.exr"));
        assert!(pixels.iter().all(|p| p[0] > 0.0), "every pixel had samples");
    }
}

#[test]
fn an_interrupt_while_the_scene_is_read_leaves_nothing() {
    let place = Place::new();
    place
        .run("make mesh --kind terrain --triangles 4M -o large.ply")
        .ok();
    let mut child = place.spawn("render large.ply -o a.exr");
    let maps = format!("/proc/{}/maps", child.id());
    while !std::fs::read_to_string(&maps).is_ok_and(|maps| maps.contains("large.ply")) {
        assert!(child.try_wait().unwrap().is_none(), "it ended");
    }
    signal(&child, "INT");
    let ran = wait(child);
    assert_eq!(ran.code, Some(130), "{ran:#?}");
    assert!(!place.path("a.exr").exists());
}

#[test]
fn a_viewer_that_goes_away_does_not_end_a_render() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let viewer = std::thread::spawn(move || drop(listener.accept()));
    let place = Place::new();
    let words = format!("render scene.xml -o a.exr --time 2s --preview tev={address}");
    let ran = place.run(&words).ok();
    viewer.join().unwrap();
    ran.says(&["warning: the preview ends", "wrote a.exr"]);
}
