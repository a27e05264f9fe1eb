//! What cannot be rendered as pbrt does is told with its place, and what can be is.

use super::stage::Stage;
use twintree::bsdf::Material;
use twintree::math::Vec2;
use twintree::scene::{Description, Geometry, Mesh};
use twintree::texture::SurfacePoint;

/// The scene of these directives behind `WorldBegin`, beside an image of one colour, a half of each
/// texel's red and none of its blue, and a mesh file.
fn scene(text: &str) -> Description {
    let stage = Stage::new();
    let file = stage.path("orange.exr");
    exr::prelude::write_rgb_file(file, 2, 2, |_, _| (0.9f32, 0.3f32, 0.0f32)).expect("written");
    stage.write(
        "bare.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
         property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
    );
    stage.write("scene.pbrt", format!("WorldBegin\n{text}"));
    stage.load("scene.pbrt")
}

/// Holds the warnings to be these, each behind its line and column.
fn warned(text: &str, expected: &[(&str, &str)]) {
    let warnings = scene(text).warnings;
    assert_eq!(warnings.len(), expected.len(), "{warnings:?}");
    for (warning, (place, part)) in warnings.iter().zip(expected) {
        let place = format!("scene.pbrt:{place}: ");
        assert!(warning.contains(&place), "{warning} is not at {place}");
        assert!(warning.contains(part), "{warning} does not say {part}");
    }
}

fn mesh(description: &Description) -> &Mesh {
    match &description.shapes[0].geometry {
        Geometry::Mesh(mesh) => mesh,
        other => panic!("{other:?}"),
    }
}

const BOARD: &str = "Texture \"t\" \"spectrum\" \"checkerboard\"
Material \"diffuse\" \"texture reflectance\" \"t\"\n";
const SQUARE: &str = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]
\"integer indices\" [0 1 2 0 2 3] \"normal N\" [0 0 1 0 0 1 0 0 1 0 0 1]";

/// "If no texture coordinates are given, each triangle has (0, 0), (1, 0) and (1, 1)" (the book,
/// section 6.5.2). Where nothing is textured vertices stay shared.
#[test]
fn triangles_without_coordinates_have_pbrts_where_they_are_textured() {
    let d = scene(&format!("{BOARD}{SQUARE}"));
    assert!(d.warnings.is_empty(), "{:?}", d.warnings);
    let textured = mesh(&d);
    let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE];
    let uvs = textured.uvs.as_ref().expect("coordinates");
    assert_eq!(uvs.as_slice(), [corners, corners].concat());
    assert_eq!(textured.normals.as_ref().map(Vec::len), Some(6));
    let place = |i: usize| textured.triangles.positions()[i];
    assert_eq!(place(0), place(3));
    assert_eq!(place(2), place(4));
    let d = scene(SQUARE);
    assert!(mesh(&d).uvs.is_none());
    assert_eq!(mesh(&d).triangles.positions().len(), 4);
}

#[test]
fn what_is_one_value_here_and_a_texture_in_pbrt_is_told() {
    let board = "Texture \"f\" \"float\" \"checkerboard\"
Texture \"t\" \"spectrum\" \"checkerboard\"\n";
    warned(
        &format!("{BOARD}Shape \"plymesh\" \"string filename\" \"bare.ply\""),
        &[("4:1", "no texture coordinates")],
    );
    warned(
        &format!("{board}Material \"coateddiffuse\" \"texture thickness\" \"f\" Shape \"sphere\""),
        &[("4:26", "\"thickness\" is the same everywhere")],
    );
    warned(
        &format!("{board}Material \"hair\" \"texture sigma_a\" \"t\" Shape \"sphere\""),
        &[
            ("4:1", "\"hair\""),
            ("4:17", "\"sigma_a\" is the same everywhere"),
        ],
    );
    warned(
        &format!("{board}Material \"subsurface\" \"texture reflectance\" \"t\" Shape \"sphere\""),
        &[
            ("4:1", "\"subsurface\""),
            ("4:23", "\"reflectance\" is the same everywhere"),
        ],
    );
    warned(
        "LightSource \"point\" \"float scale\" -2",
        &[("2:21", "lights that take away")],
    );
}

/// pbrt's mean of the channels: 0.4, not the luminance, 0.41.
#[test]
fn a_colour_image_that_stands_for_a_number_is_the_mean_of_its_channels() {
    let d = scene(
        "Texture \"f\" \"float\" \"imagemap\" \"string filename\" \"orange.exr\" \"float scale\" .5
         MakeNamedMaterial \"a\" \"string type\" \"diffuse\"
         MakeNamedMaterial \"b\" \"string type\" \"conductor\"
         Material \"mix\" \"string materials\" [\"a\" \"b\"] \"texture amount\" \"f\"
         Shape \"sphere\"",
    );
    assert!(d.warnings.is_empty(), "{:?}", d.warnings);
    let Material::Blend { weight, .. } = d.materials.get(d.shapes[0].material) else {
        panic!("no mix");
    };
    let found = weight.eval_scalar(&SurfacePoint::at_uv(Vec2::splat(0.3)));
    assert!((found - 0.2).abs() < 1e-4, "{found}");
}
