//! Colours and images that mesh files bring along.

use super::*;
use crate::math::Vec2;
use crate::texture::SurfacePoint;

/// A triangle whose vertices have these properties beside their place.
fn triangle(head: &str, properties: &str, values: &str) -> String {
    format!(
        "ply\nformat ascii 1.0\n{head}element vertex 3\nproperty float x\nproperty float y\n\
         property float z\n{properties}element face 1\nproperty list uchar int vertex_indices\n\
         end_header\n0 0 0 {values}\n1 0 0 {values}\n0 1 0 {values}\n3 0 1 2\n"
    )
}

fn three(kind: &str, names: [&str; 3]) -> String {
    names.map(|n| format!("property {kind} {n}\n")).concat()
}

/// The colour of the first vertex, and what was told.
fn color(folder: &Folder, name: &str) -> (Rgb, Vec<String>) {
    let parts = folder.load(&[name], None).unwrap();
    let list = &mesh(&parts, 0).attributes.list;
    let colors = list.iter().find(|a| a.name == palette::VERTEX_COLOR);
    (colors.unwrap().values[0], parts.warnings.into_list())
}

#[test]
fn colours_are_understood_in_every_spelling_and_range() {
    let folder = Folder::new();
    let expected = Rgb::new(0.5029, 0.0, 1.0);
    let rgb = ["red", "green", "blue"];
    let old = ["diffuse_red", "diffuse_green", "diffuse_blue"];
    for (kind, names, values, told) in [
        ("uchar", rgb, "188 0 255", 0),
        ("uchar", old, "188 0 255", 0),
        ("float", rgb, "0.7373 0 1", 0),
        ("float", rgb, "188 0 255", 1),
        ("int", ["r", "g", "b"], "188 0 255", 1),
        ("float", old, "188 0 255", 1),
    ] {
        folder.write("a.ply", triangle("", &three(kind, names), values));
        let (color, warnings) = color(&folder, "a.ply");
        assert!(
            (color - expected).length() < 1e-3,
            "{kind} {names:?}: {color}"
        );
        assert_eq!(warnings.len(), told, "{warnings:?}");
    }
    folder.write(
        "a.obj",
        "v 0 0 0 188 0 255\nv 1 0 0 188 0 255\nv 0 1 0 188 0 255\nf 1 2 3\n",
    );
    let (color, warnings) = color(&folder, "a.obj");
    assert!((color - expected).length() < 1e-3, "{color}");
    assert!(warnings[0].contains("0 to 255"), "{warnings:?}");
}

#[test]
fn an_image_that_a_comment_names_lies_on_the_surface_with_v_upwards() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    let head = "comment TextureFile q.exr\n";
    let st = "property float s\nproperty float t\n";
    for (uv, expected) in [("0.25 0.75", Rgb::X), ("0.75 0.25", Rgb::ONE)] {
        folder.write("a.ply", triangle(head, st, uv));
        let parts = folder.load(&["a.ply"], None).unwrap();
        assert_eq!(*parts.warnings, [""; 0]);
        let uv: Vec2 = mesh(&parts, 0).uvs.as_ref().unwrap()[0];
        let texture = reflectance(&parts, parts.shapes[0].material);
        assert_eq!(texture.eval(&SurfacePoint::at_uv(uv)), expected);
    }
    // A paint takes its place.
    let parts = folder.load(&["a.ply"], Some("clay:0,1,0")).unwrap();
    let paint = reflectance(&parts, parts.shapes[0].material).constant();
    assert_eq!(paint, Some(Rgb::Y));
}

#[test]
fn coordinates_of_faces_corners_divide_the_vertices() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    // Two triangles that share an edge, and lie in two corners of the image.
    let text = "ply\nformat ascii 1.0\ncomment TextureFile C:\\tex\\q.exr\nelement vertex 4\n\
        property double x\nproperty double y\nproperty double z\nproperty uchar red\n\
        property uchar green\nproperty uchar blue\nproperty uchar alpha\nelement face 2\n\
        property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n\
        0 0 0 255 255 255 255\n1 0 0 255 0 0 255\n1 1 0 255 255 255 255\n0 1 0 255 255 255 255\n\
        3 0 1 2 6 0.1 0.2 0.3 0.4 0.5 0.6\n3 0 2 3 6 0.1 0.2 0.9 0.8 0.7 0.6\n";
    folder.write("a.ply", text);
    let parts = folder.load(&["a.ply"], None).unwrap();
    let told = parts.warnings.join("\n");
    assert!(
        told.contains("for the texture C:\\tex\\q.exr stands"),
        "{told}"
    );
    let mesh = mesh(&parts, 0);
    assert_eq!(mesh.triangles.triangles(), [[0, 1, 2], [0, 3, 4]]);
    let uvs = [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6], [0.9, 0.8], [0.7, 0.6]];
    assert_eq!(mesh.uvs.as_deref().unwrap()[..], uvs.map(Vec2::from));
    let positions = mesh.triangles.positions();
    assert_eq!(positions[2], positions[3]);
    let colors = &mesh.attributes.list[0].values;
    assert_eq!((colors.len(), colors[1]), (5, Rgb::X));
}

#[test]
fn images_that_cannot_be_laid_on_are_told() {
    let folder = Folder::new();
    folder.quarters("q.exr");
    let told = |text: String| {
        folder.write("a.ply", text);
        folder.load(&["a.ply"], None).unwrap().warnings.join("\n")
    };
    let head = "comment TextureFile q.exr\n";
    assert!(told(triangle(head, "", "")).contains("no texture coordinates"));
    let st = "property float u\nproperty float v\n";
    let two = format!("{head}comment TextureFile r.exr\n");
    assert!(told(triangle(&two, st, "0 0")).contains("of 2 textures the first"));
    folder.write("a.ply", triangle("comment TextureFile Q.EXR\n", st, "0 0"));
    let error = folder.load(&["a.ply"], None).unwrap_err().to_string();
    assert!(
        error.contains("there is") && error.contains("q.exr"),
        "{error}"
    );
}
