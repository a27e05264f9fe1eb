//! Fronts and backs, and which way around textures lie.

use super::*;
use crate::image::{Image, WriteOptions};

/// A triangle with texture coordinates that run right and down, and a normal map.
fn mapped(dir: &tempfile::TempDir) -> File {
    let mut file = File::triangle();
    let uvs = file.floats(&[[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]);
    let normals = file.floats(&[[0.0, 0.0, 1.0]; 3]);
    let attributes = &mut file.primitive()["attributes"];
    attributes["TEXCOORD_0"] = uvs.into();
    attributes["NORMAL"] = normals.into();
    file.primitive()["material"] = 0.into();
    // Its channels are all that the importer itself looks at.
    let image = dir.path().join("map.exr");
    let white = Image::from_rgb(1, 1, &[Rgb::ONE]);
    crate::image::write(&image, &white, &WriteOptions::default()).unwrap();
    file.json["images"] = json!([{"uri": image.to_str().unwrap()}]);
    file.json["textures"] = json!([{"source": 0}]);
    file.json["materials"] = json!([{"normalTexture": {"index": 0}}]);
    file
}

/// Whether y of a shape's normal map is turned around.
fn turned(parts: &Parts, shape: usize) -> bool {
    let Material::TwoSided { front, .. } = parts.materials.get(parts.shapes[shape].material) else {
        panic!("{parts:?}")
    };
    match parts.materials.get(*front) {
        Material::NormalMap { normals, .. } => matches!(normals, Texture::Affine(_)),
        other => panic!("{other:?}"),
    }
}

#[test]
fn tangents_of_the_file_win_over_texture_coordinates() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = mapped(&dir);
    assert!(!turned(&file.load(), 0));
    assert!(mesh(&file.load(), 0).tangents.is_none());
    for (side, mirror) in [(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)] {
        let tangents = file.floats(&[[0.0, 2.0, 0.0, side]; 3]);
        file.primitive()["attributes"]["TANGENT"] = tangents.into();
        file.json["nodes"][0]["scale"] = json!([mirror, 1, 1]);
        let parts = file.load();
        let tangent = mesh(&parts, 0).tangents.as_ref().unwrap()[0];
        assert_eq!(tangent, Vec3::Y.extend(side * mirror));
        assert_eq!(turned(&parts, 0), side * mirror < 0.0, "{side} {mirror}");
    }
}

#[test]
fn mirrored_instances_carry_their_normal_map_mirrored() {
    let dir = tempfile::tempdir().unwrap();
    let mut file = mapped(&dir);
    let node = |x: f64| json!({"mesh": 0, "scale": [x, 1, 1]});
    file.json["nodes"] = json!([node(1.0), node(2.0), node(-1.0), node(-2.0)]);
    file.json["scenes"] = json!([{"nodes": [0, 1, 2, 3]}]);
    let parts = file.load();
    assert_eq!((parts.shapes.len(), parts.groups), (2, 2));
    for (group, map) in &parts.instances {
        let shape = parts.shapes.iter().position(|s| s.group == Some(*group));
        let mirrored = map.matrix3.determinant() < 0.0;
        assert_eq!(turned(&parts, shape.unwrap()), mirrored, "{map}");
    }
    // Without a normal map nothing tells them apart.
    file.json["materials"] = json!([{}]);
    assert_eq!(file.load().groups, 1);
}

#[test]
fn lamps_glow_on_the_sides_that_they_have_and_as_far_as_they_are_there() {
    let lamp = |double_sided: bool, mode: &str| {
        let mut file = File::triangle();
        file.json["materials"] = json!([{
            "emissiveFactor": [1, 0.5, 0.25], "doubleSided": double_sided, "alphaMode": mode,
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]},
        }]);
        file.primitive()["material"] = 0.into();
        let parts = file.load();
        let Some(Emitter::Area {
            radiance,
            both_sides,
            ..
        }) = parts.emitters.first()
        else {
            panic!("{parts:?}")
        };
        (radiance.constant().unwrap(), *both_sides)
    };
    let color = Rgb::new(1.0, 0.5, 0.25);
    assert_eq!(lamp(true, "OPAQUE"), (color, true));
    assert_eq!(lamp(false, "OPAQUE"), (color, false));
    assert_eq!(lamp(true, "BLEND"), (color * 0.5, true));
}
