//! `twintree bench`.

use super::support::Place;

/// A tetrahedron: closed, four triangles.
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
const QUICK: &str = "--rays 1024 --seconds 0";

fn run(place: &Place, words: &str) -> serde_json::Value {
    let ran = place.run(&format!("bench accel {words} {QUICK} --json out.json"));
    let ran = ran.ok();
    assert!(ran.out.contains("| tracer"), "{ran:#?}");
    serde_json::from_slice(&place.read("out.json")).unwrap()
}

#[test]
fn every_configuration_is_measured_on_a_mesh() {
    let place = Place::new();
    std::fs::write(place.path("four.obj"), OBJ).unwrap();
    let report = run(&place, "four.obj -j 2");
    assert_eq!(report["triangles"], 4);
    assert_eq!(report["closed_meshes"], 1);
    assert_eq!(report["threads"], 2);
    let tracers = report["tracers"].as_array().unwrap();
    // Three qualities, Embree with two modes each.
    let expected = if cfg!(feature = "embree") { 9 } else { 3 };
    assert_eq!(tracers.len(), expected, "{report:#}");
    for tracer in tracers {
        for threads in ["single", "all"] {
            for kind in ["camera", "shadow", "diffuse"] {
                let rate = tracer[threads][kind].as_f64().unwrap();
                assert!((1e3..1e12).contains(&rate), "{tracer:#}");
            }
        }
        assert!(tracer["build_seconds"].as_f64() > Some(0.0), "{tracer:#}");
        assert!(tracer["memory_bytes"].as_u64() > Some(0), "{tracer:#}");
        assert_eq!(tracer["misses"]["uniform"], 0.0, "{tracer:#}");
        // Robust, edges hold; Embree's vertices do not quite.
        if tracer["mode"] == "robust" {
            let is_ours = tracer["name"] == "obvhs 0.2";
            let at_vertices = tracer["misses"]["vertices"].as_f64().unwrap();
            assert_eq!(tracer["misses"]["edges"], 0.0, "{tracer:#}");
            assert!(
                at_vertices <= if is_ours { 0.0 } else { 0.05 },
                "{tracer:#}"
            );
        }
    }
}

#[test]
fn a_choice_of_tracers_and_qualities_is_measured_on_a_scene() {
    let place = Place::new();
    let report = run(&place, "scene.xml --accel obvhs --quality fast,high");
    let tracers = report["tracers"].as_array().unwrap();
    assert_eq!(tracers.len(), 2, "{report:#}");
    assert_eq!(tracers[1]["quality"], "high");
    assert!(tracers[0]["name"].as_str().unwrap().contains("obvhs"));
    // A wall and a ball without triangles.
    assert!(tracers[0]["misses"].is_null(), "{report:#}");
}

#[test]
fn what_cannot_be_measured_is_told_in_words() {
    let place = Place::replacing(
        "origin=\"0, 0, 4\" target=\"0, 0, 0\"",
        "origin=\"0, 0, 4\" target=\"0, 0, 9\"",
    );
    place
        .run("bench accel scene.xml")
        .fails(2, &["no ray of the camera"]);
    place
        .run("bench accel nowhere.ply")
        .fails(2, &["nowhere.ply"]);
    place
        .run("bench accel scene.xml --rays 3")
        .fails(2, &["--rays"]);
}

#[test]
fn growth_is_measured_over_sizes_and_drawn() {
    let place = Place::new();
    let words = "--least 200 --most 4k --kind torus-knot --json out.json --svg out.svg -j 2";
    let ran = place.run(&format!("bench scale {words} {QUICK}")).ok();
    assert!(
        ran.out.contains("torus-knot, binary PLY, 2 threads"),
        "{ran:#?}"
    );
    let report: serde_json::Value = serde_json::from_slice(&place.read("out.json")).unwrap();
    let sizes = report["sizes"].as_array().unwrap();
    assert_eq!(sizes.len(), 4, "{report:#}");
    for size in sizes {
        let triangles = size["triangles"].as_u64().unwrap();
        // A vertex and its normal for two triangles, three indices for each.
        let mesh = size["mesh_bytes"].as_u64().unwrap();
        assert!(
            (24 * triangles..28 * triangles + 1000).contains(&mesh),
            "{size:#}"
        );
        assert!(size["load_seconds"].as_f64() > Some(0.0), "{size:#}");
        assert!(size["floor_seconds"].as_f64() > Some(0.0), "{size:#}");
        for tracer in size["tracers"].as_array().unwrap() {
            assert!(tracer["camera"].as_f64() > Some(1e3), "{tracer:#}");
        }
    }
    let drawn = String::from_utf8(place.read("out.svg")).unwrap();
    assert!(drawn.starts_with("<svg") && drawn.contains("n log n"));
    // The meshes are gone.
    assert_eq!(place.files(), ["out.json", "out.svg", "scene.xml"]);
    place
        .run("bench scale --directory nowhere")
        .fails(1, &["nowhere", "--directory"]);
}
