//! Names: one spelling for both dialects, known plugins, and the nearest name to a misspelt one.

use crate::bsdf::Material;
use std::sync::LazyLock;

/// Names of a parameter in one spelling: Mitsuba 0.x writes `toWorld` and `intIOR`, Mitsuba 3
/// `to_world` and `int_ior`. An underscore goes in where a capital follows a small letter or digit;
/// everything becomes lower case.
pub(super) fn normalise(name: &str) -> String {
    let mut out = String::with_capacity(name.len() + 4);
    let mut after_small = false;
    for c in name.chars() {
        if c.is_uppercase() && after_small {
            out.push('_');
        }
        after_small = c.is_lowercase() || c.is_ascii_digit();
        out.extend(c.to_lowercase());
    }
    out
}

/// Elements that make an object, with the plugins known for each. An empty list means that any is
/// taken.
#[rustfmt::skip]
pub(super) const OBJECTS: &[(&str, &[&str])] = &[
    ("scene", &[]),
    ("shape", &[
        "obj", "ply", "serialized", "rectangle", "cube", "sphere", "disk", "cylinder", "shapegroup",
        "instance", "merge",
    ]),
    // Beside those of `Material::plugins`.
    ("bsdf", &["lambertian"]),
    ("emitter", &[
        "area", "point", "spot", "directional", "constant", "envmap", "sun", "sky", "sunsky",
        "projector", "directionalarea",
    ]),
    ("texture", &[
        "bitmap", "checkerboard", "gridtexture", "scale", "mesh_attribute", "vertexcolors", "uniform",
        "rawconstant", "srgb", "d65", "blackbody", "regular", "irregular",
    ]),
    ("sensor", &["perspective", "thinlens", "orthographic", "spherical", "fisheye"]),
    ("film", &["hdrfilm", "ldrfilm", "tiledhdrfilm"]),
    ("rfilter", &["box", "tent", "gaussian", "mitchell", "catmullrom", "lanczos"]),
    ("sampler", &[
        "independent", "ldsampler", "sobol", "halton", "hammersley", "stratified", "multijitter",
        "orthogonal",
    ]),
    ("integrator", &[]),
    ("medium", &[]),
    ("phase", &[]),
    ("volume", &[]),
    ("subsurface", &[]),
    ("field", &[]),
];

/// Elements that make a parameter or steer the reader.
#[rustfmt::skip]
pub(super) const PARAMETERS: &[&str] = &[
    "boolean", "integer", "float", "string", "point", "vector", "rgb", "srgb", "spectrum", "blackbody",
    "transform", "ref", "include", "alias", "default", "path",
];

/// Plugins known for an element; `None` if the element makes no object.
pub(super) fn plugins(tag: &str) -> Option<&'static [&'static str]> {
    static BSDFS: LazyLock<Vec<&str>> =
        LazyLock::new(|| [&Material::plugins(), listed("bsdf").unwrap_or_default()].concat());
    match tag {
        "bsdf" => Some(&BSDFS),
        _ => listed(tag),
    }
}

fn listed(tag: &str) -> Option<&'static [&'static str]> {
    OBJECTS.iter().find(|(t, _)| *t == tag).map(|(_, p)| *p)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_spellings_become_one() {
        for (old, new) in [
            ("toWorld", "to_world"),
            ("intIOR", "int_ior"),
            ("extIOR", "ext_ior"),
            ("diffuseReflectance", "diffuse_reflectance"),
            ("maxDepth", "max_depth"),
            ("fovAxis", "fov_axis"),
            ("alphaU", "alpha_u"),
            ("sigmaA", "sigma_a"),
            ("kNN", "k_nn"),
            ("B", "b"),
            ("p0", "p0"),
            ("principal_point_offset_x", "principal_point_offset_x"),
        ] {
            assert_eq!(normalise(old), new);
            assert_eq!(normalise(new), new);
        }
    }
}
