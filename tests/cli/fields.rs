//! Fields in files: the same bits as in one go, exact sums, and what is refused.

use super::support::{Place, read_channels};

/// Few records: what is tested does not depend on how good the field is.
const FEW: &str = "--photons 3000 --paths 2000 --batches 3";

/// Trains `name` from scene.xml.
fn train(place: &Place, name: &str, words: &str) {
    place
        .run(&format!("train scene.xml -o {name} {words}"))
        .ok()
        .says(&["wrote", name]);
}

/// With camera paths a render in one go learns from its own first passes, which no file can know.
#[test]
fn a_field_of_photons_from_a_file_gives_the_bits_of_one_go() {
    for words in [
        "--guide-model constant",
        "--guide-model gauss",
        "--guide-model vmf",
        "--seed 3",
        "--max-depth 6",
        "--width 30",
    ] {
        let place = Place::new();
        let image = "--spp 4 --format float --guide double";
        place
            .run(&format!(
                "render scene.xml -o a.exr {image} {FEW} --train photons {words}"
            ))
            .ok();
        train(&place, "f.field", &format!("{FEW} --train photons {words}"));
        let rest: Vec<&str> = words.split(' ').collect();
        let own = |w: &[&str]| ["--seed", "--max-depth", "--width"].contains(&w[0]);
        let kept: Vec<String> = rest
            .chunks(2)
            .filter(|w| own(w))
            .map(|w| w.join(" "))
            .collect();
        let words = format!("--field f.field {}", kept.join(" "));
        place
            .run(&format!("render scene.xml -o b.exr {image} {words}"))
            .ok()
            .says(&["guided by f.field"]);
        let read = |name| read_channels(&place.path(name));
        assert!(read("a.exr") == read("b.exr"), "{words}");
        place
            .run("render scene.xml -o c.exr --spp 4 --format float")
            .ok();
        assert!(read("a.exr") != read("c.exr"), "the field guides: {words}");
    }
}

#[test]
fn one_and_three_threads_write_the_same_file() {
    let place = Place::new();
    train(&place, "one.field", &format!("{FEW} -j 1"));
    train(&place, "three.field", &format!("{FEW} -j 3"));
    assert!(place.read("one.field") == place.read("three.field"));
    train(&place, "other.field", &format!("{FEW} --seed 1"));
    assert!(place.read("one.field") != place.read("other.field"));
}

#[test]
fn shards_add_up_to_the_bits_of_one_run_in_any_order() {
    for model in ["constant", "vmf", "gauss"] {
        let place = Place::new();
        train(
            &place,
            "base.field",
            &format!("{FEW} --guide-model {model}"),
        );
        let more = "--field base.field --photons 5000 --paths 1001";
        train(&place, "all.field", more);
        train(&place, "new.field", &format!("{more} --shard 0/1"));
        for i in 0..3 {
            train(
                &place,
                &format!("{i}.field"),
                &format!("{more} --shard {i}/3"),
            );
        }
        for (fields, whole) in [
            ("0.field 1.field 2.field", "new.field"),
            ("2.field 0.field 1.field", "new.field"),
            ("base.field 1.field 0.field 2.field", "all.field"),
            ("2.field 1.field base.field 0.field", "all.field"),
            ("new.field base.field", "all.field"),
        ] {
            place
                .run(&format!("merge-fields {fields} -o sum.field"))
                .ok();
            assert!(place.read("sum.field") == place.read(whole), "{fields}");
        }
        // The sum is a field like any other: it renders, and a shard continues it.
        place
            .run("render scene.xml --field sum.field --spp 1 -o a.exr")
            .ok();
        train(
            &place,
            "next.field",
            "--field sum.field --photons 10 --paths 10 --shard 0/2",
        );
    }
}

#[test]
fn missing_and_repeated_records_are_named() {
    let place = Place::new();
    train(&place, "base.field", FEW);
    for i in 0..3 {
        let words = format!("--field base.field --photons 600 --paths 300 --shard {i}/3");
        train(&place, &format!("{i}.field"), &words);
    }
    let gap = ["photons 3200 to 3399", "paths 2100 to 2199", "--partial"];
    place
        .run("merge-fields 0.field 2.field -o sum.field")
        .fails(2, &gap);
    let tail = ["photons 3400 to 3599", "paths 2200 to 2299"];
    place
        .run("merge-fields 1.field base.field 0.field -o sum.field")
        .fails(2, &tail);
    place
        .run("merge-fields 0.field 1.field 1.field -o sum.field")
        .fails(2, &["both contain", "photons 3200 to 3399", "1.field"]);
    assert!(!place.path("sum.field").exists());
    place
        .run("merge-fields 0.field 2.field -o sum.field --partial")
        .ok()
        .says(&["warning: ", "photons 3200 to 3399"]);
    // What is missing can still be added.
    place
        .run("merge-fields sum.field 1.field -o all.field")
        .ok();
    place.run("field sum.field").ok();
}

#[test]
fn fields_that_do_not_belong_together_are_not_added() {
    let place = Place::new();
    train(&place, "a.field", FEW);
    train(&place, "b.field", &format!("{FEW} --seed 4"));
    train(&place, "deep.field", &format!("{FEW} --max-depth 7"));
    for other in ["b.field", "deep.field"] {
        place
            .run(&format!("merge-fields a.field {other} -o sum.field"))
            .fails(2, &[other, "cannot add", "made differently"]);
    }
    place
        .run("train scene.xml --field a.field --max-depth 7 -o c.field")
        .fails(2, &["a.field", "other settings", "depth 7"]);
}

#[test]
fn damaged_and_foreign_files_are_refused_with_a_reason_and_a_byte() {
    let place = Place::new();
    train(&place, "good.field", FEW);
    let good = place.read("good.field");
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let mut newer = good.clone();
    newer[8] = 77;
    let longer = [&good[..], b"x"].concat();
    for (bytes, parts) in [
        (
            &good[..good.len() / 3],
            ["cut off", &format!("byte {}", good.len() / 3)],
        ),
        (&good[..20], ["cut off", "byte 20"]),
        (&[], ["cut off", "byte 0"]),
        (&flipped, ["checksum", "bytes 24 to"]),
        (&newer, ["version 77", "byte 8"]),
        (&longer, ["goes on", &format!("byte {}", good.len())]),
        (
            b"<scene version='3.0.0'/> and so on",
            ["not a field", "byte 0"],
        ),
    ] {
        std::fs::write(place.path("bad.field"), bytes).unwrap();
        for command in [
            "render scene.xml --field bad.field -o out.exr",
            "field bad.field",
            "merge-fields good.field bad.field -o sum.field",
            "train scene.xml --field bad.field -o more.field",
        ] {
            let ran = place.run(command).fails(2, &["bad.field"]);
            ran.says(&parts);
        }
    }
    place
        .run("render scene.xml --field nowhere.field -o out.exr")
        .fails(2, &["nowhere.field"]);
    assert_eq!(place.files(), ["bad.field", "good.field", "scene.xml"]);
}

#[test]
fn a_field_of_another_scene_is_refused_unless_any_will_do() {
    let place = Place::new();
    train(&place, "f.field", FEW);
    let text = std::fs::read_to_string(place.path("scene.xml")).unwrap();
    let moved = text.replace(r#"x="0.5""#, r#"x="0.4""#);
    assert_ne!(moved, text);
    std::fs::write(place.path("moved.xml"), moved).unwrap();
    for command in [
        "render moved.xml --field f.field -o out.exr",
        "train moved.xml --field f.field -o out.field",
        "field f.field --scene moved.xml --pixel 1,1 -o out.exr",
    ] {
        place
            .run(command)
            .fails(2, &["f.field", "another scene", "fingerprint"]);
    }
    assert_eq!(place.files(), ["f.field", "moved.xml", "scene.xml"]);
    place
        .run("render moved.xml --field any:f.field --spp 1 -o out.exr")
        .ok()
        .says(&["warning: ", "another scene"]);
    // Another size, number of samples or place on the disk is the same scene.
    std::fs::create_dir(place.path("elsewhere")).unwrap();
    std::fs::copy(place.path("scene.xml"), place.path("elsewhere/s.xml")).unwrap();
    place
        .run("render elsewhere/s.xml -D size=40 -D spp=1 --field f.field -o out.exr")
        .ok();
}

#[test]
fn a_field_is_shown_in_numbers_and_pictures() {
    let place = Place::new();
    train(&place, "f.field", FEW);
    let table = place.run("field f.field").ok().out;
    for word in [
        "photons",
        "3000",
        "paths",
        "2000",
        "links",
        "cells by depth",
        "bytes",
    ] {
        assert!(table.contains(word), "{word}: {table}");
    }
    let json = place.run("field f.field --json").ok().out;
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["sample_ranges"]["photons"]["taken"][0]["end"], 3000);
    let depths = json["stats"]["space_depths"].as_array().unwrap();
    let cells: u64 = depths.iter().map(|d| d.as_u64().unwrap()).sum();
    assert_eq!(json["stats"]["space_cells"].as_u64(), Some(cells));
    let view = "--pixel 12,9 -o view.exr --rows 8 --spp 4";
    let said = place
        .run(&format!(
            "field f.field --scene scene.xml {view} --tree tree.exr"
        ))
        .ok();
    assert!(said.out.contains("brute force"), "{said:#?}");
    assert!(said.out.contains("hang at       level "), "{said:#?}");
    assert!(said.err.contains("its paths meet"), "{said:#?}");
    let size = |name: &str, width, height| {
        let (w, pixels) = super::support::read_exr(&place.path(name));
        assert_eq!((w, pixels.len()), (width, width * height), "{name}");
        assert!(pixels.iter().any(|p| p[1] > 0.0), "{name}");
    };
    size("view.exr", 32, 8);
    size("tree.exr", 24, 18);
}

/// Fills the scene's space with fog.
const FOG: &str = r#"<sensor type="perspective">
    <medium type="homogeneous" id="fog">
      <float name="sigma_t" value="0.2"/><float name="albedo" value="0.9"/>
    </medium>"#;

#[test]
fn a_field_is_shown_inside_of_a_medium() {
    let place = Place::replacing(r#"<sensor type="perspective">"#, FOG);
    train(&place, "f.field", FEW);
    let view = "field f.field --scene scene.xml --pixel 12,9 --rows 8 --spp 4 -o view.exr";
    let wall = place.run(view).ok().out;
    assert!(wall.contains("normal "), "{wall}");
    let fog = place.run(&format!("{view} --distance 0.5")).ok().out;
    assert!(fog.contains("medium        fog"), "{fog}");
    let (w, pixels) = super::support::read_exr(&place.path("view.exr"));
    assert_eq!((w, pixels.len()), (32, 256));
    // Light comes from above and below.
    for half in pixels.chunks(128) {
        assert!(half.iter().any(|p| p[1] > 0.0));
    }
    place.run(&format!("{view} --distance 1e6")).fails(
        2,
        &[
            "no medium at --distance 1000000",
            "there are media at 0 to ",
        ],
    );
    place
        .run(&format!("{view} --distance -1"))
        .fails(2, &["--distance", "above 0"]);
    let clear = Place::new();
    train(&clear, "f.field", FEW);
    clear
        .run(&format!("{view} --distance 0.5"))
        .fails(2, &["no medium at --distance 0.5", "the first surface"]);
}

#[test]
fn what_is_mistyped_is_named() {
    let place = Place::new();
    train(&place, "f.field", FEW);
    for (words, parts) in [
        (
            "train scene.xml --guide-model vnf",
            ["--guide-model", "vmf"],
        ),
        ("train scene.xml --train photon", ["--train", "photons"]),
        ("train scene.xml --shard 0/2", ["--field", "required"]),
        (
            "train scene.xml --field f.field --shard 2/2",
            ["--shard", "1/2"],
        ),
        (
            "train scene.xml --field f.field --batches 3",
            ["--field", "--batches"],
        ),
        (
            "train scene.xml --photons 0 --paths 0",
            ["nothing to learn", "--photons"],
        ),
        (
            "train scene.xml --train photons --photons 0",
            ["nothing to learn", "--photons"],
        ),
        (
            "render scene.xml --field f.field --photons 9",
            ["--field", "--photons"],
        ),
        (
            "render scene.xml --field f.field --guide none",
            ["--guide none", "--field"],
        ),
        ("render scene.xml --any-scene", ["--any-scene", "any:FILE"]),
        (
            "render scene.xml --guide double --guide-modle vmf",
            ["--guide-modle", "--guide-model"],
        ),
        ("field f.field --pixel 3", ["--pixel", "x,y"]),
        ("field f.field --pixel 3,3", ["--scene", "--output"]),
        (
            "field f.field --scene scene.xml --pixel 24,3 -o a.exr",
            ["24,3", "24 x 18"],
        ),
        ("field f.field --tree t.png", ["--scene", "required"]),
        ("merge-fields f.field", ["--output", "required"]),
    ] {
        place.run(words).fails(2, &parts);
    }
    assert_eq!(place.files(), ["f.field", "scene.xml"]);
    place
        .run("train scene.xml -o nowhere/f.field")
        .fails(1, &["nowhere", "mkdir"]);
}
