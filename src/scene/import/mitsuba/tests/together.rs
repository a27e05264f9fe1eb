//! All that is wrong with a scene is said at once, in the order of its lines; lenient loading puts
//! something plain in the place of each.

use super::Stage;
use crate::bsdf::Material;
use crate::bsdf::material::Diffuse;
use crate::light::Emitter;
use crate::math::Rgb;

/// Mistakes of every family, each on a line of its own, and words of its message.
const MISTAKES: &[(&str, &str)] = &[
    (
        "<bsdf type='difuse' id='m'/>",
        "bsdf \"difuse\" is not known",
    ),
    (
        "<shape type='sphere'><ref id='m'/><float name='radius' value='-1'/></shape>",
        "\"radius\" is -1",
    ),
    (
        "<shape type='sphere'><ref id='nobody'/></shape>",
        "nothing has the id \"nobody\"",
    ),
    (
        "<shape type='obj'><string name='filename' value='no.obj'/></shape>",
        "there is no mesh",
    ),
    (
        "<shape type='obj'><string name='filename' value='bad.obj'/></shape>",
        "bad.obj",
    ),
    (
        "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string name='filename' value='no.png'/></texture></bsdf></shape>",
        "there is no texture",
    ),
    (
        "<shape type='sphere'><transform name='to_world'><translate x='a'/></transform></shape>",
        "\"a\" is not a number",
    ),
    (
        "<shape type='sphere'><emitter type='point'/></shape>",
        "cannot stand inside a shape",
    ),
    (
        "<emitter type='envmap'><string name='filename' value='bad.exr'/></emitter>",
        "cannot read the environment map",
    ),
    (
        "<emitter type='spot'><float name='cutoff_angle' value='181'/></emitter>",
        "between 0 and 180",
    ),
    ("<shape type='instance'/>", "shapegroup"),
    ("<include filename='no.xml'/>", "to include"),
    ("<include filename='bad.xml'/>", "not well-formed"),
    ("<flaot name='x' value='1'/>", "<flaot> is not known"),
    (
        "<shape type='sphere'><bsdf type='twosided'><bsdf type='dielectric'/></bsdf></shape>",
        "light cannot pass",
    ),
    (
        "<shape type='sphere'><bsdf type='plastic'><string name='int_ior' value='wtaer'/></bsdf></shape>",
        "no material is called",
    ),
    (
        "<integrator type='path'><integer name='rr_depth' value='0'/></integrator>",
        "at least 1",
    ),
];

fn stage() -> Stage {
    let stage = Stage::new().with_files();
    stage.file("bad.obj", "v 0 0\n");
    stage.file("bad.exr", "no exr");
    stage.file("bad.xml", "<scene version='3.0.0'>");
    stage
}

fn scene() -> String {
    let lines: Vec<_> = MISTAKES.iter().map(|(line, _)| *line).collect();
    format!(
        "<scene version='3.0.0'>\n{}\n<shape type='sphere'/>\n</scene>",
        lines.join("\n")
    )
}

#[test]
fn all_mistakes_are_named_in_the_order_of_their_lines() {
    let message = stage().load(&scene()).unwrap_err().to_string();
    let mut last = 0;
    for (line, words) in MISTAKES {
        let at = message[last..].find(words);
        let at = at.unwrap_or_else(|| panic!("{line}: {words} is missing or late in\n{message}"));
        last += at;
    }
    assert!(
        message.ends_with(&format!("\n{} errors", MISTAKES.len())),
        "{message}"
    );
    // What comes of a mistake is no mistake of its own.
    assert!(!message.contains("twosided\" needs"), "{message}");
    for (number, (line, _)) in MISTAKES.iter().enumerate() {
        let place = format!("scene.xml:{}:", number + 2);
        assert!(message.contains(&place), "{line}: {place}\n{message}");
    }
}

#[test]
fn lenient_loading_says_what_takes_the_place_of_each() {
    let d = stage()
        .lenient()
        .load(&scene())
        .unwrap_or_else(|e| panic!("{e}"));
    let all = d.warnings.join("\n");
    for (line, words) in MISTAKES {
        let warning = d.warnings.iter().find(|w| w.contains(words));
        let warning = warning.unwrap_or_else(|| panic!("{line}: {words} is missing in\n{all}"));
        let instead = [
            "takes its place",
            "is left out",
            "default is used",
            "does not shine",
        ];
        assert!(instead.iter().any(|i| warning.contains(i)), "{warning}");
    }
    // Spheres alone are left, and the lights that could be read.
    assert_eq!(d.shapes.len(), 8);
    assert_eq!(d.emitters.len(), 2);
    let Emitter::Constant { radiance } = &d.emitters[0] else {
        panic!(
            "grey takes the place of an environment map: {:?}",
            d.emitters
        );
    };
    assert_eq!(*radiance, Rgb::splat(0.5));
    for shape in &d.shapes {
        let grey = matches!(d.materials.get(shape.material), Material::Diffuse(Diffuse { reflectance })
            if reflectance.constant() == Some(Rgb::splat(0.5)));
        let plastic = matches!(d.materials.get(shape.material), Material::Plastic(_));
        assert!(grey || plastic, "{shape:?}");
    }
}

/// A mistake inside a part that others are made of is told once.
#[test]
fn one_mistake_is_one_message() {
    let error = Stage::new().error(
        "<bsdf type='nonsense' id='in'/>
         <bsdf type='twosided' id='a'><ref id='in'/></bsdf>
         <bsdf type='coating' id='b'><ref id='a'/></bsdf>
         <bsdf type='mixturebsdf' id='c'><string name='weights' value='1'/><ref id='in'/></bsdf>
         <shape type='sphere'><ref id='b'/></shape><shape type='cube'><ref id='b'/></shape><shape type='cube'><ref id='c'/></shape>",
    );
    let message = error.to_string();
    assert!(message.contains("\"nonsense\" is not known"), "{message}");
    assert!(!message.contains("errors"), "{message}");
}

#[test]
fn a_thousand_mistakes_are_counted() {
    let line = "<shape type='sphere'><float name='radius' value='-1'/></shape>\n";
    let message = Stage::new().error(&line.repeat(1000)).to_string();
    assert!(message.contains("\nand 900 more\n1000 errors"), "{message}");
}
