//! Scenes written twice, and how they are compared.
//!
//! Both are rendered with the same random numbers, so that pictures of equal scenes differ by
//! rounding alone: means of quarters are held to half a percent, where a wrong factor of 1 % in a
//! light or a colour is found.

use super::stage::{Stage, picture};
use twintree::film::Film;

const SIZE: u32 = 24;

/// Everything around what is compared, in Mitsuba's language. A floor, and what the scene has.
pub fn mitsuba(sensor: &str, inside: &str) -> String {
    format!(
        "<scene version='3.0.0'>
         <integrator type='path'><integer name='max_depth' value='6'/></integrator>
         {sensor}
         <shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/>
           <scale value='4'/><translate y='-1'/></transform>
           <bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='.2 .5 .3'/></bsdf></bsdf></shape>
         {inside}</scene>"
    )
}

pub fn pbrt(camera: &str, inside: &str) -> String {
    format!(
        "Film \"rgb\" \"integer xresolution\" {SIZE} \"integer yresolution\" {SIZE}
         PixelFilter \"box\" Sampler \"independent\" \"integer pixelsamples\" 16
         Integrator \"path\" \"integer maxdepth\" 5
         {camera}
         WorldBegin
         AttributeBegin Translate 0 -1 0 Rotate -90 1 0 0 Scale 4 4 4
         Material \"diffuse\" \"rgb reflectance\" [.2 .5 .3]
         Shape \"bilinearmesh\" \"point3 P\" [-1 -1 0 1 -1 0 -1 1 0 1 1 0]
         AttributeEnd
         {inside}"
    )
}

pub const SENSOR: &str = "<sensor type='perspective'><float name='fov' value='40'/>
    <transform name='to_world'><lookat origin='1 2 5' target='0 0 0' up='0 1 0'/></transform>
    <film type='hdrfilm'><integer name='width' value='24'/><integer name='height' value='24'/><rfilter type='box'/></film>
    <sampler type='independent'/></sensor>";

/// Mitsuba's x is to the left of a camera.
pub const CAMERA: &str =
    "Scale -1 1 1 LookAt 1 2 5 0 0 0 0 1 0 Camera \"perspective\" \"float fov\" 40";

pub const SKY: [&str; 2] = [
    "<emitter type='constant'><rgb name='radiance' value='.5 .6 .7'/></emitter>
     <emitter type='point'><point name='position' x='2' y='3' z='2'/><rgb name='intensity' value='20 16 12'/></emitter>",
    "LightSource \"infinite\" \"rgb L\" [.5 .6 .7]
     LightSource \"point\" \"point3 from\" [2 3 2] \"rgb I\" [10 8 6] \"float scale\" 2",
];

/// Means of the quarters of a picture.
fn quarters(film: &Film) -> Vec<[f64; 3]> {
    let half = SIZE / 2;
    let mut out = Vec::new();
    for (x0, y0) in [(0, 0), (half, 0), (0, half), (half, half)] {
        let mut sum = [0.0; 3];
        for (x, y) in (0..half).flat_map(|y| (0..half).map(move |x| (x, y))) {
            let pixel = film.pixel(x0 + x, y0 + y).mean();
            for (sum, value) in sum.iter_mut().zip(pixel) {
                *sum += value / f64::from(half * half);
            }
        }
        out.push(sum);
    }
    out
}

/// Compares the two, with warnings that hold these words.
pub fn compare(name: &str, xml: &str, text: &str, warned: &[&str]) {
    compare_within(name, xml, text, warned, (64, 5e-3));
}

pub fn compare_within(name: &str, xml: &str, text: &str, warned: &[&str], limits: (u64, f64)) {
    compare_on(&Stage::new(), name, [xml, text], warned, limits);
}

/// The same on a stage where the scenes' files are: with so many samples and within a part.
pub fn compare_on(
    stage: &Stage,
    name: &str,
    [xml, text]: [&str; 2],
    warned: &[&str],
    (spp, tolerance): (u64, f64),
) {
    stage.write("scene.xml", xml);
    stage.write("scene.pbrt", text);
    let theirs = stage.load("scene.xml");
    let ours = stage.load("scene.pbrt");
    assert_eq!(
        ours.warnings.len(),
        warned.len(),
        "{name}: {:?}",
        ours.warnings
    );
    for (warning, part) in ours.warnings.iter().zip(warned) {
        assert!(warning.contains(part), "{name}: {warning}");
    }
    let [ours, theirs] = [ours, theirs].map(|d| quarters(&picture(d, spp)));
    for (ours, theirs) in ours.iter().zip(&theirs) {
        for (a, b) in ours.iter().zip(theirs) {
            let off = (a - b).abs() / b.max(1e-3);
            assert!(off < tolerance, "{name}: {ours:?} for {theirs:?}");
        }
    }
}

/// A ball of a material in both languages.
pub fn ball(name: &str, bsdf: &str, material: &str) {
    ball_told(name, bsdf, material, &[]);
}

/// The same of one that is told to differ from pbrt's, in these words.
pub fn ball_told(name: &str, bsdf: &str, material: &str, warned: &[&str]) {
    let xml = mitsuba(
        SENSOR,
        &format!("{}<shape type='sphere'>{bsdf}</shape>", SKY[0]),
    );
    let text = pbrt(CAMERA, &format!("{} {material} Shape \"sphere\"", SKY[1]));
    compare(name, &xml, &text, warned);
}

/// A scene of a grey ball with these lights.
pub fn lit(name: &str, emitter: &str, light: &str) {
    lit_within(name, emitter, light, (64, 5e-3));
}

/// The same where the two are sampled in different ways: a noise of `tolerance` is left after so
/// many samples.
pub fn lit_within(name: &str, emitter: &str, light: &str, limits: (u64, f64)) {
    let ball = "<shape type='sphere'><bsdf type='diffuse'/></shape>";
    let xml = mitsuba(SENSOR, &format!("{emitter}{ball}"));
    let text = pbrt(CAMERA, &format!("{light} Shape \"sphere\""));
    compare_within(name, &xml, &text, &[], limits);
}
