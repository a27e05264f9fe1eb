//! What is said while all goes well.

use super::support::Place;

#[test]
fn lines_tell_what_is_done_and_quiet_says_nothing() {
    let place = Place::new();
    let ran = place.run("render scene.xml -o a.exr").ok();
    assert_eq!(ran.out, "");
    let ran = ran.says(&["scene.xml: ", "24 x 18 pixels", "4 spp", "wrote a.exr"]);
    assert!(
        !ran.err.contains('\x1b'),
        "no colours or bars in a file: {ran:#?}"
    );
    let ran = place.run("render scene.xml -o a.exr --quiet").ok();
    assert_eq!((ran.out.as_str(), ran.err.as_str()), ("", ""));
}

#[test]
fn log_levels_hide_and_show() {
    let place = Place::new();
    let ran = place
        .run("render scene.xml -o a.exr --log-level debug")
        .ok();
    ran.says(&["debug: ", "built in"]);
    let ran = place.run("render scene.xml -o a.exr --log-level warn").ok();
    assert_eq!(ran.err, "");
}

#[test]
fn lines_come_while_a_render_goes_on() {
    let place = Place::new();
    let ran = place.run("render scene.xml -o a.exr --time 2500ms").ok();
    let lines = ran.err.lines().filter(|l| l.contains(" left")).count();
    assert!((1..=10).contains(&lines), "{ran:#?}");
}

#[test]
fn a_preview_without_a_viewer_is_a_warning() {
    // A port that was free a moment ago, so that nobody listens.
    let port = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = port.local_addr().unwrap();
    drop(port);
    let words = format!("render scene.xml -o a.exr --preview tev={address}");
    let ran = Place::new().run(&words).ok();
    ran.says(&["warning: ", "tev", &address.to_string(), "wrote a.exr"]);
}

#[test]
fn a_viewer_gets_the_image() {
    use std::io::Read;
    let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let viewer = std::thread::spawn(move || {
        let mut received = Vec::new();
        listener
            .accept()
            .unwrap()
            .0
            .read_to_end(&mut received)
            .unwrap();
        received
    });
    let words = format!("render scene.xml -o a.exr --preview tev={address}");
    Place::new().run(&words).ok();
    let received = viewer.join().unwrap();
    // A packet: its length, its kind, a byte for focus, the image's name. 4 creates, 6 updates.
    let kinds = packets(&received);
    assert_eq!(kinds.first(), Some(&4), "{kinds:?}");
    let updates = kinds.iter().filter(|&&k| k == 6).count();
    assert!(updates >= 18, "one for each row: {kinds:?}");
    assert!(received.windows(6).any(|w| w == b"a.exr\0"));
}

/// The kinds of tev's packets.
fn packets(mut bytes: &[u8]) -> Vec<u8> {
    let mut kinds = Vec::new();
    while bytes.len() >= 5 {
        let length = u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as usize;
        kinds.push(bytes[4]);
        bytes = &bytes[length.clamp(5, bytes.len())..];
    }
    kinds
}

#[test]
fn help_and_version_are_there() {
    let place = Place::new();
    let help = place.run("render --help").ok().out;
    for flag in [
        "--spp",
        "--time",
        "--noise",
        "--crop",
        "--aov",
        "--stats",
        "--preview",
    ] {
        assert!(help.contains(flag), "{flag}");
    }
    let version = place.run("--version").ok().out;
    assert_eq!(
        version.trim(),
        concat!("twintree ", env!("CARGO_PKG_VERSION"))
    );
}

/// OpenImageIO alone brings 250 libraries and takes 0.2 s and 120 MB to load.
#[test]
fn a_run_without_images_does_not_load_the_libraries_for_them() {
    let listed = std::process::Command::new("ldd")
        .arg(env!("CARGO_BIN_EXE_twintree"))
        .output()
        .expect("ldd is a part of every Debian");
    let listed = String::from_utf8_lossy(&listed.stdout);
    assert!(listed.contains("libc.so"), "{listed}");
    assert!(!listed.contains("OpenImageIO"), "{listed}");
    assert!(listed.lines().count() < 40, "{listed}");
}
