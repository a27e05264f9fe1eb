//! `twintree table1`, and the rivals that it compares with.

use super::support::{Place, read_channels};
use serde_json::Value;

/// Small enough for a test.
const TINY: &str = "--scene scene.xml --spp 4 --reference-spp 64 --batches 3 --photons 2000";

/// The tests' scene with a ball that reflects light onto the wall: something to learn.
fn place() -> Place {
    let ball = r#"<float name="radius" value="0.2"/>"#;
    Place::replacing(ball, &format!(r#"{ball}<bsdf type="diffuse"/>"#))
}

fn json(place: &Place, name: &str) -> Value {
    serde_json::from_slice(&place.read(name)).unwrap()
}

#[test]
fn every_method_has_a_row_of_numbers_that_make_sense() {
    let place = place();
    let words = format!("table1 {TINY} --repeats 2 --json t.json -o pictures");
    let ran = place
        .run(&words)
        .ok()
        .says(&["rendering a reference of 64"]);
    let report = json(&place, "t.json");
    assert_eq!(report["spp"], 4);
    assert_eq!(report["batches"], 3);
    assert_eq!(report["photons_per_batch"], 2000);
    let scene = &report["scenes"][0];
    assert_eq!(
        (&scene["width"], &scene["height"]),
        (&24.into(), &18.into())
    );
    let rows = scene["rows"].as_array().unwrap();
    let names: Vec<&str> = rows.iter().map(|r| r["method"].as_str().unwrap()).collect();
    assert_eq!(
        names,
        [
            "none",
            "gmm",
            "ppg",
            "double",
            "double-vmf",
            "double-gauss",
            "field",
            "field-reuse",
            "field-manifold",
            "double-render"
        ]
    );
    for row in rows {
        let of = |key: &str| row[key].as_f64().unwrap_or_else(|| panic!("{key}: {row}"));
        assert!(
            of("l1") > 0.0 && of("l1") <= of("rmse") && of("rmse") < 1.0,
            "{row}"
        );
        assert!(of("ssim") > 0.1 && of("ssim") < 1.0, "{row}");
        assert!((of("mean_ratio") - 1.0).abs() < 0.05, "{row}");
        let sum = of("preprocessing_seconds") + of("render_seconds");
        assert!((of("total_seconds") - sum).abs() < 1e-9 && of("render_seconds") > 0.0);
        let learns = row["method"] != "none";
        assert_eq!(of("memory_bytes") > 0.0, learns, "{row}");
        assert_eq!(of("preprocessing_seconds") > 0.0, learns, "{row}");
    }
    for part in ["scene, 24 x 18", "divided by gmm", "| double-gauss "] {
        assert!(ran.out.contains(part), "{part:?} is missing: {}", ran.out);
    }
    let pictures = std::fs::read_dir(place.path("pictures")).unwrap();
    // One of each method, and the reference.
    assert_eq!(pictures.count(), rows.len() + 1);
}

#[test]
fn a_reference_is_kept_or_given_and_errors_do_not_depend_on_threads() {
    let place = place();
    let words = format!("table1 {TINY} --repeats 1 --method gmm,double");
    place.run(&format!("{words} --json a.json -j 1")).ok();
    let kept = place.files();
    let kept = kept
        .iter()
        .find(|f| f.contains("-64spp-"))
        .expect("a kept reference");
    let again = format!("{words} --json b.json -j 3");
    place.run(&again).ok().says(&["the reference is", kept]);
    let given = words.replace("--reference-spp 64", &format!("--reference {kept}"));
    place.run(&format!("{given} --json c.json")).ok();
    for other in ["b.json", "c.json"] {
        for i in 0..2 {
            for key in ["l1", "rmse", "ssim", "memory_bytes"] {
                let of = |name| json(&place, name)["scenes"][0]["rows"][i][key].clone();
                assert_eq!(of("a.json"), of(other), "{other} {i} {key}");
            }
        }
    }
}

#[test]
fn the_last_method_is_what_a_render_does_and_all_that_guide_may_share() {
    let place = place();
    let words =
        format!("table1 {TINY} --repeats 1 --method gmm,double-render --seed 3 --paths 600");
    let ran = place
        .run(&format!("{words} --reuse 8 --json shared.json -o shared"))
        .ok();
    assert!(ran.out.contains("8 a group"), "{}", ran.out);
    place.run(&format!("{words} --json alone.json")).ok();
    let rmse = |name, row: usize| {
        let rmse = &json(&place, name)["scenes"][0]["rows"][row]["rmse"];
        rmse.as_f64().unwrap()
    };
    for row in 0..2 {
        assert!(rmse("shared.json", row) != rmse("alone.json", row));
    }
    place
        .run("render scene.xml --spp 4 --guide double --reuse 8 --paths 600 --seed 3 -o r.png")
        .ok();
    place
        .run("compare r.png --reference shared/scene-double-render.png --json same.json")
        .ok();
    assert_eq!(json(&place, "same.json")["images"][0]["rmse"], 0.0);
}

#[test]
fn what_cannot_be_measured_is_said_before_anything_is_rendered() {
    let place = place();
    place
        .run("table1")
        .fails(2, &["scenes/pool/pool.xml is not here", "--scene FILE"]);
    place
        .run("table1 --scene scene.xml --reference a.exr --reference b.exr")
        .fails(2, &["2 references do not fit 1 scenes", "help:"]);
    place.run("table1 --scene none.xml").fails(2, &["none.xml"]);
    place
        .run("table1 --scene scene.xml --json no/such/t.json")
        .fails(1, &["no/such"]);
    let dark = Place::replacing(
        r#"<emitter type="constant"><rgb name="radiance" value="0.4"/></emitter>"#,
        "",
    );
    let text = String::from_utf8(dark.read("scene.xml")).unwrap();
    let text = text.replace(
        r#"<emitter type="area"><rgb name="radiance" value="6, 5, 4"/></emitter>"#,
        "",
    );
    std::fs::write(dark.path("scene.xml"), text).unwrap();
    dark.run(&format!("table1 {TINY}"))
        .fails(2, &["nothing shines"]);
}

#[test]
fn mixtures_guide_a_render_and_keep_its_bits_on_any_number_of_threads() {
    let place = place();
    let words = "render scene.xml --spp 4 --format float --guide gmm --photons 5000 --batches 4";
    place
        .run(&format!("{words} -o a.exr -j 1 --stats a.json"))
        .ok()
        .says(&["mixtures"]);
    place.run(&format!("{words} -o b.exr -j 3")).ok();
    let read = |name| read_channels(&place.path(name));
    assert!(read("a.exr") == read("b.exr"));
    place
        .run("render scene.xml -o c.exr --spp 4 --format float")
        .ok();
    assert!(read("a.exr") != read("c.exr"), "the mixtures guide");
    let stats = json(&place, "a.json");
    assert!(stats["field_memory_bytes"].as_u64().unwrap() > 0);
    assert!(stats["train_seconds"].as_f64().unwrap() > 0.0);
}

#[test]
fn mixtures_refuse_what_they_cannot_do() {
    let place = place();
    let words = "render scene.xml --guide gmm --photons 100 --batches 2";
    place
        .run(&format!("{words} --train paths"))
        .fails(2, &["photons alone"]);
    place
        .run(&format!("{words} --guide-model vmf"))
        .fails(2, &["--guide-model", "--guide double"]);
    place
        .run("render scene.xml --guide gmm --field a.field")
        .fails(2, &["--guide gmm does not go with --field"]);
}

#[test]
fn an_sd_tree_guides_a_render_to_the_same_mean_and_the_same_bits_on_any_number_of_threads() {
    let place = place();
    // Samples that are spread evenly are better than their variance says, and that of the few
    // pixels at the edge of a visible lamp is told too small.
    let words = "render scene.xml --spp 1024 --sampler independent --hide-emitters --format float \
                 --aov variance";
    let guided = format!("{words} --guide ppg --trial never --adaptive never --reuse 1");
    place
        .run(&format!("{guided} -o a.exr -j 1 --stats a.json"))
        .ok();
    place.run(&format!("{guided} -o b.exr -j 3")).ok();
    let read = |name| read_channels(&place.path(name));
    assert!(read("a.exr") == read("b.exr"));
    let stats = json(&place, "a.json");
    assert!(stats["field_memory_bytes"].as_u64().unwrap() > 0);
    assert!(stats["field"]["links"].as_u64().unwrap() > 100, "{stats:#}");
    place
        .run(&format!("{words} --guide none --seed 2 -o plain.exr"))
        .ok();
    place.run("compare a.exr -r plain.exr --json z.json").ok();
    let errors = &json(&place, "z.json")["images"][0];
    for c in 0..3 {
        let z = errors["z"]["of_mean"][c].as_f64().unwrap();
        // Once in a thousand times it is beyond that.
        assert!(z.abs() < 3.3, "{errors:#}");
        // A bias of 1 % would be, even if chance took 3.3 standard errors (the difference over z)
        // off it.
        let error = (errors["mean_ratio_rgb"][c].as_f64().unwrap() - 1.0) / z;
        assert!(error > 0.0 && error < 0.01 / (2.0 * 3.3), "{errors:#}");
    }
    // 99.9 % of 1296 numbers are expected, in threes: more than 13 outside hardly ever.
    let inside = errors["z"]["inside"].as_f64().unwrap();
    assert!(inside > 0.99, "{errors:#}");
}

#[test]
fn sd_trees_are_not_kept_in_files_and_know_no_photons() {
    let place = place();
    place
        .run("render scene.xml --guide ppg --field a.field")
        .fails(2, &["--guide ppg does not go with --field"]);
    place
        .run("render scene.xml --spp 2 --guide ppg --photons 100 -o a.exr")
        .ok()
        .says(&["--photons has no effect: --guide ppg learns from camera paths alone"]);
    place.run("render scene.xml --guide ppg --paths 0").fails(
        2,
        &["--guide ppg learns from camera paths alone", "--paths"],
    );
}
