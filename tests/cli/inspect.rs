//! `twintree info` and `twintree check`.

use super::support::Place;

#[test]
fn info_counts_what_is_in_a_scene() {
    let place = Place::new();
    let json = place.run("info scene.xml --json").ok().out;
    let info: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(info["shapes"]["sphere"], 1);
    assert_eq!(info["lights"]["area"], 1);
    assert_eq!(info["lights"]["constant"], 1);
    assert!(info["materials"]["diffuse"].as_u64() >= Some(1));
    assert_eq!(info["film"]["width"], 24);
    assert_eq!(info["film"]["height"], 18);
    assert_eq!(info["render"]["max_depth"], 4);
    assert_eq!(info["render"]["spp"], 4);
    assert_eq!(info["camera"], "perspective");
    assert_eq!(info["warnings"], serde_json::json!([]));
    let table = place.run("info scene.xml").ok().out;
    assert!(table.contains("film       24 x 18"), "{table}");
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn info_says_what_a_scene_does_without() {
    let place = Place::new();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";
    std::fs::write(place.path("a.obj"), obj).unwrap();
    let left_out = |words: &str| {
        let json = place.run(&format!("info {words} --json")).ok().out;
        let info: serde_json::Value = serde_json::from_str(&json).unwrap();
        let list = info["left_out"].as_array().unwrap().clone();
        let one = |l: serde_json::Value| {
            (
                l["what"].as_str().unwrap().to_owned(),
                l["saved_bytes"].as_u64(),
            )
        };
        list.into_iter().map(one).collect::<Vec<_>>()
    };
    let all = left_out("a.obj --material mirror");
    let has = |what: &str, bytes| assert!(all.contains(&(what.into(), bytes)), "{all:?}");
    // Three corners of two numbers each.
    has("texture coordinates", Some(24));
    has("texture system", None);
    has("light tree", None);
    has("learned field", None);
    let clay = left_out("a.obj");
    assert!(clay.iter().all(|l| l.0 != "learned field"), "{clay:?}");
    let table = place.run("info a.obj").ok().out;
    assert!(
        table.contains("without    texture coordinates: no material of 1 mesh"),
        "{table}"
    );
}

#[test]
fn definitions_reach_the_scene() {
    let ran = Place::new()
        .run("info scene.xml -D size=50 -D spp=9 --json")
        .ok();
    let info: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    assert_eq!(
        (&info["film"]["width"], &info["render"]["spp"]),
        (&50.into(), &9.into())
    );
}

/// A tetrahedron; without its last face it has a border.
const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

#[test]
fn info_tells_the_precautions_and_why() {
    let with = |obj: &str, bsdf: &str| {
        let shape = format!(
            r#"<shape type="obj"><string name="filename" value="body.obj"/>{bsdf}</shape></scene>"#
        );
        let place = Place::replacing("</scene>", &shape);
        std::fs::write(place.path("body.obj"), obj).unwrap();
        place.run("info scene.xml").ok().out
    };
    let says = |text: String, line: &str| assert!(text.contains(line), "{line}: {text}");
    let open = TETRAHEDRON.replace("f 2 3 4\n", "");
    says(
        with(TETRAHEDRON, ""),
        "precaution watertight edges on: the mesh body.obj is closed",
    );
    says(
        with(&open, r#"<bsdf type="dielectric"/>"#),
        "precaution watertight edges on: the mesh body.obj refracts",
    );
    says(
        with(&open, ""),
        "precaution watertight edges off: no mesh is closed or refracts",
    );
    says(with(&open, ""), "precaution moved to the origin off: ");
    let json = Place::new().run("info scene.xml --json").ok().out;
    let info: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(info["precautions"][0]["on"], false, "{info}");
}

/// Two triangles in a group that stands in two places.
const GROUP: &str = r#"<shape type="shapegroup" id="pair">
    <shape type="obj"><string name="filename" value="two.obj"/></shape>
  </shape>
  <shape type="instance"><ref id="pair"/></shape>
  <shape type="instance"><ref id="pair"/>
    <transform name="to_world"><translate x="1"/></transform>
  </shape>
</scene>"#;

#[test]
fn instances_count_once_in_memory_and_each_time_in_the_world() {
    let place = Place::replacing("</scene>", GROUP);
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";
    std::fs::write(place.path("two.obj"), obj).unwrap();
    let count = |text: &str| {
        let info: serde_json::Value = serde_json::from_str(text).unwrap();
        ["triangles", "triangles_placed", "vertices", "instances"]
            .map(|key| info[key].as_u64().unwrap())
    };
    let with = count(&place.run("info scene.xml --json").ok().out);
    let without = count(&Place::new().run("info scene.xml --json").ok().out);
    let more: Vec<u64> = with.iter().zip(without).map(|(a, b)| a - b).collect();
    assert_eq!(more, [2, 4, 4, 2]);
}

#[test]
fn check_of_a_good_scene_says_so_and_writes_nothing() {
    let place = Place::new();
    let ran = place.run("check scene.xml").ok();
    assert_eq!(ran.out, "scene.xml: no warnings\n");
    assert_eq!(ran.err, "");
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn every_scene_of_the_project_loads_without_warnings() {
    let scenes = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut found = 0;
    for folder in std::fs::read_dir(scenes).unwrap() {
        let folder = folder.unwrap().path();
        let Ok(files) = std::fs::read_dir(folder) else {
            continue;
        };
        for file in files.map(|f| f.unwrap().path()) {
            if file.extension().is_some_and(|e| e == "xml") {
                let ran = Place::new().run(&format!("check {}", file.display())).ok();
                assert_eq!(ran.err, "", "{}", file.display());
                found += 1;
            }
        }
    }
    assert!(found >= 7, "{found} scenes found");
}
