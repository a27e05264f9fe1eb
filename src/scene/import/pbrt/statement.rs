//! Statements of a scene: its directives, read one after the other.

use super::parameter::{self, Parameter};
use super::tokens::{Token, Tokens, Wrong, shown};
use crate::math::{DMat4, DVec3};
use crate::scene::import::faults::At;
use crate::scene::import::named;

/// A directive with what stands behind it.
#[derive(Debug)]
pub(super) struct Statement {
    pub at: At,
    pub what: What,
}

/// What a directive asks for.
#[derive(Debug)]
pub(super) enum What {
    /// `Identity`, `Transform`: takes the place of the current transform.
    Set(Box<DMat4>),
    /// `Translate`, `Scale`, `Rotate`, `LookAt`, `ConcatTransform`: is put behind it.
    Concat(Box<DMat4>),
    CoordinateSystem(String),
    CoordSysTransform(String),
    /// Which of the transforms at the shutter's opening and closing the next ones change.
    ActiveTransform([bool; 2]),
    TransformTimes,
    /// `AttributeBegin`, `TransformBegin`.
    Begin,
    /// `AttributeEnd`, `TransformEnd`.
    End,
    ReverseOrientation,
    WorldBegin,
    WorldEnd,
    ObjectBegin(String),
    ObjectEnd,
    ObjectInstance(String),
    NamedMaterial(String),
    MediumInterface(Box<[String; 2]>),
    ColorSpace(String),
    Option(Box<[String; 2]>),
    /// A file in the place of the directive.
    Include(String),
    /// A file that leaves nothing behind but what it defines.
    Import(String),
    Plugin(Box<Plugin>),
}

/// A directive of a kind, a name and parameters.
#[derive(Debug)]
pub(super) struct Plugin {
    pub directive: Directive,
    /// The name in quotation marks: what kind of shape, or how a named material is called.
    pub name: String,
    /// Of a texture: `float` or `spectrum` (v3: `color`), and the kind of texture.
    pub class: Option<[String; 2]>,
    pub parameters: Vec<Parameter>,
}

/// The directives that take parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Directive {
    Accelerator,
    AreaLightSource,
    Attribute,
    Camera,
    Film,
    Integrator,
    LightSource,
    MakeNamedMaterial,
    MakeNamedMedium,
    Material,
    PixelFilter,
    Sampler,
    Shape,
    Texture,
}

/// All directives by name; those without a kind have a shape of their own.
pub(super) const DIRECTIVES: &[(&str, Option<Directive>)] = &[
    ("Accelerator", Some(Directive::Accelerator)),
    ("ActiveTransform", None),
    ("AreaLightSource", Some(Directive::AreaLightSource)),
    ("Attribute", Some(Directive::Attribute)),
    ("AttributeBegin", None),
    ("AttributeEnd", None),
    ("Camera", Some(Directive::Camera)),
    ("ColorSpace", None),
    ("ConcatTransform", None),
    ("CoordSysTransform", None),
    ("CoordinateSystem", None),
    ("Film", Some(Directive::Film)),
    ("Identity", None),
    ("Import", None),
    ("Include", None),
    ("Integrator", Some(Directive::Integrator)),
    ("LightSource", Some(Directive::LightSource)),
    ("LookAt", None),
    ("MakeNamedMaterial", Some(Directive::MakeNamedMaterial)),
    ("MakeNamedMedium", Some(Directive::MakeNamedMedium)),
    ("Material", Some(Directive::Material)),
    ("MediumInterface", None),
    ("NamedMaterial", None),
    ("ObjectBegin", None),
    ("ObjectEnd", None),
    ("ObjectInstance", None),
    ("Option", None),
    ("PixelFilter", Some(Directive::PixelFilter)),
    ("ReverseOrientation", None),
    ("Rotate", None),
    ("Sampler", Some(Directive::Sampler)),
    ("Scale", None),
    ("Shape", Some(Directive::Shape)),
    ("Texture", Some(Directive::Texture)),
    ("Transform", None),
    ("TransformBegin", None),
    ("TransformEnd", None),
    ("TransformTimes", None),
    ("Translate", None),
    ("WorldBegin", None),
    ("WorldEnd", None),
];

impl Directive {
    /// As it is written.
    pub fn word(self) -> &'static str {
        let found = DIRECTIVES.iter().find(|(_, d)| *d == Some(self));
        found.map_or("", |(word, _)| word)
    }
}

/// Whether a word is a directive.
fn is_directive(word: &[u8]) -> bool {
    DIRECTIVES.iter().any(|(known, _)| known.as_bytes() == word)
}

/// The next statement; `None` at the end. Behind something wrong the next directive comes next.
pub(super) fn next(tokens: &mut Tokens) -> Result<Option<Statement>, Wrong> {
    let result = read(tokens);
    if result.is_err() {
        skip_to_directive(tokens);
    }
    result
}

fn skip_to_directive(tokens: &mut Tokens) {
    loop {
        match tokens.peek() {
            Ok(None) => return,
            Ok(Some((Token::Word(word), _))) if is_directive(word) => return,
            Ok(Some(_)) => {
                // It was looked at, so it can be taken.
                let _ = tokens.next();
            }
            // A string without an end: what is left begins behind it.
            Err(_) => {}
        }
    }
}

fn read(tokens: &mut Tokens) -> Result<Option<Statement>, Wrong> {
    let (word, at) = match tokens.next()? {
        None => return Ok(None),
        Some((Token::Word(word), at)) => (word, at),
        Some((Token::Quoted(word), at)) => {
            let message = format!(
                "a directive is expected here, not the string \"{}\"",
                shown(word)
            );
            return Err(tokens.wrong(at, message));
        }
        Some((_, at)) => {
            return Err(tokens.wrong(at, "a directive is expected here, not a bracket"));
        }
    };
    let text = std::str::from_utf8(word).unwrap_or("");
    let what = match text {
        "Identity" => What::Set(Box::new(DMat4::IDENTITY)),
        "Transform" => What::Set(Box::new(matrix(tokens)?)),
        "ConcatTransform" => What::Concat(Box::new(matrix(tokens)?)),
        "Translate" => {
            let by = DVec3::from_array(tokens.numbers()?);
            What::Concat(Box::new(DMat4::from_translation(by)))
        }
        "Scale" => {
            let by = DVec3::from_array(tokens.numbers()?);
            What::Concat(Box::new(DMat4::from_scale(by)))
        }
        "Rotate" => {
            let [angle, x, y, z] = tokens.numbers()?;
            let Some(axis) = DVec3::new(x, y, z).try_normalize() else {
                return Err(tokens.wrong(at, "the axis of \"Rotate\" is zero"));
            };
            What::Concat(Box::new(DMat4::from_axis_angle(axis, angle.to_radians())))
        }
        "LookAt" => What::Concat(Box::new(look_at(tokens, at)?)),
        "CoordinateSystem" => What::CoordinateSystem(tokens.string("a name")?.0),
        "CoordSysTransform" => What::CoordSysTransform(tokens.string("a name")?.0),
        "ActiveTransform" => What::ActiveTransform(active(tokens)?),
        "TransformTimes" => {
            tokens.numbers::<2>()?;
            What::TransformTimes
        }
        "AttributeBegin" | "TransformBegin" => What::Begin,
        "AttributeEnd" | "TransformEnd" => What::End,
        "ReverseOrientation" => What::ReverseOrientation,
        "WorldBegin" => What::WorldBegin,
        "WorldEnd" => What::WorldEnd,
        "ObjectBegin" => What::ObjectBegin(tokens.string("a name")?.0),
        "ObjectEnd" => What::ObjectEnd,
        "ObjectInstance" => What::ObjectInstance(tokens.string("the name of an object")?.0),
        "NamedMaterial" => What::NamedMaterial(tokens.string("the name of a material")?.0),
        "MediumInterface" => What::MediumInterface(Box::new(interface(tokens)?)),
        "ColorSpace" => What::ColorSpace(tokens.string("a colour space")?.0),
        "Option" => What::Option(Box::new(option(tokens)?)),
        "Include" => What::Include(tokens.string("a file's name")?.0),
        "Import" => What::Import(tokens.string("a file's name")?.0),
        _ => {
            let found = DIRECTIVES.iter().find(|(known, _)| *known == text);
            match found.and_then(|(_, directive)| *directive) {
                Some(directive) => What::Plugin(Box::new(plugin(tokens, directive)?)),
                None => return Err(unknown(tokens, word, at)),
            }
        }
    };
    Ok(Some(Statement { at, what }))
}

fn unknown(tokens: &Tokens, word: &[u8], at: At) -> Wrong {
    let shown = shown(word);
    let known = DIRECTIVES.iter().map(|(known, _)| *known);
    let help = match shown.as_str() {
        "SurfaceIntegrator" | "VolumeIntegrator" | "Renderer" | "Volume" => {
            Some("this is pbrt-v2's language: pbrt-v3 and v4 are read".to_owned())
        }
        _ => named::did_you_mean(&shown, known),
    };
    let help = help.map_or(String::new(), |h| format!("; {h}"));
    tokens.wrong(at, format!("there is no directive \"{shown}\"{help}"))
}

/// Sixteen numbers, column by column.
fn matrix(tokens: &mut Tokens) -> Result<DMat4, Wrong> {
    Ok(DMat4::from_cols_array(&tokens.numbers()?))
}

/// The map from the world to a camera at `eye` that looks at a point. Coordinates are left-handed:
/// x to the right, y up, z into the picture.
fn look_at(tokens: &mut Tokens, at: At) -> Result<DMat4, Wrong> {
    let v: [f64; 9] = tokens.numbers()?;
    let [eye, look, up] = [0, 3, 6].map(|i| DVec3::new(v[i], v[i + 1], v[i + 2]));
    let forward = (look - eye).try_normalize();
    let right = forward.and_then(|f| up.cross(f).try_normalize());
    let (Some(forward), Some(right)) = (forward, right) else {
        let message =
            "\"LookAt\" looks nowhere: the eye is the point looked at, or up lies along the view";
        return Err(tokens.wrong(at, message));
    };
    let up = forward.cross(right);
    let to_world = DMat4::from_cols(
        right.extend(0.0),
        up.extend(0.0),
        forward.extend(0.0),
        eye.extend(1.0),
    );
    Ok(to_world.inverse())
}

fn active(tokens: &mut Tokens) -> Result<[bool; 2], Wrong> {
    let next = tokens.next()?;
    match next {
        Some((Token::Word(b"StartTime"), _)) => Ok([true, false]),
        Some((Token::Word(b"EndTime"), _)) => Ok([false, true]),
        Some((Token::Word(b"All"), _)) => Ok([true, true]),
        other => {
            let at = other.map_or_else(|| tokens.place(), |(_, at)| at);
            Err(tokens.wrong(at, "StartTime, EndTime or All is expected here"))
        }
    }
}

/// The media inside and outside; one name stands for both.
fn interface(tokens: &mut Tokens) -> Result<[String; 2], Wrong> {
    let (inside, _) = tokens.string("the name of a medium")?;
    let outside = match tokens.peek()? {
        Some((Token::Quoted(_), _)) => tokens.string("the name of a medium")?.0,
        _ => inside.clone(),
    };
    Ok([inside, outside])
}

fn option(tokens: &mut Tokens) -> Result<[String; 2], Wrong> {
    let (declared, _) = tokens.string("an option")?;
    // pbrt writes "bool name" here too.
    let name = declared.split_whitespace().next_back().unwrap_or("");
    let value = match tokens.next()? {
        Some((Token::Word(word) | Token::Quoted(word), _)) => shown(word),
        other => {
            let at = other.map_or_else(|| tokens.place(), |(_, at)| at);
            return Err(tokens.wrong(at, "the option's value is expected here"));
        }
    };
    Ok([name.to_owned(), value])
}

fn plugin(tokens: &mut Tokens, directive: Directive) -> Result<Plugin, Wrong> {
    let (name, _) = tokens.string("a name")?;
    let class = match directive {
        Directive::Texture => {
            let (value, _) = tokens.string("\"float\" or \"spectrum\"")?;
            Some([value, tokens.string("a kind of texture")?.0])
        }
        _ => None,
    };
    Ok(Plugin {
        directive,
        name,
        class,
        parameters: parameter::list(tokens)?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> (Vec<Statement>, Vec<Wrong>) {
        let mut tokens = Tokens::new(text.as_bytes(), 0, 0);
        let (mut list, mut wrongs) = (Vec::new(), Vec::new());
        loop {
            match next(&mut tokens) {
                Ok(Some(statement)) => list.push(statement),
                Ok(None) => return (list, wrongs),
                Err(wrong) => wrongs.push(wrong),
            }
        }
    }

    #[test]
    fn reading_goes_on_behind_a_mistake() {
        let (list, wrongs) = all(
            "Shap \"sphere\" \"float radius\" 1\nTranslate 1 2\nIdentity\n\
             Shape \"sphere\" \"float radius\" [x]\n  WorldEnd \"open\nReverseOrientation",
        );
        let lines: Vec<u32> = wrongs.iter().map(|w| w.at.line).collect();
        assert_eq!(lines, [1, 3, 4, 5]);
        assert!(wrongs[0].message.contains("did you mean \"Shape\""));
        assert_eq!(list.len(), 3);
        assert!(matches!(list[2].what, What::ReverseOrientation));
    }

    #[test]
    fn transforms_are_those_of_the_book() {
        let of = |text: &str| match all(text).0.remove(0).what {
            What::Set(m) | What::Concat(m) => *m,
            other => panic!("{other:?}"),
        };
        let p = DVec3::new(1.0, 2.0, 3.0);
        let moved = |text: &str| of(text).transform_point3(p);
        assert_eq!(moved("Translate 1 0 -1"), DVec3::new(2.0, 2.0, 2.0));
        assert_eq!(moved("Scale 2 3 4"), DVec3::new(2.0, 6.0, 12.0));
        let turned = moved("Rotate 90 0 0 1");
        assert!((turned - DVec3::new(-2.0, 1.0, 3.0)).length() < 1e-12);
        let matrix = "Transform [1 0 0 0  0 1 0 0  0 0 1 0  5 6 7 1]";
        assert_eq!(moved(matrix), DVec3::new(6.0, 8.0, 10.0));
        // From (0, 0, -5) to the origin: left-handed, so that +x stays at the right.
        assert_eq!(
            moved("LookAt 0 0 -5  0 0 0  0 1 0"),
            DVec3::new(1.0, 2.0, 8.0)
        );
        let behind = moved("LookAt 0 0 5  0 0 0  0 1 0");
        assert!(
            (behind - DVec3::new(-1.0, 2.0, 2.0)).length() < 1e-12,
            "{behind}"
        );
    }

    #[test]
    fn every_directive_is_read() {
        let (list, wrongs) = all(
            "ActiveTransform All TransformTimes 0 1 CoordinateSystem \"a\" \
             Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \
             MediumInterface \"a\" \"\" MediumInterface \"b\" Option \"bool wavefront\" true \
             Option \"seed\" 3 Include \"a\" Import \"b\" Integrator \"path\"",
        );
        assert!(wrongs.is_empty(), "{wrongs:?}");
        assert_eq!(list.len(), 11);
        let What::MediumInterface(names) = &list[5].what else {
            panic!()
        };
        assert_eq!(**names, ["b", "b"]);
    }
}
