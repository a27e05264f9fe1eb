//! What is wrong is named, with its place and what to do.

use super::support::{Place, SCENE};

#[test]
fn an_unknown_flag_suggests_the_nearest() {
    let ran = Place::new().run("render scene.xml --ssp 4");
    ran.fails(2, &["--ssp", "--spp"]);
}

#[test]
fn bad_values_name_the_flag_and_what_was_expected() {
    let place = Place::new();
    for (words, parts) in [
        ("-D spp", ["spp", "key=value"]),
        ("-D =4", ["=4", "key=value"]),
        ("--crop 1,2,3", ["--crop", "x0,y0,x1,y1"]),
        ("--crop 5,0,5,9", ["--crop", "no pixel"]),
        ("--crop 0,0,25,18", ["0,0,25,18", "24 x 18"]),
        ("--time 5x", ["--time", "1h30m"]),
        ("--time 0", ["--time", "above 0"]),
        ("--noise -1", ["--noise", "above 0"]),
        ("--spp 0", ["--spp", "above 0"]),
        ("-j 0", ["--threads", "1.."]),
        ("--texture-memory 5X", ["--texture-memory", "512M"]),
        ("--aov albedo,colour", ["--aov", "colour"]),
        ("--guide maybe", ["--guide", "double"]),
        ("--preview gimp", ["--preview", "tev=host:port"]),
        ("--max-depth 0", ["--max-depth", "unlimited"]),
        ("--width 0", ["--width", "1.."]),
    ] {
        let words = format!("render scene.xml {words}");
        place.run(&words).fails(2, &parts);
    }
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn a_missing_scene_is_named() {
    for command in ["render", "info", "check"] {
        Place::new()
            .run(&format!("{command} nowhere.xml"))
            .fails(2, &["nowhere.xml"]);
    }
}

const MISSING_MESH: &str = r#"<shape type="ply" id="lamp">
    <string name="filename" value="meshes/lamp.ply"/>
  </shape>
</scene>"#;

#[test]
fn a_missing_mesh_is_named_with_the_place_that_asks_for_it() {
    let place = Place::replacing("</scene>", MISSING_MESH);
    // The filename stands in the second line of what took the last line's place.
    let line = SCENE.lines().count() + 1;
    let asker = format!("scene.xml:{line}:");
    for command in ["render", "check"] {
        place
            .run(&format!("{command} scene.xml"))
            .fails(2, &["meshes/lamp.ply", &asker, "--lenient"]);
    }
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn a_lenient_render_goes_on_without_a_mesh_and_says_so() {
    let place = Place::replacing("</scene>", MISSING_MESH);
    let ran = place.run("render scene.xml -o out.exr --spp 1 --lenient --stats stats.json");
    ran.ok().says(&["warning: ", "lamp.ply"]);
    assert_eq!(place.files(), ["out.exr", "scene.xml", "stats.json"]);
    let stats = String::from_utf8(place.read("stats.json")).unwrap();
    assert!(stats.contains("lamp.ply"), "{stats}");
}

#[test]
fn an_unknown_plugin_is_placed_and_the_nearest_name_suggested() {
    let place = Place::replacing(r#"bsdf type="diffuse""#, r#"bsdf type="difuse""#);
    let line = SCENE.lines().position(|l| l.contains("bsdf type")).unwrap() + 1;
    let column = "    <".len();
    let at = format!("error: scene.xml:{line}:{column}: ");
    let ran = place.run("check scene.xml");
    ran.fails(2, &[&at, "difuse", "help: ", "diffuse"]);
}

#[test]
fn an_unknown_parameter_is_one_warning() {
    let old = r#"<float name="radius" value="0.2"/>"#;
    let place = Place::replacing(old, &format!(r#"{old}<float name="raduis" value="1"/>"#));
    let ran = place
        .run("check scene.xml")
        .ok()
        .says(&["raduis", "scene.xml:"]);
    assert_eq!(ran.err.matches("warning: ").count(), 1, "{ran:#?}");
    assert!(ran.out.contains("1 warning"), "{ran:#?}");
}

#[test]
fn broken_xml_is_placed() {
    let place = Place::replacing("</sensor>", "</sensr>");
    let line = SCENE.lines().position(|l| l.contains("</sensor>")).unwrap() + 1;
    place
        .run("check scene.xml")
        .fails(2, &[&format!("scene.xml:{line}:")]);
}

#[test]
fn outputs_are_tried_before_the_scene_is_read() {
    // The scene is wrong as well: what is said is about the output, so that was tried first.
    let place = Place::with("not a scene");
    for (output, code, part) in [
        ("picture", 2, ".exr"),
        ("picture.gif", 2, ".exr"),
        ("nowhere/picture.exr", 1, "mkdir -p nowhere"),
        (".", 2, "."),
    ] {
        place
            .run(&format!("render scene.xml -o {output}"))
            .fails(code, &[output, part]);
    }
    place
        .run("render scene.xml -o a.exr --stats nowhere/stats.json")
        .fails(1, &["nowhere/stats.json"]);
    assert_eq!(place.files(), ["scene.xml"]);
}

#[test]
fn a_directory_in_the_place_of_an_output_stays() {
    let place = Place::new();
    std::fs::create_dir(place.path("out.exr")).unwrap();
    place
        .run("render scene.xml -o out.exr")
        .fails(1, &["out.exr is a directory"]);
}

#[cfg(target_os = "linux")]
#[test]
fn an_output_that_cannot_be_written_is_an_error() {
    // /proc takes no files, not even from root.
    Place::new()
        .run("render scene.xml -o /proc/out.exr")
        .fails(1, &["/proc/out.exr"]);
}

#[test]
fn a_film_beyond_memory_is_refused() {
    Place::new()
        .run("render scene.xml --width 131072 --height 131072")
        .fails(1, &["MiB are free", "--crop"]);
}
