//! Layers of an EXR that pixels carry only where they are asked for.

use super::support::{Place, SCENE, read_channels};
use std::collections::HashMap;

/// The channels of an image, by name.
fn channels(place: &Place, name: &str) -> HashMap<String, Vec<f32>> {
    let list = read_channels(&place.path(name)).into_iter();
    list.map(|(name, bits)| (name, bits.into_iter().map(f32::from_bits).collect()))
        .collect()
}

/// The numbers that pixel `i` has in these channels.
fn at<const N: usize>(image: &HashMap<String, Vec<f32>>, names: [&str; N], i: usize) -> [f32; N] {
    names.map(|name| image[name][i])
}

const POSITION: [&str; 3] = ["position.X", "position.Y", "position.Z"];

#[test]
fn the_first_surface_tells_where_it_is() {
    // Once where it is, and once so far away that the importer moves the scene to the origin.
    for (from, scene) in [(0.0, SCENE.to_owned()), (3e6, moved(3_000_000))] {
        let place = Place::with(&scene);
        place
            .run(
                "render scene.xml -o a.exr --aov position,uv,normal.geometric,depth --format float",
            )
            .ok();
        let image = channels(&place, "a.exr");
        let (mut walls, mut nothing) = (0, 0);
        for i in 0..24 * 18 {
            let [x, y, z] = at(&image, POSITION, i);
            let [u, v] = at(&image, ["uv.U", "uv.V"], i);
            let normals = [
                "normal.geometric.X",
                "normal.geometric.Y",
                "normal.geometric.Z",
            ];
            let normal = at(&image, normals, i);
            let depth = image["depth.Z"][i];
            if depth == 0.0 {
                nothing += 1;
                assert_eq!([x, y, z, u, v, normal[2]], [0.0; 6], "pixel {i}");
            }
            // The wall alone: the sphere is in front of it.
            if depth > 3.9 && z == 0.0 {
                walls += 1;
                let tolerance = 1e-5 + from * 1e-7;
                assert!(
                    (u - (x - from + 1.0) / 2.0).abs() <= tolerance,
                    "u {u} at {x}"
                );
                assert!((v - (y + 1.0) / 2.0).abs() < 1e-5, "v {v} at {y}");
                // Beside the edge some samples see the sky, which has no normal.
                assert!(
                    normal[0] == 0.0 && (0.2..=1.0).contains(&normal[2]),
                    "{normal:?}"
                );
            }
        }
        assert!(walls > 100 && nothing > 100, "{walls} and {nothing}");
    }
}

/// The scene, so far along x.
fn moved(by: u32) -> String {
    let wall = "<shape type=\"rectangle\" id=\"wall\">";
    let place = format!("<transform name=\"to_world\"><translate x=\"{by}\"/></transform>");
    SCENE
        .replace(
            "origin=\"0, 0, 4\" target=\"0, 0, 0\"",
            &format!("origin=\"{by}, 0, 4\" target=\"{by}, 0, 0\""),
        )
        .replace(wall, &format!("{wall}{place}"))
        .replace("center\" x=\"0.5\"", &format!("center\" x=\"{by}.5\""))
}

#[test]
fn layers_change_no_bit_of_the_picture() {
    for guide in ["none", "double --paths 3000 --photons 3000 --batches 2"] {
        let place = Place::new();
        let words = format!("render scene.xml --format float --guide {guide}");
        place
            .run(&format!("{words} -o a.exr --aov depth,variance"))
            .ok();
        place.run(&format!("{words} -o b.exr --aov all")).ok();
        let more = channels(&place, "b.exr");
        for (name, numbers) in channels(&place, "a.exr") {
            assert_eq!(numbers, more[&name], "{name}");
        }
    }
}

#[test]
fn parts_have_the_layers_that_their_shards_were_asked_for() {
    let place = Place::new();
    place
        .run("render scene.xml --shard 0/1 -o a.exr --aov uv")
        .ok();
    place.run("merge a.exr -o b.exr --aov uv,position").fails(
        2,
        &[
            "--aov position",
            "the parts do not have it",
            "render the shards with",
        ],
    );
    place.run("merge a.exr -o b.exr --aov all").ok();
    let image = channels(&place, "b.exr");
    assert!(image.contains_key("uv.V") && !image.contains_key("position.X"));
    place
        .run("render scene.xml --shard 0/2 -o c.exr --aov uv")
        .ok();
    place.run("render scene.xml --shard 1/2 -o d.exr").ok();
    place
        .run("merge c.exr d.exr -o b.exr")
        .fails(2, &["--aov is uv in c.exr and not set in d.exr"]);
}

/// What the file says under names that begin so, without that.
fn attributes(place: &Place, name: &str, prefix: &str) -> HashMap<String, String> {
    let image = exr::prelude::read_all_flat_layers_from_file(place.path(name)).unwrap();
    let layer = &image.layer_data[0].attributes.other;
    let list = layer.iter().chain(&image.attributes.other);
    let of = |(name, value): (&exr::meta::attribute::Text, &exr::prelude::AttributeValue)| {
        let name = name.to_string().strip_prefix(prefix)?.to_owned();
        match value {
            exr::prelude::AttributeValue::Text(text) => Some((name, text.to_string())),
            _ => None,
        }
    };
    list.filter_map(of).collect()
}

/// The scene with a second wall of the same material, which has no id, as the sphere has none.
fn two_walls() -> String {
    let material =
        r#"<bsdf type="diffuse" id="chalk"><rgb name="reflectance" value="0.7"/></bsdf>"#;
    let wall = r#"<shape type="rectangle"><ref id="chalk"/>
      <transform name="to_world"><scale value="0.4"/><translate x="-0.6" y="-0.5" z="0.2"/></transform></shape>"#;
    let old = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5, 0.4, 0.3"/></bsdf>"#;
    assert!(SCENE.contains(old));
    let scene = SCENE.replace(old, r#"<ref id="chalk"/>"#);
    scene
        .replace(
            "<shape type=\"rectangle\" id",
            &format!("{material}{wall}<shape type=\"rectangle\" id"),
        )
        .replace("rfilter type=\"box\"", "rfilter type=\"gaussian\"")
}

#[test]
fn mattes_tell_what_covers_a_pixel_by_the_names_of_the_scene() {
    let place = Place::with(&two_walls());
    place
        .run("render scene.xml -o a.exr --spp 64 --aov cryptomatte,depth,samples")
        .ok();
    let image = channels(&place, "a.exr");
    // Sums over pixels by kind and number.
    let mut sums: HashMap<(&str, u32), f64> = HashMap::new();
    let mut shared = 0;
    for (i, depth) in image["depth.Z"].iter().enumerate() {
        let met = *depth > 0.0;
        for kind in ["CryptoObject", "CryptoMaterial"] {
            let mut shares = Vec::new();
            for layer in 0..3 {
                for [number, share] in [["r", "g"], ["b", "a"]] {
                    let name = |channel: &str| format!("{kind}{layer:02}.{channel}");
                    let share = image[&name(share)][i];
                    shares.push(share);
                    let number = image[&name(number)][i].to_bits();
                    assert_eq!(number == 0, share == 0.0);
                    *sums.entry((kind, number)).or_default() += f64::from(share);
                }
            }
            assert!(shares.is_sorted_by(|a, b| a >= b), "{shares:?}");
            let covered: f32 = shares.iter().sum();
            assert!(covered < 1.0 + 1e-5 && (covered > 0.0) == met, "{covered}");
            shared += usize::from(kind == "CryptoObject" && shares[1] > 0.0);
        }
    }
    assert!(shared > 20, "{shared} pixels have two objects");
    let of = |key: &str, what: &str| {
        attributes(&place, "a.exr", "cryptomatte/")[&format!("{key}/{what}")].clone()
    };
    for (key, kind, names) in [
        (
            "3ae39a5",
            "CryptoObject",
            &["rectangle", "sphere", "wall"][..],
        ),
        ("be359d6", "CryptoMaterial", &["chalk", "default.black"]),
    ] {
        assert_eq!(of(key, "name"), kind);
        assert_eq!(of(key, "hash"), "MurmurHash3_32");
        assert_eq!(of(key, "conversion"), "uint32_to_float32");
        let manifest: serde_json::Value = serde_json::from_str(&of(key, "manifest")).unwrap();
        let manifest = manifest.as_object().unwrap();
        assert_eq!(manifest.keys().collect::<Vec<_>>(), names);
        for (name, number) in manifest {
            let number = u32::from_str_radix(number.as_str().unwrap(), 16).unwrap();
            let covered = sums[&(kind, number)];
            assert!(covered > 3.0, "{name} covers {covered} pixels");
        }
    }
    // Both walls are of chalk, and the sphere is what is left: sums of both kinds are the same.
    let total = |kind: &str| -> f64 { sums.iter().filter(|s| s.0.0 == kind).map(|s| s.1).sum() };
    assert!((total("CryptoObject") - total("CryptoMaterial")).abs() < 1e-3);
}

#[test]
fn numbers_that_stand_for_names_are_not_packed_with_loss() {
    let place = Place::new();
    place
        .run("render scene.xml -o a.exr --aov cryptomatte --compression dwaa")
        .fails(
            2,
            &["--compression dwaa", "cryptomatte", "--compression zip"],
        );
}
