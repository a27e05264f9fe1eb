//! Files as they come from elsewhere, and files made to break a reader.

use super::stage::Stage;
use flate2::Compression;
use flate2::write::GzEncoder;
use std::io::Write;

const SCENE: &str =
    "Camera \"perspective\"\nWorldBegin\nLightSource \"infinite\"\nShape \"sphere\"\n";

fn packed(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
    encoder.write_all(text).expect("packed");
    encoder.finish().expect("packed")
}

/// What is said of a scene, which is refused.
fn refused(stage: &Stage, name: &str) -> String {
    let error = stage.try_load(name, false).err();
    error
        .unwrap_or_else(|| panic!("{name} is taken"))
        .to_string()
}

#[test]
fn every_way_to_write_a_text_is_read() {
    let stage = Stage::new();
    let one_line = SCENE.replace('\n', " ");
    let texts: Vec<(&str, Vec<u8>)> = vec![
        ("plain", SCENE.into()),
        ("mark", [b"\xef\xbb\xbf", SCENE.as_bytes()].concat()),
        ("crlf", SCENE.replace('\n', "\r\n").into()),
        ("cr", SCENE.replace('\n', "\r").into()),
        ("one line", one_line.into()),
        ("tabs", SCENE.replace(' ', "\t\t ").into()),
        (
            "comments",
            SCENE.replace('\n', " # ] \" WorldBegin\n\n").into(),
        ),
        ("no end of line", SCENE.trim_end().into()),
        ("zeros", [SCENE.as_bytes(), b"\0\0\0"].concat()),
        ("v3", format!("{SCENE}WorldEnd\n").into()),
        ("latin-1", [b"# caf\xe9\n", SCENE.as_bytes()].concat()),
    ];
    for (what, text) in texts {
        stage.write("scene.pbrt", &text);
        let d = stage.load("scene.pbrt");
        assert_eq!((d.shapes.len(), d.emitters.len()), (1, 1), "{what}");
        assert!(d.warnings.is_empty(), "{what}: {:?}", d.warnings);
        stage.write("packed.pbrt.gz", packed(&text));
        assert_eq!(stage.load("packed.pbrt.gz").shapes.len(), 1, "{what}");
    }
    stage.write("wide.pbrt", b"\xff\xfeS\0h\0");
    assert!(refused(&stage, "wide.pbrt").contains("UTF-16"));
    stage.write("empty.pbrt", "");
    assert!(stage.load("empty.pbrt").warnings.join("").contains("empty"));
}

#[test]
fn all_that_is_wrong_is_told_at_once_with_its_place() {
    let stage = Stage::new();
    stage.write("scene.pbrt", format!(
        "{SCENE}Shap \"sphere\"\nShape \"spere\"\nShape \"sphere\" \"float radius\" x\n\
         Material \"diffuse\" \"texture reflectance\" \"no\"\nShape \"disk\"\n\
         Shape \"plymesh\" \"string filename\" \"no.ply\"\nAttributeEnd\nFilm \"rgb\"\n\
         NamedMaterial \"none\"\nShape \"disk\"\nObjectInstance \"tree\"\nLightSource \"sun\"\n\
         Include \"gone.pbrt\"\nShape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0] \"integer indices\" [0 1 3]\n"
    ));
    let all = refused(&stage, "scene.pbrt");
    for part in [
        ":5:1: there is no directive \"Shap\"; did you mean \"Shape\"",
        ":6:1: shapes of the kind \"spere\" are not read; did you mean \"sphere\"",
        ":7:31: a number is expected",
        ":8:20: there is no spectrum texture \"no\"",
        "no.ply",
        ":11:1: nothing was begun",
        ":12:1: \"Film\" belongs before \"WorldBegin\"",
        ":13:1: there is no material \"none\"",
        ":15:1: there is no object \"tree\"",
        ":16:1: there is no light of the kind \"sun\"",
        "gone.pbrt",
        "\"indices\" names vertex 3, but there are 3",
        "12 errors",
    ] {
        assert!(all.contains(part), "{part}:\n{all}");
    }
    let lenient = stage
        .try_load("scene.pbrt", true)
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(lenient.shapes.len(), 3);
    assert_eq!(lenient.warnings.len(), 12, "{:#?}", lenient.warnings);
}

#[test]
fn what_nothing_reads_is_told() {
    let stage = Stage::new();
    stage.write(
        "scene.pbrt",
        format!(
            "{SCENE}Shape \"sphere\" \"float radus\" 2\nOption \"wavfront\" true\nAttributeBegin\n"
        ),
    );
    let d = stage.load("scene.pbrt");
    let all = d.warnings.join("\n");
    for part in [
        ":5:16: Shape \"sphere\" has no parameter \"radus\"; did you mean \"radius\"",
        ":6:1: there is no option \"wavfront\"; did you mean",
        ":7:1: this \"AttributeBegin\" has no end",
    ] {
        assert!(all.contains(part), "{part}:\n{all}");
    }
}

#[test]
fn files_that_include_each_other_end() {
    let stage = Stage::new();
    stage.write("a.pbrt", "WorldBegin Include \"b.pbrt\"");
    stage.write("b.pbrt", "Shape \"sphere\" Include \"a.pbrt\"");
    assert!(refused(&stage, "a.pbrt").contains("includes itself"));
    stage.write("self.pbrt", "Include \"self.pbrt\"");
    assert!(refused(&stage, "self.pbrt").contains("includes itself"));
    // Each includes the next one twice: 2^40 texts.
    for i in 0..40 {
        let next = format!("Include \"{}.pbrt\"\n", i + 1).repeat(2);
        stage.write(&format!("{i}.pbrt"), next + &"#".repeat(1 << 16));
    }
    stage.write("40.pbrt", "");
    assert!(refused(&stage, "0.pbrt").contains("--limit-decoded"));
    // A chain that is too deep.
    for i in 0..100 {
        stage.write(
            &format!("c{i}.pbrt"),
            format!("Include \"c{}.pbrt\"", i + 1),
        );
    }
    stage.write("c100.pbrt", "");
    assert!(refused(&stage, "c0.pbrt").contains("deep"));
}

#[test]
fn bombs_and_pipes_are_refused() {
    let stage = Stage::new();
    stage.write("bomb.pbrt.gz", packed(&vec![b' '; 1 << 30]).repeat(2));
    assert!(refused(&stage, "bomb.pbrt.gz").contains("--limit-decoded"));
    let pipe = stage.path("pipe.pbrt");
    let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
    rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).expect("a pipe");
    assert!(refused(&stage, "pipe.pbrt").contains("a pipe"));
    stage.write("scene.pbrt", "WorldBegin Include \"pipe.pbrt\"");
    assert!(refused(&stage, "scene.pbrt").contains("a pipe"));
    stage.write(
        "image.pbrt",
        "WorldBegin LightSource \"infinite\" \"string filename\" \"pipe.pbrt\"",
    );
    refused(&stage, "image.pbrt");
    stage.write(
        "mesh.pbrt",
        "WorldBegin Shape \"plymesh\" \"string filename\" \"pipe.pbrt\"",
    );
    assert!(refused(&stage, "mesh.pbrt").contains("a pipe"));
}

#[test]
fn structures_that_blow_up_are_refused() {
    let stage = Stage::new();
    let mut textures = String::from(
        "WorldBegin Texture \"t0\" \"spectrum\" \"imagemap\" \"string filename\" \"no.png\"\n",
    );
    let mut materials =
        String::from("WorldBegin MakeNamedMaterial \"m0\" \"string type\" \"diffuse\"\n");
    for i in 1..60 {
        let last = i - 1;
        textures += &format!(
            "Texture \"t{i}\" \"spectrum\" \"mix\" \"texture tex1\" \"t{last}\" \"texture tex2\" \
             \"t{last}\"\n"
        );
        materials += &format!(
            "MakeNamedMaterial \"m{i}\" \"string type\" \"mix\" \"string materials\" [\"m{last}\" \
             \"m{last}\"]\n"
        );
    }
    stage.write(
        "t.pbrt",
        textures + "Material \"diffuse\" \"texture reflectance\" \"t59\" Shape \"sphere\"",
    );
    stage.write(
        "m.pbrt",
        materials + "NamedMaterial \"m59\" Shape \"sphere\"",
    );
    stage.write(
        "c.pbrt",
        "WorldBegin Texture \"a\" \"float\" \"scale\" \"texture tex\" \"a\" \
        Shape \"sphere\" \"texture alpha\" \"a\"",
    );
    stage.write(
        "k.pbrt",
        "WorldBegin MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string \
        materials\" [\"a\" \"a\"] NamedMaterial \"a\" Shape \"sphere\"",
    );
    let cube = "\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]";
    stage.write(
        "s.pbrt",
        format!("WorldBegin Shape \"loopsubdiv\" {cube} \"integer levels\" 2000000000"),
    );
    stage.write(
        "n.pbrt",
        format!("WorldBegin {}", "AttributeBegin ".repeat(100_000)),
    );
    for name in ["t.pbrt", "m.pbrt", "c.pbrt", "k.pbrt", "s.pbrt", "n.pbrt"] {
        refused(&stage, name);
        // Whatever is left of it ends.
        let _ = stage.try_load(name, true);
    }
}

#[test]
fn included_and_imported_files_see_what_they_should() {
    let stage = Stage::new();
    stage.write(
        "geometry/part.pbrt",
        "Translate 0 0 5 ReverseOrientation Shape \"sphere\" \
        MakeNamedMaterial \"m\" \"string type\" \"dielectric\"",
    );
    stage.write(
        "a.pbrt",
        "WorldBegin Import \"geometry/part.pbrt\" NamedMaterial \"m\" Shape \"disk\"",
    );
    stage.write(
        "b.pbrt",
        "WorldBegin Include \"geometry/part.pbrt\" NamedMaterial \"m\" Shape \"disk\"",
    );
    let [imported, included] = ["a.pbrt", "b.pbrt"].map(|name| stage.load(name));
    // An import leaves the transform and the orientation as they were.
    assert_eq!(
        [
            imported.shapes[0].flip_normals,
            imported.shapes[1].flip_normals
        ],
        [true, false]
    );
    assert_eq!(
        [
            included.shapes[0].flip_normals,
            included.shapes[1].flip_normals
        ],
        [true, true]
    );
    let same = imported.materials.get(imported.shapes[1].material).name();
    assert_eq!(same, "dielectric");
}
