//! Renders that end early and go on: `--checkpoint`, `--resume`, signals, full disks.

use super::support::{Place, Ran, read_channels, signal, wait};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Samples take a second or so in all; every bit of every layer is compared.
const PICTURE: &str = "--width 96 --height 72 --format float --aov all";
const FILES: [&str; 3] = ["out.exr", "out.exr.checkpoint", "scene.xml"];

fn words(spp: u32, rest: &str) -> String {
    format!("render scene.xml {PICTURE} --spp {spp} -o out.exr {rest}")
}

/// The numbers of the image that was never interrupted.
fn uninterrupted(place: &Place, spp: u32, rest: &str) -> Vec<(String, Vec<u32>)> {
    let whole = words(spp, rest).replace("out.exr", "whole.exr");
    place.run(&whole).ok();
    let numbers = read_channels(&place.path("whole.exr"));
    std::fs::remove_file(place.path("whole.exr")).unwrap();
    numbers
}

/// Waits until the file is there, while the render runs. (An empty one is the program trying
/// whether it may write there.)
fn wait_for(place: &Place, name: &str, child: &mut Child) {
    let start = Instant::now();
    let written = || std::fs::metadata(place.path(name)).is_ok_and(|m| m.len() > 0);
    while !written() {
        assert!(child.try_wait().unwrap().is_none(), "it ended by itself");
        assert!(start.elapsed() < Duration::from_secs(60), "no {name}");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Waits until the program catches SIGUSR1, which would end it before.
fn wait_for_handler(child: &Child) {
    const USR1: u64 = 1 << 9;
    let start = Instant::now();
    let caught = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
        let mask = status.lines().find_map(|l| l.strip_prefix("SigCgt:"))?;
        u64::from_str_radix(mask.trim(), 16).ok()
    };
    while caught().is_none_or(|mask| mask & USR1 == 0) {
        assert!(start.elapsed() < Duration::from_secs(60), "no handler");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// A render that has written a checkpoint and was then interrupted.
fn interrupted(place: &Place, spp: u32, rest: &str) -> Ran {
    let mut child = place.spawn(&words(spp, &format!("--checkpoint 50ms {rest}")));
    wait_for(place, "out.exr.checkpoint", &mut child);
    signal(&child, "TERM");
    wait(child)
}

/// Kills a render again and again until that happened `kills` times, and compares every image that
/// came out. Checkpoints are written as fast as they go, so that many kills hit one in the making.
fn survives(kills: u32) {
    let place = Place::new();
    let spp = 600;
    let whole = uninterrupted(&place, spp, "");
    let resume = words(spp, "--checkpoint 1ms --resume --quiet");
    let (mut killed, mut finished, mut halfway) = (0, 0, 0);
    let mut random = 12345u64;
    while killed < kills || finished == 0 {
        let mut child = place
            .command(&resume)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        random = random
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        std::thread::sleep(Duration::from_micros((random >> 33) % 400_000));
        if killed < kills && child.try_wait().unwrap().is_none() {
            child.kill().unwrap();
            child.wait().unwrap();
            killed += 1;
            halfway += u32::from(place.path("out.exr.checkpoint.new").exists());
            continue;
        }
        assert_eq!(wait(child).code, Some(0), "after {killed} kills");
        assert!(read_channels(&place.path("out.exr")) == whole);
        assert!(!place.path("out.exr.checkpoint").exists());
        finished += 1;
        std::fs::remove_file(place.path("out.exr")).unwrap();
    }
    println!("{killed} kills, {halfway} in the middle of a checkpoint, {finished} images");
}

#[test]
fn a_render_that_is_killed_goes_on_to_the_same_bits() {
    survives(8);
}

/// Some minutes: `cargo test --release --test cli killed_two_hundred -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes"]
fn a_render_that_is_killed_two_hundred_times_goes_on_to_the_same_bits() {
    survives(200);
}

#[test]
fn an_interrupt_writes_a_checkpoint_and_resume_goes_on_from_it() {
    for name in ["INT", "TERM"] {
        let place = Place::new();
        let spp = 200;
        let whole = uninterrupted(&place, spp, "");
        let mut child = place.spawn(&words(spp, "--checkpoint 50ms"));
        wait_for(&place, "out.exr.checkpoint", &mut child);
        signal(&child, name);
        let ran = wait(child);
        assert_eq!(ran.code, Some(75), "{name} {ran:#?}");
        assert_eq!(place.files(), FILES);
        assert!(read_channels(&place.path("out.exr")) != whole, "a preview");
        place
            .run(&words(spp, "--resume"))
            .ok()
            .says(&["going on from out.exr.checkpoint"]);
        assert!(read_channels(&place.path("out.exr")) == whole, "{name}");
        assert_eq!(place.files(), ["out.exr", "scene.xml"]);
    }
}

#[test]
fn guided_renders_and_shards_go_on_to_the_same_bits() {
    let guided = "--guide double --photons 20000 --paths 5000 --batches 3";
    let place = Place::new();
    let whole = uninterrupted(&place, 150, guided);
    for shard in 0..2 {
        let shard = format!("{guided} --shard {shard}/2");
        assert_eq!(interrupted(&place, 150, &shard).code, Some(75));
        assert!(!place.path("out.exr").exists(), "half a part is no part");
        place.run(&words(150, &format!("{shard} --resume"))).ok();
        let name = format!("part{}.exr", place.files().len());
        std::fs::rename(place.path("out.exr"), place.path(&name)).unwrap();
    }
    place
        .run("merge part2.exr part3.exr -o out.exr --format float --aov all")
        .ok();
    assert!(read_channels(&place.path("out.exr")) == whole);
}

/// Noise is looked at between passes: an interruption must not shift them.
#[test]
fn a_render_that_stops_at_a_noise_stops_there_after_an_interruption_too() {
    let place = Place::new();
    let stop = "--noise 0.012";
    let render = |rest: &str| words(100_000, &format!("{stop} {rest}"));
    place.run(&render("").replace("out.exr", "whole.exr")).ok();
    let mut child = place.spawn(&render("--checkpoint 20ms"));
    wait_for(&place, "out.exr.checkpoint", &mut child);
    signal(&child, "TERM");
    assert_eq!(wait(child).code, Some(75));
    place.run(&render("--resume")).ok().says(&["clean enough"]);
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("out.exr") == of("whole.exr"));
}

#[test]
fn a_user_signal_writes_a_checkpoint_and_the_render_goes_on() {
    let place = Place::new();
    let mut child = place.spawn(&words(100_000, "--checkpoint 1h"));
    wait_for_handler(&child);
    signal(&child, "USR1");
    wait_for(&place, "out.exr.checkpoint", &mut child);
    std::fs::remove_file(place.path("out.exr.checkpoint")).unwrap();
    signal(&child, "USR1");
    wait_for(&place, "out.exr.checkpoint", &mut child);
    signal(&child, "INT");
    assert_eq!(wait(child).code, Some(75));
}

#[test]
fn a_checkpoint_of_another_render_is_refused_and_says_why() {
    let place = Place::new();
    assert_eq!(interrupted(&place, 400, "--guide double").code, Some(75));
    let kept = (place.read("out.exr.checkpoint"), place.read("out.exr"));
    let refused = |words: &str, what: &str| {
        place.run(&format!("{words} --resume")).fails(
            2,
            &[
                "out.exr.checkpoint is of another render",
                what,
                "without --resume",
            ],
        );
    };
    refused(
        &words(400, "--seed 4 --guide double"),
        "--seed is 4 here and 0 in the checkpoint",
    );
    refused(&words(400, "--rfilter tent --guide double"), "--rfilter");
    refused(
        &words(400, "--guide none"),
        "--guide is None here and Double",
    );
    refused(
        &words(400, "--shard 0/2 --guide double"),
        "the shard is 0/2 here and 0/1",
    );
    refused(&words(400, "--crop 0,0,32,32 --guide double"), "--crop");
    refused(
        &words(400, "-D spp=4 -D size=25 --accel obvhs --guide double"),
        "the ray tracer",
    );
    let text = String::from_utf8(place.read("scene.xml")).unwrap();
    let moved = text.replace("value=\"0.2\"", "value=\"0.21\"");
    std::fs::write(place.path("scene.xml"), moved).unwrap();
    refused(&words(400, "--guide double"), "the scenes differ");
    assert!(kept == (place.read("out.exr.checkpoint"), place.read("out.exr")));
}

#[test]
fn more_samples_may_be_asked_for_than_before_but_not_fewer() {
    let place = Place::new();
    // What a field learns follows from the number of samples.
    let plain = "--guide none";
    let whole = uninterrupted(&place, 300, plain);
    assert_eq!(interrupted(&place, 250, plain).code, Some(75));
    place
        .run(&words(1, "--guide none --resume"))
        .fails(2, &["more than the 1 to render", "--spp"]);
    place.run(&words(300, "--guide none --resume")).ok();
    assert!(read_channels(&place.path("out.exr")) == whole);
}

#[test]
fn a_damaged_checkpoint_is_refused_and_stays() {
    let place = Place::new();
    assert_eq!(interrupted(&place, 400, "").code, Some(75));
    let mut bytes = place.read("out.exr.checkpoint");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 4;
    std::fs::write(place.path("out.exr.checkpoint"), &bytes).unwrap();
    place
        .run(&words(400, "--resume"))
        .fails(2, &["out.exr.checkpoint", "damaged"]);
    assert!(place.read("out.exr.checkpoint") == bytes);
}

/// The viewer takes the connection and never reads: the render hangs in it after the first
/// interrupt.
#[test]
fn a_second_interrupt_quits_at_once() {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let viewer = format!("--preview tev={}", listener.local_addr().unwrap());
    let place = Place::new();
    let child = place.spawn(&format!(
        "render scene.xml --width 2048 --height 1536 --spp 9 -o out.exr --checkpoint 1h {viewer}"
    ));
    let deaf = listener.accept().unwrap();
    std::thread::sleep(Duration::from_millis(700));
    signal(&child, "INT");
    std::thread::sleep(Duration::from_millis(200));
    signal(&child, "INT");
    let start = Instant::now();
    let ran = wait(child);
    drop(deaf);
    assert_eq!(ran.code, Some(130), "{ran:#?}");
    assert!(start.elapsed() < Duration::from_secs(2));
    assert_eq!(place.files(), ["scene.xml"]);
}

/// Runs the program by a line of shell, in which `$@` is its command line.
fn in_shell(place: &Place, script: &str, words: &str) -> Ran {
    let program = place.command(words);
    let mut shell = Command::new("sh");
    shell.args(["-c", script, "sh"]).arg(program.get_program());
    shell.args(program.get_args()).current_dir(place.path("."));
    Ran::of(shell.output().unwrap())
}

/// `ulimit -f` counts 512 bytes: neither the checkpoint nor the image fits. The library for images
/// does, which is loaded from a file in memory of 60 KB.
#[test]
fn a_file_that_may_not_grow_leaves_the_last_image_and_checkpoint_alone() {
    let place = Place::new();
    let whole = uninterrupted(&place, 400, "");
    assert_eq!(interrupted(&place, 400, "").code, Some(75));
    let kept = (place.read("out.exr.checkpoint"), place.read("out.exr"));
    let ran = in_shell(
        &place,
        "ulimit -f 160; exec \"$@\"",
        &words(400, "--resume --checkpoint 50ms"),
    );
    ran.fails(
        1,
        &[
            "no checkpoint: out.exr.checkpoint",
            "rendering goes on",
            "out.exr",
        ],
    );
    assert!(kept == (place.read("out.exr.checkpoint"), place.read("out.exr")));
    assert_eq!(place.files(), FILES);
    place.run(&words(400, "--resume")).ok();
    assert!(read_channels(&place.path("out.exr")) == whole);
}

/// On a disk of its own that is full, and then read-only.
#[test]
fn a_full_or_read_only_disk_leaves_the_last_image_and_checkpoint_alone() {
    let place = Place::new();
    let first = words(300, "--checkpoint 30ms").replace("-o out", "-o disk/out");
    let script = r#"
        mkdir disk && mount -t tmpfs -o size=9m none disk 2>/dev/null || { echo no mount; exit 77; }
        "$@" & render=$!
        while [ ! -e disk/out.exr.checkpoint ]; do sleep 0.01; done
        kill $render; wait $render; [ $? = 75 ] || exit 3
        cp disk/out.exr disk/out.exr.checkpoint .
        cat /dev/zero >disk/filler 2>/dev/null
        TMPDIR=$PWD/disk "$@" --resume; [ $? = 1 ] || exit 4
        cmp disk/out.exr out.exr && cmp disk/out.exr.checkpoint out.exr.checkpoint || exit 5
        mount -o remount,ro disk || exit 6
        "$@" --resume; [ $? = 1 ] || exit 7
        cmp disk/out.exr out.exr && cmp disk/out.exr.checkpoint out.exr.checkpoint || exit 8
        mount -o remount,rw disk && rm disk/filler
        "$@" --resume && mv disk/out.exr . && [ "$(ls disk)" = "" ]"#;
    let inside = format!("exec unshare --mount --map-root-user sh -c '{script}' sh \"$@\"");
    let whole = uninterrupted(&place, 300, "");
    let ran = in_shell(&place, &inside, &first);
    if ran.out.contains("no mount") || ran.err.contains("unshare failed") {
        eprintln!("skipped: no tmpfs can be mounted here");
        return;
    }
    let ran = ran.ok();
    ran.says(&[
        "No space left on device",
        "rendering goes on",
        "disk/out.exr",
        "Read-only file system",
    ]);
    assert!(read_channels(&place.path("out.exr")) == whole);
}
