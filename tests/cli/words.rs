//! Words: what is refused or warned about, and how.

use super::support::{Place, SCENE};
use std::time::{Duration, Instant};

#[test]
fn numbers_that_are_none_or_negative_get_a_plain_error() {
    let place = Place::new();
    for (words, parts) in [
        ("--exposure nan", ["--exposure", "from -64 to 64"]),
        ("--exposure inf", ["--exposure", "from -64 to 64"]),
        ("--spp -1", ["--spp", "-1"]),
        ("--photons -5", ["--photons", "-5"]),
        ("--crop -1,0,5,5", ["--crop", "x0,y0,x1,y1"]),
        ("--pixel -1,0", ["--pixel", "x,y"]),
        ("--width 4294967296", ["--width", "4294967296"]),
    ] {
        let ran = place.run(&format!("render scene.xml -o a.exr {words}"));
        let ran = ran.fails(2, &parts);
        assert!(ran.err.contains("invalid value"), "{ran:#?}");
    }
    place
        .run("compare a.exr -r b.exr --exposure nan")
        .fails(2, &["from -64 to 64"]);
    // In a scene, too: what is too large is not too small.
    let scene = SCENE.replace("\"$spp\"", "\"4294967296\"");
    assert!(scene.contains("4294967296"));
    Place::with(&scene)
        .run("check scene.xml")
        .fails(2, &["sample_count", "at most 4294967295"]);
}

#[test]
fn options_without_effect_are_said_to_have_none() {
    let place = Place::new();
    let said = |words: &str| place.run(words).ok().err;
    let text = said("render scene.xml -o a.exr --guide none --mixture 0.5 --exposure 2 --reuse 3");
    for name in ["--mixture", "--exposure", "--reuse"] {
        assert!(
            text.contains(&format!("warning: {name} has no effect")),
            "{text}"
        );
    }
    assert!(!said("render scene.xml -o a.exr --aov all").contains("warning"));
    let text = said("render scene.xml -o a.png --aov albedo --compression piz");
    assert!(
        text.contains("--aov has no effect") && text.contains("--compression"),
        "{text}"
    );
    let text = said("train scene.xml -o a.field --photons 999 --paths 0 --sampler sobol");
    assert!(text.contains("--sampler has no effect"), "{text}");
}

#[test]
fn a_picture_that_will_be_black_is_warned_about() {
    let clip = |near: &str, far: &str| {
        let planes = format!(
            "<float name=\"near_clip\" value=\"{near}\"/><float name=\"far_clip\" value=\"{far}\"/><film"
        );
        SCENE.replace("<film", &planes)
    };
    let moved = |origin: &str, target: &str| {
        SCENE.replace(
            r#"origin="0, 0, 4" target="0, 0, 0""#,
            &format!("origin=\"{origin}\" target=\"{target}\""),
        )
    };
    for (scene, part) in [
        (clip("0.1", "1"), "far_clip 1"),
        (clip("100", "1000"), "near_clip 100"),
        (moved("0, 0, 4", "0, 0, 8"), "behind it"),
        (moved("0, 0, 9000", "0, 0, 0"), "smaller than a pixel"),
        (moved("0, 500, 4", "0, 500, 0"), "beyond the edges"),
    ] {
        let ran = Place::with(&scene)
            .run("render scene.xml -o a.exr --spp 1")
            .ok();
        ran.says(&["warning: the camera sees no surface", part]);
    }
    let ran = Place::new().run("render scene.xml -o a.exr --spp 1").ok();
    assert!(!ran.err.contains("warning"), "{ran:#?}");
}

/// Every shape has a warning of its own. They are printed up to a bound, and all of them only if
/// asked for.
#[test]
fn thousands_of_warnings_are_printed_up_to_a_bound() {
    let shape =
        |i: u32| format!("<shape type=\"sphere\"><float name=\"odd{i}\" value=\"1\"/></shape>\n");
    let shapes: String = (0..3000).map(shape).collect();
    let scene = SCENE.replace("</scene>", &format!("{shapes}</scene>"));
    let place = Place::with(&scene);
    let start = Instant::now();
    let ran = place.run("check scene.xml --lenient");
    assert!(start.elapsed() < Duration::from_secs(20));
    if ran.code != Some(0) {
        // Parameters that nothing knows are errors: there is nothing to print in thousands then.
        assert!(ran.err.lines().count() < 200, "{}", ran.err.len());
        return;
    }
    let lines = ran
        .err
        .lines()
        .filter(|l| l.starts_with("warning: "))
        .count();
    assert!((100..110).contains(&lines), "{lines}");
    let ran = place
        .run("check scene.xml --lenient --log-level debug")
        .ok();
    assert!(ran.err.lines().count() >= 3000);
}

#[test]
fn a_model_in_the_sun_is_exposed_so_that_it_is_seen() {
    let place = Place::new();
    let square = "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 4 3 2 1\n";
    std::fs::write(place.path("m.obj"), square).unwrap();
    for sky in ["sun", "sun:20,60", "sun:0,5"] {
        let words = format!(
            "render m.obj --sky {sky} --camera from:0,4,1 --material matte:0.5 --width 16 --spp 16 -o a.png"
        );
        place.run(&words).ok().says(&["exposure of", "--exposure"]);
        let image = image_mean(&place);
        assert!((0.05..0.95).contains(&image), "{sky}: {image}");
    }
}

/// Mean of the middle of a.png, as shown.
fn image_mean(place: &Place) -> f64 {
    use twintree::image::read;
    let image = read(&place.path("a.png")).unwrap();
    let (w, h) = (image.width as usize, image.height as usize);
    let channels = image.channels.len();
    let middle = (h / 2 * w + w / 2) * channels;
    let colour = &image.pixels[middle..middle + 3];
    f64::from(colour.iter().sum::<f32>()) / 3.0
}
