//! Coats and sheens around materials.

use super::looks::{core, made_of, value, with_material};
use super::*;
use crate::image::{Image, WriteOptions};

#[test]
fn a_coat_has_normals_of_its_own() {
    let map = |material: Value| {
        let mut file = with_material(material);
        let dir = tempfile::tempdir().unwrap();
        let image = dir.path().join("flat.exr");
        let flat = Image::from_rgb(1, 1, &[Rgb::new(0.5, 0.5, 1.0)]);
        crate::image::write(&image, &flat, &WriteOptions::default()).unwrap();
        file.json["images"] = json!([{"uri": image.to_str().unwrap()}]);
        file.json["textures"] = json!([{"source": 0}, {"source": 0}]);
        let parts = file.load();
        // From the outside in.
        let (mut names, mut id) = (Vec::new(), parts.shapes[0].material);
        loop {
            let material = parts.materials.get(id);
            names.push(material.name());
            id = match material {
                Material::TwoSided { front, .. } => *front,
                Material::NormalMap { inner, .. } | Material::ClearCoat { inner, .. } => *inner,
                _ => return (names[1..].join(" "), parts.warnings.join(" ")),
            };
        }
    };
    let coat = |normals: Value| {
        let mut coat = json!({"clearcoatFactor": 1});
        if !normals.is_null() {
            coat["clearcoatNormalTexture"] = normals;
        }
        let extensions = json!({"KHR_materials_clearcoat": coat});
        map(json!({"normalTexture": {"index": 0}, "extensions": extensions}))
    };
    let (names, told) = coat(Value::Null);
    assert_eq!(names, "clearcoat normalmap metallic-roughness");
    assert_eq!(told, "");
    let (names, _) = coat(json!({"index": 0}));
    assert_eq!(names, "normalmap clearcoat metallic-roughness");
    let (names, told) = coat(json!({"index": 1}));
    assert_eq!(names, "normalmap clearcoat normalmap metallic-roughness");
    assert!(told.contains("clearcoatNormalTexture"), "{told}");
}

#[test]
fn a_coat_lies_around_the_rest() {
    let parts = made_of(json!({"extensions": {"KHR_materials_clearcoat": {
        "clearcoatFactor": 0.5, "clearcoatRoughnessFactor": 0.25,
    }}}));
    let Material::ClearCoat {
        weight,
        roughness,
        inner,
    } = core(&parts, parts.shapes[0].material)
    else {
        panic!("{parts:?}")
    };
    assert_eq!((value(weight), value(roughness)), (0.5, 0.25));
    let inner = parts.materials.get(*inner);
    assert!(matches!(inner, Material::MetallicRoughness(_)), "{inner:?}");
}

#[test]
fn a_sheen_lies_between_the_coat_and_the_rest() {
    let parts = made_of(json!({"extensions": {
        "KHR_materials_clearcoat": {"clearcoatFactor": 0.5},
        "KHR_materials_specular": {"specularFactor": 0.25},
        "KHR_materials_sheen": {"sheenColorFactor": [0.5, 0.25, 1], "sheenRoughnessFactor": 0.75},
    }}));
    assert!(parts.warnings.is_empty(), "{:?}", &*parts.warnings);
    let Material::ClearCoat { inner, .. } = core(&parts, parts.shapes[0].material) else {
        panic!("{parts:?}")
    };
    let Material::Sheen {
        color,
        roughness,
        inner,
    } = parts.materials.get(*inner)
    else {
        panic!("{parts:?}")
    };
    assert_eq!(color.constant(), Some(Rgb::new(0.5, 0.25, 1.0)));
    assert_eq!(value(roughness), 0.75);
    let Material::MetallicRoughness(base) = parts.materials.get(*inner) else {
        panic!("{parts:?}")
    };
    assert_eq!(value(&base.specular), 0.25);
}
