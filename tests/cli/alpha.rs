//! Images with an alpha channel.

use super::support::{Place, SCENE, read_channels};
use std::collections::HashMap;

/// The channels of an image, by name.
fn channels(place: &Place, name: &str) -> HashMap<String, Vec<f32>> {
    let list = read_channels(&place.path(name)).into_iter();
    list.map(|(name, bits)| (name, bits.into_iter().map(f32::from_bits).collect()))
        .collect()
}

/// Only the sphere, which shines with 1 and reflects nothing, under a sky.
fn lamp() -> String {
    let begin = SCENE.find("<shape type=\"rectangle\"").unwrap();
    let end = SCENE.find("<shape type=\"sphere\"").unwrap();
    let scene = format!("{}{}", &SCENE[..begin], &SCENE[end..]);
    scene.replace("6, 5, 4", "1, 1, 1")
}

/// What is seen is 1, and all else is not there: then colour and alpha are the same number, with
/// any filter.
#[test]
fn alpha_is_filtered_as_colours_are() {
    let place = Place::with(&lamp());
    for filter in ["box", "gaussian", "lanczos"] {
        let words = format!("--rfilter {filter} --spp 16 --format float");
        place
            .run(&format!("render scene.xml --alpha -o a.exr {words}"))
            .ok();
        let image = channels(&place, "a.exr");
        assert_eq!(image["A"], image["R"], "{filter}");
        let partly = image["A"]
            .iter()
            .filter(|a| **a > 0.01 && **a < 0.99)
            .count();
        assert!(partly > 8, "{partly} pixels are partly covered");
    }
    // The sky is there for all but the camera.
    place
        .run("render scene.xml --alpha -o a.exr --aov depth")
        .ok();
    let (image, lit) = (channels(&place, "a.exr"), channels(&place, "a.exr"));
    for (i, depth) in image["depth.Z"].iter().enumerate() {
        assert_eq!(*depth > 0.0, lit["A"][i] > 0.0);
    }
}

/// A pane in front of the camera, of a material, with the wall and the lamp of the scene.
fn pane(material: &str) -> String {
    let pane = format!(
        "<shape type=\"rectangle\">{material}<transform name=\"to_world\"><scale value=\"9\"/><translate z=\"2\"/></transform></shape>\n  <emitter type=\"constant\">"
    );
    SCENE.replace("<emitter type=\"constant\">", &pane)
}

#[test]
fn the_background_is_seen_through_glass_and_lets_nothing_through_but_a_mask_does() {
    let glass = "<bsdf type=\"thindielectric\"/>";
    let mask = "<bsdf type=\"mask\"><float name=\"opacity\" value=\"0.25\"/><bsdf type=\"diffuse\"/></bsdf>";
    // In a corner nothing is behind the pane.
    let corner = |place: &Place| {
        place
            .run("render scene.xml --alpha -o a.exr --spp 1024 --format float")
            .ok();
        let image = channels(place, "a.exr");
        ["R", "A"].map(|name| image[name][0])
    };
    let [sky, alpha] = corner(&Place::with(&pane(glass)));
    assert_eq!(alpha, 1.0);
    // The sky behind and the sky in front, whatever the pane mirrors.
    assert!((sky - 0.4).abs() < 1e-3, "{sky}");
    let [_, alpha] = corner(&Place::with(&pane(mask)));
    // 1024 samples of a chance of a quarter: a standard error of 0.014.
    assert!((alpha - 0.25).abs() < 0.05, "{alpha}");
    let [sky, alpha] = corner(&Place::new());
    assert_eq!([sky, alpha], [0.0, 0.0]);
}

#[test]
fn a_scene_has_alpha_where_it_hides_emitters() {
    let film = "<film type=\"hdrfilm\">";
    let rgba = format!("{film}<string name=\"pixel_format\" value=\"rgba\"/>");
    let place = Place::replacing(film, &rgba);
    let ran = place.run("render scene.xml -o a.exr").ok();
    ran.says(&["pixel_format", "hide_emitters", "--alpha"]);
    assert!(!channels(&place, "a.exr").contains_key("A"));
    place.run("render scene.xml -o b.exr --hide-emitters").ok();
    let image = channels(&place, "b.exr");
    assert!(image["A"].contains(&0.0) && image["A"].contains(&1.0));
    for shard in [0, 1] {
        let words = format!("--hide-emitters --shard {shard}/2 -o {shard}.exr");
        place.run(&format!("render scene.xml {words}")).ok();
    }
    place.run("merge 0.exr 1.exr -o c.exr").ok();
    assert!(channels(&place, "c.exr") == image);
}

#[test]
fn a_png_has_the_colour_of_what_covers_a_pixel() {
    let place = Place::with(&lamp());
    let words = "--alpha --rfilter gaussian --spp 16 --format float --exposure -1";
    place
        .run(&format!("render scene.xml {words} -o a.exr -o a.png"))
        .ok();
    let image = channels(&place, "a.exr");
    let file = std::io::BufReader::new(std::fs::File::open(place.path("a.png")).unwrap());
    let mut png = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; png.output_buffer_size().unwrap()];
    let info = png.next_frame(&mut pixels).unwrap();
    assert_eq!(info.color_type, png::ColorType::Rgba);
    for (pixel, alpha) in pixels.chunks_exact(4).zip(&image["A"]) {
        assert!((f32::from(pixel[3]) / 255.0 - alpha).abs() < 0.51 / 255.0);
        // Half of 1 by the sRGB curve, however little of it covers the pixel.
        let shown = if *alpha > 0.0 { 188 } else { 0 };
        assert_eq!(pixel[..3], [shown; 3], "alpha {alpha}");
    }
}
