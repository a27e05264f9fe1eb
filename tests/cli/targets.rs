//! What is in the place of an output: found out before anything is rendered.

use super::support::{Place, ignores_hangups, make_pipe, read_exr, read_until, signal, wait};
use std::io::{BufReader, Read};
use std::os::unix::fs::{FileTypeExt, symlink};
use std::time::{Duration, Instant};

/// A render that would take for ever if it began.
const LONG: &str = "render scene.xml --spp 1000000000";

#[test]
fn two_outputs_of_one_name_and_outputs_over_inputs_are_refused() {
    let place = Place::new();
    place.run("render scene.xml -o r.exr --aov variance").ok();
    std::fs::write(place.path("m.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    symlink("a.exr", place.path("b.exr")).unwrap();
    let before = place.read("r.exr");
    for (words, parts) in [
        (format!("{LONG} -o a.exr --stats a.exr"), ["-o", "--stats"]),
        (format!("{LONG} -o a.exr -o ./a.exr"), ["a.exr", "twice"]),
        (format!("{LONG} -o a.exr -o b.exr"), ["b.exr", "twice"]),
        (
            format!("{LONG} -o a.exr --checkpoint 1m --stats a.exr.checkpoint"),
            ["--checkpoint", "--stats"],
        ),
        (
            format!("{LONG} -o r.exr --reference r.exr"),
            ["r.exr", "the reference"],
        ),
        (
            format!("{LONG} -o a.exr --stats scene.xml"),
            ["scene.xml", "what is rendered"],
        ),
        (
            "render m.obj --envmap r.exr -o r.exr".into(),
            ["r.exr", "the environment map"],
        ),
        (
            "render m.obj -o a.exr --stats m.obj".into(),
            ["m.obj", "what is rendered"],
        ),
        (
            "compare r.exr -r r.exr --json r.exr".into(),
            ["r.exr", "one of the images"],
        ),
        (
            "compare r.exr -r r.exr --json c.exr -o c.exr".into(),
            ["--json", "-o"],
        ),
        (
            "train scene.xml -o scene.xml".into(),
            ["scene.xml", "learned from"],
        ),
    ] {
        place.run(&words).fails(2, &parts);
    }
    assert!(place.read("r.exr") == before);
    assert_eq!(place.files(), ["b.exr", "m.obj", "r.exr", "scene.xml"]);
}

#[test]
fn parts_and_fields_are_not_replaced_by_their_sum() {
    let place = Place::new();
    for i in 0..2 {
        place
            .run(&format!("render scene.xml --shard {i}/2 -o {i}.exr"))
            .ok();
    }
    let parts = ["is one of the parts"];
    place.run("merge 0.exr 1.exr -o 0.exr").fails(2, &parts);
    place.run("merge 0.exr 1.exr -o a.exr").ok();
    place
        .run("train scene.xml -o a.field --photons 3000 --paths 0")
        .ok();
    let fields = ["is one of the fields"];
    place
        .run("merge-fields a.field -o a.field")
        .fails(2, &fields);
    // An image that the scene reads.
    let textured = super::support::SCENE.replace(
        r#"<rgb name="reflectance" value="0.5, 0.4, 0.3"/>"#,
        r#"<texture name="reflectance" type="bitmap"><string name="filename" value="a.exr"/></texture>"#,
    );
    std::fs::write(place.path("textured.xml"), textured).unwrap();
    place
        .run("render textured.xml -o a.exr")
        .fails(2, &["an image of the scene"]);
}

#[test]
fn names_that_cannot_be_are_refused_before_rendering() {
    let place = Place::new();
    let long = "x".repeat(300);
    // Room for the image, but not for its checkpoint.
    let nearly = "x".repeat(246);
    std::fs::write(place.path("locked.exr"), "old").unwrap();
    let mut permissions = std::fs::metadata(place.path("locked.exr"))
        .unwrap()
        .permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(place.path("locked.exr"), permissions).unwrap();
    make_pipe(&place.path("pipe.exr"));
    symlink("pipe.exr", place.path("link.exr")).unwrap();
    symlink("loop.exr", place.path("loop.exr")).unwrap();
    let files = place.files();
    for (words, part) in [
        (format!("-o {long}.exr"), "too long"),
        (format!("-o a.exr --stats {long}.json"), "too long"),
        (format!("-o {nearly}.exr --checkpoint 1m"), "too long"),
        ("-o locked.exr".into(), "read-only"),
        ("-o pipe.exr".into(), "no regular file"),
        ("-o link.exr".into(), "no regular file"),
        ("-o loop.exr".into(), "links"),
        ("-o a.exr --stats /dev/full".into(), "no regular file"),
        ("-o a.exr --stats /dev/null".into(), "no regular file"),
        ("-o a.exr/b.exr".into(), "a.exr"),
    ] {
        place
            .run(&format!("{LONG} {words}"))
            .fails(1, &[part, "cannot be written", "help: "]);
    }
    assert_eq!(place.files(), files);
    assert_eq!(place.read("locked.exr"), b"old");
    let pipe = std::fs::symlink_metadata(place.path("pipe.exr")).unwrap();
    assert!(pipe.file_type().is_fifo());
    // Others write files, too.
    for words in [
        "make mesh --kind terrain --triangles 1k -o pipe.ply",
        "train scene.xml --photons 1000 --paths 0 -o pipe.field",
    ] {
        let pipe = place.path(words.rsplit(' ').next().unwrap());
        make_pipe(&pipe);
        place.run(words).fails(1, &["no regular file"]);
        assert!(
            std::fs::symlink_metadata(pipe)
                .unwrap()
                .file_type()
                .is_fifo()
        );
    }
}

#[test]
fn what_a_link_names_is_written_and_the_link_stays() {
    let place = Place::new();
    std::fs::create_dir(place.path("far")).unwrap();
    for (link, target) in [("a.exr", "far/b.exr"), ("s.json", "far/t.json")] {
        symlink(target, place.path(link)).unwrap();
    }
    place
        .run("render scene.xml -o a.exr --stats s.json --spp 1")
        .ok();
    for name in ["a.exr", "s.json"] {
        assert!(
            std::fs::symlink_metadata(place.path(name))
                .unwrap()
                .is_symlink()
        );
    }
    assert_eq!(read_exr(&place.path("far/b.exr")).0, 24);
    assert!(place.path("far/t.json").exists());
    assert_eq!(place.files(), ["a.exr", "far", "s.json", "scene.xml"]);
}

/// Whoever quits while a file is written takes the unfinished one away.
#[test]
fn no_unfinished_file_is_left_by_whoever_quits() {
    // Who runs the tests under nohup wants hang-ups ignored.
    let names = ["INT", "TERM", "HUP"];
    let heeded = names
        .iter()
        .filter(|name| **name != "HUP" || !ignores_hangups());
    for name in heeded {
        let place = Place::new();
        let child = place.spawn("make mesh --kind terrain --triangles 20M -o a.ply");
        let start = Instant::now();
        while place.files().len() < 2 {
            assert!(start.elapsed() < Duration::from_secs(60));
            std::thread::sleep(Duration::from_millis(2));
        }
        signal(&child, name);
        assert_eq!(wait(child).code, Some(130));
        assert_eq!(place.files(), ["scene.xml"], "{name}");
    }
}

#[test]
fn sigusr1_writes_the_image_so_far_and_ends_nothing() {
    let place = Place::new();
    let mut child = place.spawn(&format!("{LONG} -o a.exr"));
    let mut messages = BufReader::new(child.stderr.take().unwrap());
    // At once: a queue may ask before the first sample is taken.
    read_until(&mut messages, "read in");
    for _ in 0..2 {
        signal(&child, "USR1");
        read_until(&mut messages, "wrote a.exr");
        assert_eq!(read_exr(&place.path("a.exr")).0, 24);
    }
    assert!(child.try_wait().unwrap().is_none(), "it ended");
    signal(&child, "INT");
    assert_eq!(wait(child).code, Some(130));
}

#[test]
fn sigusr1_ends_no_command_that_has_nothing_to_save() {
    let place = Place::new();
    for words in [
        "render scene.xml --shard 0/2 -o a.exr --spp 30000",
        "train scene.xml -o a.field --photons 1000000 --paths 0",
    ] {
        let mut child = place.spawn(&format!("{words} --log-level debug"));
        let mut messages = BufReader::new(child.stderr.take().unwrap());
        read_until(&mut messages, "built in");
        signal(&child, "USR1");
        let mut rest = String::new();
        messages.read_to_string(&mut rest).unwrap();
        assert_eq!(wait(child).code, Some(0), "{words}: {rest}");
    }
}

#[test]
fn a_shard_says_at_its_start_that_an_interrupt_loses_it() {
    let place = Place::new();
    let said = "an interrupted shard leaves nothing";
    let shard = "render scene.xml --shard 0/2 -o a.exr";
    place.run(shard).ok().says(&[said, "--checkpoint"]);
    let ran = place.run(&format!("{shard} --checkpoint 1m")).ok();
    assert!(!ran.err.contains(said), "{ran:#?}");
}
