//! Denoising as a user meets it. What needs a real library is skipped without one.

use super::support::{Place, SCENE, read_channels, read_until, signal, wait};
use std::io::BufReader;
use twintree::image::denoise::Denoiser;

/// Whether there is a library; says so if not.
fn is_installed() -> bool {
    let found = Denoiser::find(None);
    if let Err(why) = &found {
        eprintln!("skipped: {why}");
    }
    found.is_ok()
}

fn names(place: &Place, file: &str) -> String {
    let channels = read_channels(&place.path(file)).into_iter();
    let mut names: Vec<String> = channels.map(|c| c.0).collect();
    names.sort();
    names.join(" ")
}

fn layer(place: &Place, file: &str, names: [&str; 3]) -> Vec<Vec<u32>> {
    let channels = read_channels(&place.path(file));
    let find = |name: &str| channels.iter().find(|c| c.0 == name).expect(name);
    names.iter().map(|name| find(name).1.clone()).collect()
}

const RGB: [&str; 3] = ["R", "G", "B"];
const NOISY: [&str; 3] = ["noisy.R", "noisy.G", "noisy.B"];

#[test]
fn a_library_that_is_missing_or_another_is_an_error_before_anything_is_rendered() {
    let place = Place::new();
    std::fs::create_dir(place.path("folder")).unwrap();
    place.run("render scene.xml -o noisy.exr").ok();
    for (path, part) in [
        ("nowhere", "nowhere: there is no libOpenImageDenoise.so.2"),
        ("folder", "folder: there is no libOpenImageDenoise.so.2"),
        ("scene.xml", "scene.xml: "),
    ] {
        for words in [
            format!("render scene.xml -o a.exr --denoise --oidn {path}"),
            format!("denoise noisy.exr -o a.exr --oidn {path}"),
        ] {
            let ran = place.run(&words);
            let ran = ran.fails(2, &[part, "help: --oidn and TWINTREE_OIDN name"]);
            assert!(!ran.err.contains("samples/s"), "{ran:#?}");
        }
        let mut command = place.command("render scene.xml -o a.exr --denoise");
        let output = command.env("TWINTREE_OIDN", path).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{path}");
    }
    assert_eq!(place.files(), ["folder", "noisy.exr", "scene.xml"]);
}

#[test]
fn a_library_of_something_else_is_refused() {
    let maps = std::fs::read_to_string("/proc/self/maps").unwrap();
    let libc = maps.lines().find_map(|line| {
        let path = &line[line.find('/')?..];
        path.contains("/libc.so").then(|| path.to_owned())
    });
    let Some(libc) = libc else {
        eprintln!("skipped: this program has no libc.so");
        return;
    };
    let place = Place::new();
    place
        .run(&format!(
            "render scene.xml -o a.exr --denoise --oidn {libc}"
        ))
        .fails(2, &["this is no Open Image Denoise of version 2"]);
}

#[test]
fn the_noisy_picture_is_kept_beside_the_denoised_one() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    place
        .run("render scene.xml -o noisy.exr --aov variance")
        .ok();
    place
        .run("render scene.xml -o a.exr --denoise --stats s.json")
        .ok()
        .says(&["denoised in", "Open Image Denoise 2."]);
    assert_eq!(
        names(&place, "a.exr"),
        "B G R albedo.B albedo.G albedo.R noisy.B noisy.G noisy.R normal.X normal.Y normal.Z"
    );
    let noisy = layer(&place, "noisy.exr", RGB);
    assert_eq!(layer(&place, "a.exr", NOISY), noisy);
    assert_ne!(layer(&place, "a.exr", RGB), noisy);
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    assert!(stats["denoise_seconds"].as_f64() > Some(0.0), "{stats}");
    // The layers tell nothing of the denoised picture's noise.
    place
        .run("render scene.xml -o v.exr --denoise --aov variance")
        .ok();
    place
        .run("compare v.exr --reference noisy.exr --json c.json")
        .ok();
    let compared: serde_json::Value = serde_json::from_slice(&place.read("c.json")).unwrap();
    assert!(compared["images"][0]["z"].is_null(), "{compared}");
}

#[test]
fn any_number_of_threads_denoises_to_the_same_bits() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    for threads in [1, 2] {
        let words = "render scene.xml -D size=200 --denoise --format float -o";
        place
            .run(&format!("{words} {threads}.exr -j {threads}"))
            .ok();
    }
    assert_eq!(layer(&place, "1.exr", RGB), layer(&place, "2.exr", RGB));
}

#[test]
fn what_was_rendered_is_denoised_later_to_the_same_bits() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    let words = "render scene.xml --format float";
    place.run(&format!("{words} -o now.exr --denoise")).ok();
    place
        .run(&format!("{words} -o raw.exr --aov albedo,normal,depth"))
        .ok();
    let later = "denoise raw.exr -o later.exr --format float";
    let ran = place.run(later).ok();
    assert!(!ran.err.contains("warning"), "{ran:#?}");
    place
        .run("denoise later.exr -o again.exr --format float")
        .ok();
    assert!(names(&place, "later.exr").contains("depth.Z"));
    for file in ["later.exr", "again.exr"] {
        for names in [RGB, NOISY] {
            let now = layer(&place, "now.exr", names);
            assert_eq!(layer(&place, file, names), now, "{file}");
        }
    }
    place.run("render scene.xml -o bare.exr").ok();
    place
        .run("denoise bare.exr -o b.exr")
        .ok()
        .says(&["warning: bare.exr has no layers albedo and normal", "--aov"]);
    place
        .run("denoise bare.exr -o bare.exr")
        .fails(2, &["bare.exr"]);
}

/// Ids of mattes and alpha among them, and what needs 32 bits.
#[test]
fn layers_go_through_the_denoiser_as_they_are() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    place
        .run("render scene.xml --alpha --aov all --light-groups each -o a.exr")
        .ok();
    place.run("denoise a.exr -o b.exr").ok();
    let after = read_channels(&place.path("b.exr"));
    for (name, numbers) in read_channels(&place.path("a.exr")) {
        if !RGB.contains(&name.as_str()) {
            let same = after
                .iter()
                .any(|other| *other == (name.clone(), numbers.clone()));
            assert!(same, "{name} has changed");
        }
    }
}

#[test]
fn parts_are_denoised_when_they_are_merged() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    let words = "--format float --denoise";
    place
        .run(&format!("render scene.xml -o whole.exr {words}"))
        .ok();
    for i in 0..2 {
        let ran = place.run(&format!(
            "render scene.xml --shard {i}/2 -o p{i}.exr --denoise"
        ));
        ran.ok()
            .says(&["--denoise has no effect", "twintree merge"]);
    }
    place
        .run(&format!("merge p0.exr p1.exr -o merged.exr {words}"))
        .ok();
    assert_eq!(
        layer(&place, "whole.exr", RGB),
        layer(&place, "merged.exr", RGB)
    );
}

#[test]
fn an_interrupt_ends_the_denoiser_and_keeps_the_noisy_picture() {
    if !is_installed() {
        return;
    }
    let large = SCENE.replace("value=\"18\"", "value=\"1800\"");
    let place = Place::with(&large);
    let mut child = place.spawn("render scene.xml -o a.exr --denoise --spp 1 -D size=2400");
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    read_until(&mut messages, "all samples are taken");
    std::thread::sleep(std::time::Duration::from_millis(300));
    signal(&child, "INT");
    read_until(&mut messages, "the picture is not denoised");
    let ran = wait(child);
    assert_eq!(ran.code, Some(130), "{ran:#?}");
    let names = names(&place, "a.exr");
    assert!(
        names.contains("albedo.R") && !names.contains("noisy"),
        "{names}"
    );
}

#[test]
fn an_interrupted_render_is_denoised() {
    if !is_installed() {
        return;
    }
    let place = Place::new();
    let mut child = place.spawn("render scene.xml -o a.exr --denoise --spp 1000000000");
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    read_until(&mut messages, " samples/s");
    signal(&child, "INT");
    read_until(&mut messages, "denoised in");
    assert_eq!(wait(child).code, Some(130));
    assert!(names(&place, "a.exr").contains("noisy.R"));
}
