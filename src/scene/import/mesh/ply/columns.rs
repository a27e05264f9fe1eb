//! What the properties of a PLY file mean, by their names.
//!
//! Beside positions, normals and texture coordinates, Mitsuba 3's convention for attributes: the
//! parts `NAME_0`, `NAME_1`, .. (or `_x _y _z`, `_r _g _b`) make an attribute `vertex_NAME` or
//! `face_NAME`; bare `red green blue` or `r g b` make `vertex_color` or `face_color`. Values are
//! taken as linear; unlike in Mitsuba, parts of 8 or 16 bits are divided by their largest value.

use super::header::{Element, Shape, Type};
use rustc_hash::FxHashSet;

/// Which properties of an element are which.
#[derive(Debug, Default)]
pub(super) struct Columns {
    pub position: Option<[usize; 3]>,
    pub normal: Option<[usize; 3]>,
    pub uv: Option<[usize; 2]>,
    pub attributes: Vec<Attribute>,
}

/// An attribute's name and the properties of its parts.
#[derive(Debug)]
pub(super) struct Attribute {
    pub name: String,
    /// Red, green and blue; one property thrice for a grey value.
    pub parts: [usize; 3],
    /// Factor that brings it to `[0, 1]`.
    pub scale: f32,
}

pub(super) const UV_NAMES: [[&str; 2]; 4] = [
    ["u", "v"],
    ["s", "t"],
    ["texture_u", "texture_v"],
    ["texture_s", "texture_t"],
];
const PART_NAMES: [[&str; 3]; 4] = [
    ["0", "1", "2"],
    ["x", "y", "z"],
    ["r", "g", "b"],
    ["red", "green", "blue"],
];

impl Columns {
    /// Of an element whose attributes are named `prefix` and something.
    pub fn of(element: &Element, prefix: &str) -> Self {
        let scalar = |name: &str| {
            let is =
                |p: &super::header::Property| p.name == name && matches!(p.shape, Shape::Scalar(_));
            element.properties.iter().position(is)
        };
        let three =
            |names: [&str; 3]| Some([scalar(names[0])?, scalar(names[1])?, scalar(names[2])?]);
        Self {
            position: three(["x", "y", "z"]),
            normal: three(["nx", "ny", "nz"]),
            uv: UV_NAMES
                .iter()
                .find_map(|[u, v]| Some([scalar(u)?, scalar(v)?])),
            attributes: attributes(element, prefix),
        }
    }
}

/// Type of a single value.
pub(super) fn scalar_type(element: &Element, property: usize) -> Option<Type> {
    match element.properties.get(property)?.shape {
        Shape::Scalar(t) => Some(t),
        Shape::List { .. } => None,
    }
}

fn attributes(element: &Element, prefix: &str) -> Vec<Attribute> {
    let mut found: Vec<Attribute> = Vec::new();
    let mut known = FxHashSet::default();
    for (index, property) in element.properties.iter().enumerate() {
        let Some(first) = scalar_type(element, index) else {
            continue;
        };
        let Some((base, parts)) = first_part(&property.name) else {
            continue;
        };
        // Parts follow each other; fewer than three repeat (grey) or leave out (two) the rest.
        let part = |n: usize| {
            let name = join(base, parts[n]);
            let at = index + n;
            (element.properties.get(at)?.name == name).then(|| scalar_type(element, at))??;
            Some(at)
        };
        let parts = match (part(1), part(2)) {
            (Some(g), Some(b)) => [index, g, b],
            (None, _) => [index; 3],
            (Some(_), None) => continue,
        };
        let name = attribute_name(base, prefix);
        if known.insert(name.clone()) {
            found.push(Attribute {
                name,
                parts,
                scale: 1.0 / first.full_scale(),
            });
        }
    }
    found
}

/// Splits the name of an attribute's first part into the attribute's name and the names of all
/// parts.
fn first_part(name: &str) -> Option<(&str, [&'static str; 3])> {
    let (base, last) = match name.rsplit_once('_') {
        Some((base, last)) if !base.is_empty() => (base, last),
        _ if name == "r" || name == "red" => ("", name),
        _ => return None,
    };
    let parts = PART_NAMES.into_iter().find(|parts| parts[0] == last)?;
    Some((base, parts))
}

fn join(base: &str, part: &str) -> String {
    if base.is_empty() {
        part.to_owned()
    } else {
        format!("{base}_{part}")
    }
}

fn attribute_name(base: &str, prefix: &str) -> String {
    if base.is_empty() {
        return format!("{prefix}color");
    }
    if base.starts_with(prefix) {
        return base.to_owned();
    }
    format!("{prefix}{base}")
}
