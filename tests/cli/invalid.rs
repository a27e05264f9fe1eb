//! Samples that are not finite: left out, counted, and shown again on request.

use super::support::{Place, read_exr};

/// A light so bright and so close that what it gives is beyond the largest number.
const TOO_BRIGHT: &str = r#"<emitter type="point">
    <point name="position" x="-0.5" y="0" z="0.1"/>
    <rgb name="intensity" value="3e38"/>
  </emitter>
</scene>"#;

#[test]
fn they_are_counted_and_never_in_the_image() {
    let place = Place::replacing("</scene>", TOO_BRIGHT);
    let ran = place
        .run("render scene.xml -o out.exr --aov all --format float --stats s.json --seed 3")
        .ok();
    let ran = ran.says(&["warning: ", "not finite", "--seed 3", "--pixel "]);
    let stats = String::from_utf8(place.read("s.json")).unwrap();
    assert!(!stats.contains("\"invalid_samples\": 0,"), "{stats}");
    let channels = super::support::read_channels(&place.path("out.exr"));
    for (name, numbers) in channels {
        let finite = numbers.iter().all(|&bits| f32::from_bits(bits).is_finite());
        assert!(finite, "{name} holds a number that is not finite: {ran:#?}");
    }
}

#[test]
fn the_first_one_is_shown_by_the_command_that_is_printed() {
    let place = Place::replacing("</scene>", TOO_BRIGHT);
    let ran = place.run("render scene.xml -o out.exr --seed 3").ok();
    let words = ran.err.split("twintree ").last().unwrap();
    let words = words.lines().next().unwrap();
    assert!(words.starts_with("render scene.xml -o out.exr"), "{ran:#?}");
    std::fs::remove_file(place.path("out.exr")).unwrap();
    let shown = place.run(words).ok();
    let first = shown.out.lines().next().unwrap();
    assert!(first.contains("inf"), "{shown:#?}");
    assert!(shown.out.contains("meets \"wall\""), "{shown:#?}");
    assert_eq!(place.files(), ["scene.xml"], "nothing is written");
}

#[test]
fn strict_makes_them_an_error_after_the_image_is_written() {
    let place = Place::replacing("</scene>", TOO_BRIGHT);
    place
        .run("render scene.xml -o out.exr --strict")
        .fails(3, &["not finite", "--strict"]);
    assert_eq!(place.files(), ["out.exr", "scene.xml"]);
    Place::new()
        .run("render scene.xml -o out.exr --strict")
        .ok();
}

/// The one sample printed is the one that a render takes.
#[test]
fn a_sample_has_the_radiance_of_the_render() {
    for accel in ["embree", "obvhs"] {
        if accel == "embree" && !cfg!(feature = "embree") {
            continue;
        }
        let place = Place::new();
        let words = format!("scene.xml --accel {accel} --seed 5");
        place
            .run(&format!("render {words} --spp 1 -o a.exr --format float"))
            .ok();
        let (width, pixels) = read_exr(&place.path("a.exr"));
        for (x, y) in [(0, 0), (7, 9), (15, 6), (23, 17)] {
            let ran = place.run(&format!("render {words} --pixel {x},{y}")).ok();
            let [r, g, b] = pixels[y * width + x];
            let radiance = format!("radiance [{r:e} {g:e} {b:e}]");
            assert!(ran.out.contains(&radiance), "{radiance} {ran:#?}");
        }
    }
}

#[test]
fn pixels_beyond_the_film_are_refused() {
    let place = Place::new();
    for (words, part) in [
        ("--pixel 24,0", "24 x 18"),
        ("--pixel 3", "x,y"),
        ("--sample 4", "--pixel X,Y,SAMPLE"),
    ] {
        place
            .run(&format!("render scene.xml {words}"))
            .fails(2, &[part]);
    }
}
