//! Where files are looked for: as Mitsuba does, from the main scene's folder also within included
//! files.

use super::Stage;
use crate::scene::Description;

/// The files of textures that were asked for, by their folders' names.
fn folders(stage: &Stage) -> Vec<String> {
    let asked = stage.textures.0.lock().unwrap();
    let folder = |path: &std::path::Path| {
        let folder = path.parent().and_then(|p| p.file_name()).unwrap();
        folder.to_string_lossy().into_owned()
    };
    asked.iter().map(|s| folder(&s.path)).collect()
}

const TEXTURED: &str = "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='t.png'/></texture></bsdf></shape>";

fn include(stage: &Stage, inside: &str) -> Description {
    stage.file(
        "frag/part.xml",
        &format!("<scene version='3.0.0'>{inside}</scene>"),
    );
    stage.modern("<include filename='frag/part.xml'/>")
}

#[test]
fn files_named_in_an_included_file_lie_beside_the_main_one() {
    let stage = Stage::new();
    stage.file("t.png", "");
    stage.file("frag/t.png", "");
    include(&stage, TEXTURED);
    let own = stage.path("t.png");
    let main = own.parent().unwrap().file_name().unwrap();
    assert_eq!(folders(&stage), [main.to_string_lossy()]);
}

#[test]
fn or_beside_the_included_one_if_there_is_none() {
    let stage = Stage::new();
    stage.file("frag/t.png", "");
    include(&stage, TEXTURED);
    assert_eq!(folders(&stage), ["frag"]);
}

#[test]
fn what_path_names_comes_before_both() {
    let stage = Stage::new();
    for name in ["t.png", "frag/t.png", "frag/common/t.png", "late/t.png"] {
        stage.file(name, "");
    }
    // The directory of a <path> is looked for beside its own file first.
    include(
        &stage,
        &format!("<path value='late'/><path value='common'/>{TEXTURED}"),
    );
    assert_eq!(folders(&stage), ["common"]);
}

#[test]
fn meshes_environments_spectra_and_includes_follow_the_same_rule() {
    let stage = Stage::new().with_files();
    stage.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    stage.file("frag/a.obj", "this is none");
    stage.exr("sky.exr", 4, 1.0);
    stage.file("frag/sky.exr", "this is none");
    stage.file("s.spd", "\u{feff}400 0.5\n700 0.5\n");
    stage.file("frag/s.spd", "this is none");
    stage.file(
        "more.xml",
        "<scene version='3.0.0'><shape type='cube'/></scene>",
    );
    let d = include(
        &stage,
        "<include filename='more.xml'/>
         <shape type='obj'><string name='filename' value='a.obj'/></shape>
         <shape type='sphere'><bsdf type='diffuse'><spectrum name='reflectance' filename='s.spd'/></bsdf></shape>
         <emitter type='envmap'><string name='filename' value='sky.exr'/></emitter>",
    );
    assert_eq!((d.shapes.len(), d.emitters.len()), (3, 1));
    assert_eq!(d.warnings, [""; 0]);
}

#[test]
fn directories_of_included_files_may_lie_beside_the_main_one() {
    let stage = Stage::new();
    stage.file("common/t.png", "");
    include(&stage, &format!("<path value='common'/>{TEXTURED}"));
    assert_eq!(folders(&stage), ["common"]);
}
