//! Layers that take the picture's light apart.

use super::support::{Place, SCENE, read_channels};
use std::collections::HashMap;

type Channels = HashMap<String, Vec<f32>>;

/// The channels of an image, by name.
fn channels(place: &Place, name: &str) -> Channels {
    let list = read_channels(&place.path(name)).into_iter();
    list.map(|(name, bits)| (name, bits.into_iter().map(f32::from_bits).collect()))
        .collect()
}

/// The scene between mirrors, with glass in it and a second lamp: light comes by every way.
fn room() -> String {
    let more = r#"
  <shape type="sphere" id="bubble"><point name="center" x="-0.4" y="0" z="0.7"/><float name="radius" value="0.3"/><bsdf type="dielectric"/></shape>
  <shape type="rectangle"><bsdf type="roughconductor"/><transform name="to_world"><rotate y="1" angle="70"/><translate x="-1"/></transform></shape>
  <shape type="rectangle"><bsdf type="plastic"/><transform name="to_world"><rotate x="1" angle="-80"/><translate y="-1"/></transform></shape>
  <emitter type="point" id="bulb"><point name="position" x="0" y="-0.5" z="1"/><rgb name="intensity" value="0.3"/></emitter>
  <emitter type="constant">"#;
    SCENE.replace("<emitter type=\"constant\">", more)
}

const PARTS: &str = "--aov direct,indirect --light-bounces 2 --format float \
                     --light-groups sphere,hemisphere=constant";
const DIRECTNESS: [&str; 2] = ["direct", "indirect"];
const GROUPS: [&str; 3] = ["light.sphere", "light.hemisphere", "light.rest"];
const BOUNCES: [&str; 4] = ["bounces.0", "bounces.1", "bounces.2", "bounces.more"];

/// Asserts that layers come to the picture, but for the rounding of two or three sums of `f32`.
fn come_to_the_picture(image: &Channels, layers: &[&str]) {
    for color in ["R", "G", "B"] {
        for (i, whole) in image[color].iter().enumerate() {
            let parts = layers
                .iter()
                .map(|layer| image[&format!("{layer}.{color}")][i]);
            let sum: f32 = parts.sum();
            let off = (sum - whole).abs();
            assert!(off <= 1e-5 * whole, "{layers:?} at {i}: {sum} for {whole}");
        }
    }
}

/// Whatever guides, splits and shares.
#[test]
fn parts_of_light_come_to_the_picture() {
    let place = Place::with(&room());
    let learned = "--guide double --trial never --paths 5000 --photons 20000 --batches 3";
    for guide in [
        "--guide none".to_owned(),
        format!("{learned} --reuse 1"),
        format!("{learned} --reuse 16"),
        "--guide gmm --photons 5000".to_owned(),
    ] {
        place
            .run(&format!(
                "render scene.xml {PARTS} {guide} -o a.exr --spp 24"
            ))
            .ok();
        let image = channels(&place, "a.exr");
        for layers in [&DIRECTNESS[..], &GROUPS, &BOUNCES] {
            come_to_the_picture(&image, layers);
            for layer in layers {
                let light: f32 = image[&format!("{layer}.R")].iter().sum();
                assert!(light > 0.0, "{layer} is black with {guide}");
            }
        }
    }
}

#[test]
fn parts_by_bounces_are_what_longer_paths_bring() {
    let place = Place::with(&room());
    let words = "--guide none --rr-depth 99 --spp 4";
    let whole = format!("render scene.xml {PARTS} {words} -o a.exr");
    place.run(&whole).ok();
    let image = channels(&place, "a.exr");
    let mut before = vec![0.0; 24 * 18];
    for depth in 1..=3 {
        place
            .run(&format!(
                "render scene.xml {words} --max-depth {depth} -o b.exr --format float"
            ))
            .ok();
        let up_to = channels(&place, "b.exr").remove("G").unwrap();
        let own = &image[&format!("bounces.{}.G", depth - 1)];
        for (i, own) in own.iter().enumerate() {
            let more = up_to[i] - before[i];
            assert!(
                (own - more).abs() <= 1e-5 * up_to[i],
                "{own} and {more} at depth {depth}"
            );
        }
        if depth == 2 {
            for (direct, up_to) in image["direct.G"].iter().zip(&up_to) {
                assert!((direct - up_to).abs() <= 1e-6 * up_to);
            }
        }
        before = up_to;
    }
}

/// The means of a render's channels.
fn means(place: &Place, words: &str) -> HashMap<String, f32> {
    place
        .run(&format!(
            "render scene.xml {words} -o a.exr --spp 256 --format float"
        ))
        .ok();
    let mean = |numbers: Vec<f32>| numbers.iter().sum::<f32>() / numbers.len() as f32;
    let channels = channels(place, "a.exr").into_iter();
    channels
        .map(|(name, numbers)| (name, mean(numbers)))
        .collect()
}

/// Each group against a render in which all other emitters are dark.
#[test]
fn a_group_has_the_light_of_its_emitters() {
    let dark = |scene: String, light: &str| {
        assert!(scene.contains(light), "{light}");
        scene.replace(light, &light.replace(['0', '3', '4', '5', '6'], "0"))
    };
    let (sky, lamp, bulb) = (
        "\"radiance\" value=\"0.4\"",
        "value=\"6, 5, 4\"",
        "\"intensity\" value=\"0.3\"",
    );
    let alone = [
        ("light.lamp.R", [sky, bulb]),
        ("light.sky.R", [lamp, bulb]),
        ("light.rest.R", [lamp, sky]),
    ];
    let alone = alone.map(|(channel, others)| {
        let scene = others.into_iter().fold(room(), dark);
        (channel, means(&Place::with(&scene), "--guide none")["R"])
    });
    let learned = "--guide double --trial never --paths 5000 --photons 20000 --batches 3";
    for guide in ["--guide none", learned] {
        let words = format!("--light-groups lamp=sphere,sky=constant {guide}");
        let told = means(&Place::with(&room()), &words);
        for (channel, truth) in alone {
            // 110000 samples, each of a relative deviation of at most 4: 1.2 % for either.
            let ratio = told[channel] / truth;
            assert!((ratio - 1.0).abs() < 0.05, "{channel}: {ratio}, {guide}");
        }
    }
}

#[test]
fn parts_of_light_are_in_parts_of_the_image() {
    let place = Place::with(&room());
    place
        .run(&format!("render scene.xml {PARTS} -o whole.exr"))
        .ok();
    for shard in 0..2 {
        place
            .run(&format!(
                "render scene.xml {PARTS} --shard {shard}/2 -o {shard}.exr"
            ))
            .ok();
    }
    place
        .run("merge 1.exr 0.exr -o merged.exr --aov direct,indirect --format float")
        .ok();
    assert!(channels(&place, "merged.exr") == channels(&place, "whole.exr"));
}

#[test]
fn groups_that_are_none_are_refused() {
    let place = Place::with(&room());
    for (words, parts) in [
        ("sun", ["no emitter is called \"sun\"", "\"bulb\""]),
        (
            "a=bulb,b=sphere+bulb",
            ["\"b\" is in \"a\" already", "one group"],
        ),
        ("a=bulb,a=sphere", ["two groups \"a\"", "name of its own"]),
    ] {
        place
            .run(&format!("render scene.xml --light-groups {words}"))
            .fails(2, &parts);
    }
    place
        .run("render scene.xml --light-groups each -o a.exr")
        .ok();
    let image = channels(&place, "a.exr");
    for name in ["bulb", "constant", "sphere", "rest"] {
        assert!(image.contains_key(&format!("light.{name}.G")), "{name}");
    }
}
