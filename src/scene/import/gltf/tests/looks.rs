//! Materials: what a file asks for and what it becomes.

use super::*;
use crate::bsdf::MaterialId;
use crate::bsdf::material::{MetallicRoughness, Principled, PrincipledThin};
use crate::image::{Image, WriteOptions};
use crate::medium::{Extinction, VACUUM};
use crate::texture::{Filter, Wrap};

/// The parts of a triangle with that material; all three corners have texture coordinates.
pub(super) fn made_of(material: Value) -> Parts {
    with_material(material).load()
}

pub(super) fn with_material(material: Value) -> File {
    let mut file = File::triangle();
    let uvs = file.floats(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
    file.primitive()["attributes"]["TEXCOORD_0"] = uvs.into();
    file.json["materials"] = json!([material]);
    file.primitive()["material"] = 0.into();
    file
}

/// What lies beneath layers that hold one material.
pub(super) fn core(parts: &Parts, id: MaterialId) -> &Material {
    match parts.materials.get(id) {
        Material::TwoSided { front, .. } => core(parts, *front),
        Material::Mask { inner, .. } | Material::NormalMap { inner, .. } => core(parts, *inner),
        found => found,
    }
}

fn principled(parts: &Parts) -> &Principled {
    match core(parts, parts.shapes[0].material) {
        Material::Principled(p) => p,
        other => panic!("{other:?}"),
    }
}

fn opaque(parts: &Parts) -> &MetallicRoughness {
    match core(parts, parts.shapes[0].material) {
        Material::MetallicRoughness(m) => m,
        other => panic!("{other:?}"),
    }
}

pub(super) fn value(texture: &Texture) -> f32 {
    texture.constant().unwrap().x
}

#[test]
fn factors_become_the_models_own() {
    let parts = made_of(json!({"pbrMetallicRoughness": {
        "baseColorFactor": [0.1, 0.2, 0.3, 1], "metallicFactor": 0.25, "roughnessFactor": 0.75,
    }}));
    let p = opaque(&parts);
    assert_eq!(p.base_color.constant(), Some(Rgb::new(0.1, 0.2, 0.3)));
    assert_eq!((value(&p.metallic), value(&p.roughness)), (0.25, 0.75));
    assert!((p.eta - 1.5).abs() < 1e-5);
    // Without a material at all: white, rough metal, as the specification says.
    let mut file = File::triangle();
    file.json["materials"] = json!([]);
    let parts = file.load();
    let p = opaque(&parts);
    assert_eq!((value(&p.metallic), value(&p.roughness)), (1.0, 1.0));
}

#[test]
fn index_and_specular_strength_meet_in_the_reflectance() {
    let eta = |extensions: Value| opaque(&made_of(json!({"extensions": extensions}))).eta;
    let ior = json!({"KHR_materials_ior": {"ior": 1.8}});
    assert!((eta(ior) - 1.8).abs() < 1e-5);
    let specular = json!({"specularFactor": 0.5, "specularColorFactor": [2, 1, 0.5]});
    let parts = made_of(json!({"extensions": {"KHR_materials_specular": specular}}));
    let p = opaque(&parts);
    assert_eq!((p.eta, value(&p.specular)), (1.5, 0.5));
    let color = p.specular_color.constant();
    assert_eq!(color, Some(Rgb::new(2.0, 1.0, 0.5)));
    assert!(parts.warnings.is_empty(), "{:?}", parts.warnings);
}

#[test]
fn brushed_filmed_and_thin_surfaces_keep_their_numbers() {
    let parts = made_of(json!({"extensions": {
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.5, "anisotropyRotation": 0.25},
        "KHR_materials_iridescence": {"iridescenceFactor": 0.75, "iridescenceIor": 1.5,
            "iridescenceThicknessMaximum": 350},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.6,
            "diffuseTransmissionColorFactor": [0.1, 0.8, 0.2]},
    }}));
    let Material::MetallicRoughness(p) = parts.materials.get(parts.shapes[0].material) else {
        panic!("{parts:?}")
    };
    let brushed = p.anisotropy.as_ref().unwrap();
    // v points up here, so the image is seen from behind.
    assert_eq!((brushed.strength, brushed.rotation), (0.5, -0.25));
    assert!(brushed.mirrored);
    let film = p.film.as_ref().unwrap();
    assert_eq!((value(&film.strength), film.eta), (0.75, 1.5));
    assert_eq!(value(&film.thickness), 350.0);
    let leaf = p.transmission.as_ref().unwrap();
    assert_eq!(value(&leaf.share), 0.6);
    assert_eq!(leaf.color.constant(), Some(Rgb::new(0.1, 0.8, 0.2)));
    assert!(parts.warnings.is_empty(), "{:?}", parts.warnings);
}

#[test]
fn what_is_unlit_shows_its_colour_and_reflects_nothing() {
    let parts = made_of(json!({
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 1]},
        "extensions": {"KHR_materials_unlit": {}},
    }));
    let Material::Diffuse(d) = core(&parts, parts.shapes[0].material) else {
        panic!("{parts:?}")
    };
    assert_eq!(d.reflectance.constant(), Some(Rgb::ZERO));
    let Emitter::Area {
        radiance,
        both_sides,
        ..
    } = &parts.emitters[0]
    else {
        panic!("{:?}", parts.emitters)
    };
    assert_eq!(radiance.constant(), Some(Rgb::new(0.1, 0.2, 0.3)));
    assert!(both_sides);
    // It is no lamp: a studio lights what stands beside.
    assert_eq!(parts.faint, parts.emitters.len());
    for (strength, faint) in [(1, 1), (4, 0)] {
        let parts = made_of(json!({"emissiveFactor": [0.5, 0.5, 0.5], "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": strength},
        }}));
        assert_eq!(parts.faint, faint, "{strength}");
    }
}

#[test]
fn textures_are_read_for_what_they_mean() {
    let mut file = with_material(json!({
        "pbrMetallicRoughness": {
            "baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0},
        },
        "normalTexture": {"index": 0}, "emissiveTexture": {"index": 0},
        "emissiveFactor": [1, 1, 1],
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8}},
    }));
    // Its channels are all that the importer itself looks at.
    let dir = tempfile::tempdir().unwrap();
    let image = dir.path().join("white.exr");
    let white = Image::from_rgb(1, 1, &[Rgb::ONE]);
    crate::image::write(&image, &white, &WriteOptions::default()).unwrap();
    file.json["images"] = json!([{"uri": image.to_str().unwrap()}]);
    file.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    file.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    let asked = Arc::new(Asked::default());
    let parts = load_text(&file.text(), &DAffine3::IDENTITY, asked.clone()).unwrap();
    let asked = asked.0.lock().unwrap();
    let raw: Vec<bool> = asked.iter().map(|s| s.raw).collect();
    // Colour, roughness, metalness, then the glow and the normals.
    assert_eq!(raw, [false, true, true, false, true], "{asked:?}");
    let channels: Vec<_> = asked.iter().map(|s| s.channel.as_deref()).collect();
    assert_eq!(&channels[..3], [None, Some("g"), Some("b")]);
    assert_eq!(
        (asked[0].wrap_u, asked[0].wrap_v),
        (Wrap::Clamp, Wrap::Mirror)
    );
    assert_eq!(asked[0].filter, Filter::Nearest);
    let Emitter::Area { radiance, .. } = &parts.emitters[0] else {
        panic!("{:?}", parts.emitters)
    };
    assert_eq!(radiance.constant(), Some(Rgb::splat(4.0)));
}

#[test]
fn opacity_counts_as_the_alpha_mode_says() {
    let opacity = |mode: &str| {
        let parts = made_of(json!({
            "alphaMode": mode, "alphaCutoff": 0.3,
            "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.25]},
        }));
        match parts.materials.get(parts.shapes[0].material) {
            Material::Mask { opacity, .. } => opacity.constant().map(|c| c.x),
            _ => None,
        }
    };
    assert_eq!(opacity("OPAQUE"), None);
    assert_eq!(opacity("BLEND"), Some(0.25));
    assert_eq!(opacity("MASK"), Some(0.0));
}

#[test]
fn transmission_is_thin_unless_there_is_a_volume() {
    let glass = |volume: Option<Value>| {
        let mut extensions = json!({
            "KHR_materials_transmission": {"transmissionFactor": 1},
            "KHR_materials_ior": {"ior": 1.4},
        });
        if let Some(volume) = volume {
            extensions["KHR_materials_volume"] = volume;
        }
        made_of(json!({
            "pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": extensions,
        }))
    };
    let parts = glass(None);
    let Material::PrincipledThin(thin) = parts.materials.get(parts.shapes[0].material) else {
        panic!("{parts:?}")
    };
    let PrincipledThin { spec_trans, .. } = &**thin;
    assert_eq!(value(spec_trans), 1.0);
    let parts = glass(Some(json!({"thicknessFactor": 1})));
    let p = principled(&parts);
    assert_eq!((value(&p.spec_trans), p.eta), (1.0, 1.4));
    assert_eq!(value(&p.base_color), 1.0);
    assert!(parts.media.is_empty() && parts.shapes[0].boundary.is_none());
    // A quarter is left after a distance of 2: exp(-2 sigma).
    let volume = json!({
        "thicknessFactor": 2, "attenuationDistance": 2, "attenuationColor": [0.25, 1, 1],
    });
    let parts = glass(Some(volume));
    assert_eq!(value(&principled(&parts).base_color), 1.0);
    let boundary = parts.shapes[0].boundary.unwrap();
    assert_eq!(boundary.exterior, VACUUM);
    let inside = &parts.media.get(boundary.interior).unwrap().extinction;
    let Extinction::Homogeneous(inside) = inside else {
        panic!("{inside:?}")
    };
    assert_eq!(inside.albedo, Rgb::ZERO);
    let expected = Rgb::new(2f32.ln(), 0.0, 0.0);
    assert!((inside.extinction - expected).length() < 1e-6, "{inside:?}");
    assert!(parts.warnings.is_empty(), "{:?}", parts.warnings);
}

#[test]
fn vertex_colours_multiply_the_base() {
    let mut file = with_material(json!({"pbrMetallicRoughness": {"metallicFactor": 0}}));
    let colors = file.floats(&[[0.5f32, 0.25, 1.0, 0.5]; 3]);
    file.primitive()["attributes"]["COLOR_0"] = colors.into();
    let parts = file.load();
    let color = &opaque(&parts).base_color;
    assert!(matches!(color, Texture::MeshAttribute(_)), "{color:?}");
    let attribute = &mesh(&parts, 0).attributes.list[0];
    assert_eq!(attribute.values, [Rgb::new(0.5, 0.25, 1.0); 3]);
}

/// The dielectric and the metal of a material, and the metal's share.
fn halves(parts: &Parts) -> (&MetallicRoughness, &MetallicRoughness, Texture) {
    match core(parts, parts.shapes[0].material) {
        Material::Blend {
            weight,
            first,
            second,
        } => {
            let [first, second] = [first, second].map(|id| parts.materials.get(*id));
            match (first, second) {
                (Material::MetallicRoughness(a), Material::MetallicRoughness(b)) => {
                    (a, b, weight.clone())
                }
                other => panic!("{other:?}"),
            }
        }
        other => panic!("{other:?}"),
    }
}

#[test]
fn facets_of_a_colour_keep_it() {
    let made = |diffuse: [f32; 4], specular: [f32; 3]| {
        made_of(
            json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": diffuse, "specularFactor": specular, "glossinessFactor": 0.75,
            }}}),
        )
    };
    let gold = made([0.0, 0.0, 0.0, 1.0], [1.0, 0.77, 0.34]);
    let p = opaque(&gold);
    let color = p.base_color.constant().unwrap();
    assert!(
        (color - Rgb::new(1.0, 0.77, 0.34)).length() < 1e-6,
        "{color}"
    );
    assert_eq!((value(&p.metallic), value(&p.roughness)), (1.0, 0.25));
    // As much of a dielectric as leaves the diffuse part that the extension asks for.
    let mixed = made([0.5, 0.25, 0.125, 1.0], [0.52, 0.2, 0.04]);
    let (base, metal, share) = halves(&mixed);
    assert!((value(&share) - 0.5).abs() < 1e-6);
    assert_eq!(base.base_color.constant(), Some(Rgb::new(0.5, 0.25, 0.125)));
    let metal = metal.base_color.constant().unwrap();
    assert!(
        (metal - Rgb::new(1.0, 0.36, 0.04)).length() < 1e-5,
        "{metal}"
    );
    // Plastic needs no metal.
    let plastic = made([0.5, 0.25, 0.125, 1.0], [0.04; 3]);
    assert_eq!(value(&opaque(&plastic).metallic), 0.0);
}

#[test]
fn images_of_facets_and_their_gloss_count_texel_by_texel() {
    let dir = tempfile::tempdir().unwrap();
    let image = dir.path().join("gloss.exr");
    // Gold on the left, plastic on the right.
    let texels = [Rgb::new(1.0, 0.77, 0.34), Rgb::splat(0.04)];
    let white = Image::from_rgb(2, 1, &texels);
    crate::image::write(&image, &white, &WriteOptions::default()).unwrap();
    let material = json!({"extensions": {"KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.5, 0.5, 1],
        "specularGlossinessTexture": {"index": 0}, "glossinessFactor": 0.25,
    }}});
    let mut file = with_material(material);
    file.json["images"] = json!([{"uri": image.to_str().unwrap()}]);
    file.json["samplers"] = json!([{"magFilter": 9728}]);
    file.json["textures"] = json!([{"source": 0, "sampler": 0}]);
    let path = dir.path().join("a.gltf");
    std::fs::write(&path, file.text()).unwrap();
    let store = Arc::new(crate::texture::TextureStore::new(1 << 20));
    let gltf = GltfOptions {
        show: Default::default(),
        boundary: None,
        to_world: DAffine3::IDENTITY,
        material: None,
    };
    let mut parts = Parts::default();
    load(&path, &gltf, &ImportOptions::new(store), &mut parts).unwrap();
    assert_eq!(*parts.warnings, [""; 0]);
    let (base, metal, share) = halves(&parts);
    let at = |texture: &Texture, u: f32| {
        let uv = crate::math::Vec2::new(u, 0.5);
        texture.eval(&crate::texture::SurfacePoint::at_uv(uv))
    };
    assert!((at(&share, 0.25).x - 1.0).abs() < 2e-3 && at(&share, 0.75).x < 2e-3);
    let gold = at(&metal.base_color, 0.25);
    assert!(
        (gold - Rgb::new(1.0, 0.77, 0.34)).abs().max_element() < 2e-3,
        "{gold}"
    );
    // Without a channel for it, gloss is the factor's alone.
    assert_eq!(value(&base.roughness), 0.75);
}
