//! Scenes with something wrong: every message says where, what, and what to do.

use super::Stage;

fn said(inside: &str) -> String {
    Stage::new().error(inside).to_string()
}

/// (what stands in the scene, words the message must have).
const MISTAKES: &[(&str, &[&str])] = &[
    (
        "<bsdf type='difuse'/>",
        &[
            "scene.xml:1:",
            "bsdf \"difuse\"",
            "did you mean \"diffuse\"?",
        ],
    ),
    (
        "<shape type='sphere'><ref id='whit'/></shape><bsdf type='diffuse' id='white'/>",
        &["nothing has the id \"whit\"", "did you mean \"white\"?"],
    ),
    (
        "<shape type='sphere'><float name='radius' value='-1'/></shape>",
        &["greater than 0"],
    ),
    (
        "<shape type='sphere'><float name='radius' value='a'/></shape>",
        &["\"a\" is not a number"],
    ),
    (
        "<shape type='sphere'><string name='radius' value='1'/></shape>",
        &["must be a <float>"],
    ),
    (
        "<shape type='sphere'><flaot name='radius' value='1'/></shape>",
        &["did you mean \"float\""],
    ),
    (
        "<shape type='sphere'><float value='1'/></shape>",
        &["has no name"],
    ),
    ("<shape/>", &["<shape> has no type"]),
    ("<shape type='obj'/>", &["needs a \"filename\""]),
    (
        "<bsdf type='diffuse' id='a'/><bsdf type='diffuse' id='a'/>",
        &["the id \"a\" is taken", "scene.xml:1:"],
    ),
    (
        "<shape type='sphere'><bsdf type='twosided'><bsdf type='dielectric'/></bsdf></shape>",
        &["light cannot pass through", "without \"twosided\""],
    ),
    (
        "<shape type='sphere'><bsdf type='twosided'><bsdf type='mask'><bsdf type='diffuse'/></bsdf></bsdf></shape>",
        &["light cannot pass through"],
    ),
    (
        "<bsdf type='twosided' id='a'><ref id='b'/></bsdf><bsdf type='twosided' id='b'><ref id='a'/></bsdf>",
        &["holds itself"],
    ),
    (
        "<shape type='sphere'><bsdf type='dielectric'><string name='int_ior' value='watr'/></bsdf></shape>",
        &["\"watr\"", "did you mean \"water\"?"],
    ),
    (
        "<shape type='sphere'><bsdf type='conductor'><string name='material' value='Xx'/></bsdf></shape>",
        &["no conductor is called \"Xx\""],
    ),
    (
        "<shape type='sphere'><bsdf type='roughplastic'><string name='distribution' value='gxg'/></bsdf></shape>",
        &["it can be beckmann, ggx"],
    ),
    (
        "<shape type='obj'><string name='filename' value='no.obj'/></shape>",
        &["no.obj", "restore"],
    ),
    ("<shape type='instance'/>", &["shapegroup"]),
    ("<emitter type='area'/>", &["belongs inside a <shape>"]),
    (
        "<shape type='sphere'><emitter type='point'/></shape>",
        &["cannot stand inside a shape"],
    ),
    ("<include filename='no.xml'/>", &["no.xml"]),
    (
        "<float name='x' value='$y'/>",
        &["$y has no value", "-D y=VALUE"],
    ),
    (
        "<emitter type='sunsky'><float name='turbidity' value='11'/></emitter>",
        &["between 1 and 10"],
    ),
    (
        "<emitter type='point'><point name='position' value='1'/><transform name='to_world'/></emitter>",
        &["not both"],
    ),
    (
        "<shape type='sphere'><transform name='to_world'><matrix value='1 2'/></transform></shape>",
        &["9 or 16 numbers"],
    ),
    (
        "<alias id='none' as='other'/>",
        &["nothing has the id \"none\""],
    ),
    (
        "<shape type='sphere'><ref id='x'><float name='a' value='1'/></ref></shape>",
        &["cannot stand"],
    ),
    ("<animation/>", &["motion is not supported"]),
];

#[test]
fn every_mistake_has_its_message() {
    for (inside, words) in MISTAKES {
        let message = said(inside);
        for word in *words {
            assert!(message.contains(word), "{inside}\n{message}\nlacks {word}");
        }
        assert!(message.contains("scene.xml:1:"), "no place: {message}");
    }
}

#[test]
fn places_are_those_of_the_file() {
    let text = "<scene version='3.0.0'>\n  <shape type='sphere'>\n    <float name='radius' value='x'/>\n  </shape>\n</scene>";
    let error = Stage::new().load(text).unwrap_err();
    let at = error.at.unwrap();
    assert_eq!((at.line, at.column), (3, 5));
    assert!(at.file.ends_with("scene.xml"));
}

#[test]
fn a_scene_must_be_a_scene_with_a_version() {
    let stage = Stage::new();
    let error = stage.load("<scene/>").unwrap_err().to_string();
    assert!(error.contains("version=\"3.0.0\""), "{error}");
    let error = stage.load("<scene version='7'/>").unwrap_err().to_string();
    assert!(error.contains("not known"), "{error}");
    let error = stage
        .load("<shape version='3.0.0' type='sphere'/>")
        .unwrap_err();
    assert!(error.to_string().contains("expected a <scene>"), "{error}");
    let missing = crate::scene::import::mitsuba::load("no/such.xml".as_ref(), &stage.options);
    assert!(
        missing
            .unwrap_err()
            .to_string()
            .starts_with("no/such.xml: cannot read it")
    );
}

#[test]
fn a_file_in_other_letters_is_named() {
    let stage = Stage::new();
    for (there, inside) in [
        (
            "Tex/Wood.png",
            "<shape type='sphere'><bsdf type='diffuse'><texture name='reflectance' type='bitmap'>\
            <string name='filename' value='tex/wood.png'/></texture></bsdf></shape>",
        ),
        (
            "Box.ply",
            "<shape type='ply'><string name='filename' value='box.ply'/></shape>",
        ),
        (
            "Sky.exr",
            "<emitter type='envmap'><string name='filename' value='SKY.exr'/></emitter>",
        ),
        ("More.xml", "<include filename='more.xml'/>"),
        (
            "Lamp.spd",
            "<emitter type='constant'><spectrum name='radiance' filename='lamp.spd'/></emitter>",
        ),
    ] {
        stage.file(there, "");
        let error = stage.error(inside).to_string();
        let hint = format!("{there} (capital and small letters count)");
        assert!(
            error.contains("; there is ") && error.contains(&hint),
            "{error}"
        );
    }
}

#[test]
fn includes_merge_and_do_not_run_in_circles() {
    let stage = Stage::new();
    stage.file(
        "a.xml",
        "<scene version='3.0.0'><include filename='b.xml'/></scene>",
    );
    stage.file(
        "b.xml",
        "<scene version='3.0.0'><include filename='a.xml'/></scene>",
    );
    let error = stage.error("<include filename='a.xml'/>").to_string();
    assert!(
        error.contains("b.xml:1:") && error.contains("includes itself"),
        "{error}"
    );

    stage.file(
        "parts/mats.xml",
        "<scene version='0.6.0'><bsdf type='diffuse' id='m'><rgb name='diffuseReflectance' value='$r'/></bsdf><shape type='obj'><string name='filename' value='x.obj'/></shape></scene>",
    );
    stage.file("parts/x.obj", "");
    stage.file(
        "parts/one.xml",
        "<shape version='3.0.0' type='sphere'><ref id='m'/></shape>",
    );
    let d = stage.modern("<default name='r' value='0.25'/><include filename='parts/mats.xml'/><include filename='parts/one.xml'/>");
    assert_eq!(d.warnings, [""; 0]);
    assert_eq!(d.shapes.len(), 2);
}

/// Files that include a file twice, ten deep: the number of objects is limited, not only the depth.
#[test]
fn exponential_includes_stay_within_the_depth_limit() {
    let stage = Stage::new();
    for i in 0..12 {
        let include = format!("<include filename='f{}.xml'/>", i + 1);
        stage.file(
            &format!("f{i}.xml"),
            &format!("<scene version='3.0.0'>{include}{include}</scene>"),
        );
    }
    let error = stage.error("<include filename='f0.xml'/>").to_string();
    assert!(error.contains("nested more than"), "{error}");
}

#[test]
fn what_nobody_knows_is_a_warning_with_a_hint() {
    let stage = Stage::new().define("unused", "1");
    let d = stage.modern(
        "<shape type='sphere'><float name='radios' value='2' vlaue='3'/><bsdf type='diffuse'><float name='alpha' value='1'/></bsdf></shape>",
    );
    let all = d.warnings.join("\n");
    assert_eq!(d.warnings.len(), 4, "{all}");
    assert!(
        all.contains("<float> has no attribute \"vlaue\"; did you mean \"value\"?"),
        "{all}"
    );
    assert!(all.contains("-D unused"), "{all}");
    assert!(
        all.contains("no parameter \"radios\"; did you mean \"radius\"?"),
        "{all}"
    );
    assert!(
        all.contains("bsdf \"diffuse\" has no parameter \"alpha\""),
        "{all}"
    );
    assert!(all.contains("scene.xml:1:"), "{all}");
}

#[test]
fn all_missing_meshes_are_named_at_once() {
    let stage = Stage::new();
    let shapes = "<shape type='obj'><string name='filename' value='one.obj'/></shape>\n<shape type='ply'><string name='filename' value='two.ply'/></shape>";
    let error = stage.error(shapes).to_string();
    assert!(error.ends_with("\n2 errors"), "{error}");
    assert!(
        error.contains("one.obj") && error.contains("two.ply"),
        "{error}"
    );
    assert!(error.contains("scene.xml:2:"), "{error}");
}

#[test]
fn lenient_loading_goes_on_without_what_is_missing() {
    let mut stage = Stage::new().lenient();
    stage.options.load_mesh = crate::scene::import::mesh::load;
    let d = stage.modern(
        "<shape type='obj'><string name='filename' value='no.obj'/><emitter type='area'/></shape>
         <shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='no.png'/></texture></bsdf></shape>
         <shape type='sphere'><emitter type='area'/></shape>",
    );
    assert_eq!(d.shapes.len(), 2);
    assert_eq!(d.warnings.len(), 2, "{:?}", d.warnings);
    // The lamp that is left is the second shape, and both sides say so.
    assert_eq!(d.emitters.len(), 1);
    assert_eq!(d.shapes[1].emitter, Some(0));
    assert!(matches!(
        d.emitters[0],
        crate::light::Emitter::Area { shape: 1, .. }
    ));
}

/// A scene with spans cut out, doubled or replaced by noise is an error or a scene, never a panic.
#[test]
fn damaged_scenes_do_not_panic() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/materials/materials.xml"
    );
    let whole = std::fs::read_to_string(path).unwrap();
    let mut rng = crate::math::Pcg32::new(7, 1);
    let mut below = |n: usize| ((rng.next_f32() * n as f32) as usize).min(n - 1);
    let noise = [
        "-1", "1e39", "0", "\"", "<", "$", "nan", "ü", "<!--", "/>", "true",
    ];
    let stage = Stage::new().lenient();
    let mut loaded = 0;
    for _ in 0..400 {
        let mut text = whole.clone();
        for _ in 0..=below(3) {
            let start = below(text.len());
            let end = (start + below(30)).min(text.len());
            if !text.is_char_boundary(start) || !text.is_char_boundary(end) {
                continue;
            }
            let span = text[start..end].to_owned();
            let with = match below(3) {
                0 => String::new(),
                1 => span.repeat(2),
                _ => noise[below(noise.len())].to_owned(),
            };
            text.replace_range(start..end, &with);
        }
        loaded += usize::from(stage.load(&text).is_ok());
    }
    assert!(loaded > 0 && loaded < 400, "{loaded} of 400 loaded");
}
