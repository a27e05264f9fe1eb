//! Images in parts: `render --shard` and `merge`.

use super::support::{Place, read_channels};

/// A film of 5 x 4 tiles, some of them narrow, with every layer and every bit.
const PICTURE: &str = "--width 71 --height 53 --spp 5 --format float --aov all";

/// Renders shards of the scene as `0.exr`, `1.exr` and so on.
fn render_shards(place: &Place, count: u32, words: &str) -> Vec<String> {
    let names: Vec<String> = (0..count).map(|i| format!("{i}.exr")).collect();
    for (i, name) in names.iter().enumerate() {
        let shard = format!("render scene.xml {words} --shard {i}/{count} -o {name}");
        place.run(&shard).ok();
    }
    names
}

#[test]
fn any_number_of_shards_merged_in_any_order_is_the_image_in_one_piece() {
    let place = Place::new();
    place
        .run(&format!("render scene.xml {PICTURE} -o whole.exr"))
        .ok();
    let whole = read_channels(&place.path("whole.exr"));
    assert!(whole.len() > 12, "all layers are there");
    for count in [1, 2, 3, 7] {
        let mut names = render_shards(&place, count, PICTURE);
        names.reverse();
        names.rotate_left(count as usize / 3);
        let parts = names.join(" ");
        place
            .run(&format!(
                "merge {parts} -o merged.exr --format float --aov all"
            ))
            .ok();
        assert!(
            read_channels(&place.path("merged.exr")) == whole,
            "{count} shards"
        );
    }
}

#[test]
fn guided_shards_learn_the_same_field() {
    let place = Place::new();
    let guided = "--width 48 --height 36 --spp 4 --format float --guide double --photons 20000 \
                  --paths 5000 --batches 3";
    place
        .run(&format!("render scene.xml {guided} -o whole.exr"))
        .ok();
    // Threads must not matter either: machines differ.
    render_shards(&place, 2, &format!("{guided} -j 1"));
    place
        .run("merge 1.exr 0.exr -o merged.exr --format float")
        .ok();
    let of = |name: &str| read_channels(&place.path(name));
    assert!(of("merged.exr") == of("whole.exr"));
}

#[test]
fn a_merged_image_tells_how_it_was_made() {
    let place = Place::new();
    render_shards(&place, 2, "--spp 3 --seed 9");
    place
        .run("merge 0.exr 1.exr -o merged.exr --stats s.json")
        .ok();
    let stats: serde_json::Value = serde_json::from_slice(&place.read("s.json")).unwrap();
    assert_eq!(stats["spp"], 3);
    assert_eq!(stats["seed"], 9);
    assert_eq!(stats["samples"], 3 * 24 * 18);
    assert_eq!(stats["stopped_by"], "samples");
    assert!(stats["rays"].as_u64() > Some(24 * 18), "{stats}");
    let text = String::from_utf8_lossy(&place.read("merged.exr")).into_owned();
    assert!(text.contains("--seed 9"), "the settings are in the header");
    assert!(!text.contains("--shard"), "of the whole, not of a part");
}

#[test]
fn missing_shards_are_named_and_left_black_only_on_request() {
    let place = Place::new();
    place
        .run(&format!("render scene.xml {PICTURE} -o whole.exr"))
        .ok();
    let names = render_shards(&place, 4, PICTURE);
    let some = format!("merge {} {} -o merged.exr", names[3], names[1]);
    place
        .run(&some)
        .fails(2, &["shards 0/4, 2/4 missing", "--partial"]);
    place
        .run(&format!(
            "merge {} {} {} -o m.exr",
            names[0], names[1], names[2]
        ))
        .fails(2, &["shard 3/4 missing"]);
    assert!(!place.path("merged.exr").exists());
    place
        .run(&format!("{some} --partial --format float --aov all"))
        .ok()
        .says(&["warning", "shards 0/4, 2/4 missing"]);
    let (whole, merged) = (
        read_channels(&place.path("whole.exr")),
        read_channels(&place.path("merged.exr")),
    );
    let mut there = 0;
    for ((name, whole), (_, merged)) in whole.iter().zip(&merged) {
        // What is told of a pixel's variance rests on its neighbours, too: some of those are
        // missing.
        let alone = !name.starts_with("variance");
        for (a, b) in whole.iter().zip(merged) {
            let same = a == b || !alone && (*a != 0);
            assert!(same || *b == 0, "{name}: as in the whole image, or black");
            there += usize::from(*b != 0);
        }
    }
    let all: usize = whole
        .iter()
        .map(|(_, n)| n.iter().filter(|n| **n != 0).count())
        .sum();
    let share = there as f64 / all as f64;
    assert!((0.3..0.7).contains(&share), "half is there: {share}");
}

#[test]
fn overlapping_parts_are_named() {
    let place = Place::new();
    render_shards(&place, 2, "");
    std::fs::copy(place.path("0.exr"), place.path("again.exr")).unwrap();
    place
        .run("merge 0.exr 1.exr again.exr -o m.exr")
        .fails(2, &["again.exr", "shard 0/2", "overlaps with 0.exr"]);
    place.run("render scene.xml --shard 0/3 -o third.exr").ok();
    place
        .run("merge 0.exr third.exr 1.exr -o m.exr")
        .fails(2, &["third.exr", "overlaps"]);
    assert!(!place.path("m.exr").exists());
}

#[test]
fn parts_of_different_images_say_what_differs() {
    let place = Place::new();
    place.run("render scene.xml --shard 0/2 -o a.exr").ok();
    let differs = |words: &str, what: &str| {
        place
            .run(&format!("render {words} --shard 1/2 -o b.exr"))
            .ok();
        place
            .run("merge a.exr b.exr -o m.exr")
            .fails(2, &["a.exr and b.exr are not parts of one image", what]);
    };
    differs("scene.xml --seed 5", "--seed is 0 in a.exr and 5 in b.exr");
    differs("scene.xml --spp 5", "--spp is 4 in a.exr and 5 in b.exr");
    differs("scene.xml --max-depth 3", "--max-depth");
    differs("scene.xml --width 32", "--width is 24");
    differs("scene.xml --accel obvhs", "the ray tracer is");
    let text = String::from_utf8(place.read("scene.xml")).unwrap();
    let brighter = text.replace("0.5, 0.4, 0.3", "0.5, 0.4, 0.31");
    std::fs::write(place.path("other.xml"), brighter).unwrap();
    differs("other.xml", "the scenes differ");
}

#[test]
fn a_scene_may_lie_elsewhere_on_another_machine() {
    let place = Place::new();
    std::fs::create_dir(place.path("there")).unwrap();
    let text = String::from_utf8(place.read("scene.xml")).unwrap();
    let noted = text.replace("<integrator", "<!-- a note -->\n<integrator");
    std::fs::write(place.path("there/room.xml"), noted).unwrap();
    place.run("render scene.xml --shard 0/2 -o a.exr").ok();
    place.run("render there/room.xml --shard 1/2 -o b.exr").ok();
    place.run("merge a.exr b.exr -o m.exr").ok();
}

#[test]
fn what_is_no_part_is_refused() {
    let place = Place::new();
    place.run("render scene.xml -o picture.exr").ok();
    place
        .run("merge picture.exr -o m.exr")
        .fails(2, &["picture.exr", "not a part of a render"]);
    place
        .run("merge missing.exr -o m.exr")
        .fails(2, &["missing.exr"]);
}

#[test]
fn shards_that_cannot_be_are_refused_before_the_work() {
    let place = Place::new();
    let refused = |words: &str, parts: &[&str]| {
        place
            .run(&format!("render scene.xml {words}"))
            .fails(2, parts);
    };
    refused("--shard 4/4", &["counted from 0", "3/4"]);
    refused("--shard one", &["0/4"]);
    refused("--shard 0/2 --time 3s", &["--time", "--shard"]);
    refused("--shard 0/2 --noise 0.1", &["--noise", "--shard"]);
    refused("--shard 0/2 -o a.png", &["one .exr file"]);
    refused("--shard 0/2 -o a.exr -o b.exr", &["one .exr file"]);
    refused("--shard 0/5", &["4 tiles", "at most 4 shards"]);
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn a_shard_without_a_name_is_called_after_scene_and_number() {
    let place = Place::new();
    place.run("render scene.xml --shard 1/3").ok();
    assert_eq!(place.files(), ["scene.1-of-3.exr", "scene.xml"]);
}

/// A queue may start a job once more.
#[test]
fn a_finished_shard_is_not_rendered_again() {
    let place = Place::new();
    let shard = "render scene.xml --shard 1/3 -o a.exr --resume";
    place.run(shard).ok().says(&["wrote a.exr"]);
    let before = place.read("a.exr");
    let ran = place.run(shard).ok().says(&["a.exr is there already"]);
    assert!(!ran.err.contains("wrote"), "{ran:#?}");
    assert!(place.read("a.exr") == before);
    // Another one of that name is.
    place
        .run(&format!("{shard} --seed 3"))
        .ok()
        .says(&["wrote a.exr"]);
    assert!(place.read("a.exr") != before);
}
