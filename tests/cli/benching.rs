//! `twintree bench accel`.

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
