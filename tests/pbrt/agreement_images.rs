//! Lights and media that are images or grids, written twice.
//!
//! Mitsuba has neither pbrt's goniometric light nor its smooth spots: a projector whose slide holds
//! the same intensities stands for them, above a scene that lies within it.

use super::pair::{CAMERA, SENSOR, SKY, compare_on, mitsuba, pbrt};
use super::stage::Stage;
use std::f32::consts::PI;
use twintree::math::equal_area::square_to_sphere;
use twintree::math::{Vec2, Vec3};

/// Texels along the side of a slide: interpolation between them is within 0.1 %.
const SIDE: usize = 256;

fn image(stage: &Stage, name: &str, side: usize, value: impl Fn(f32, f32) -> Vec3 + Sync) {
    let at = |i: usize| (i as f32 + 0.5) / side as f32;
    let texel = |x: usize, y: usize| {
        let value = value(at(x), at(y));
        (value.x, value.y, value.z)
    };
    exr::prelude::write_rgb_file(stage.path(name), side, side, texel).expect("written");
}

/// Mitsuba's projector at (0, 6, 0), downwards, 90 degrees wide, of this intensity towards a place
/// (u, v) of the slide: its values are irradiances over pi on the plane at distance 1.
fn projector(stage: &Stage, intensity: impl Fn(f32, f32) -> Vec3 + Sync) -> String {
    image(stage, "slide.exr", SIDE, |u, v| {
        let cos = 1.0 / (1.0 + (2.0 * u - 1.0).powi(2) + (2.0 * v - 1.0).powi(2)).sqrt();
        intensity(u, v) * (cos.powi(3) / PI)
    });
    "<emitter type='projector'><float name='fov' value='90'/>
     <transform name='to_world'><lookat origin='0 6 0' target='0 0 0' up='0 0 1'/></transform>
     <texture name='irradiance' type='bitmap'><string name='filename' value='slide.exr'/>
     <boolean name='raw' value='true'/></texture></emitter>"
        .into()
}

/// The direction in the world in which it shines towards (u, v): x goes down with u, z with v.
fn towards(u: f32, v: f32) -> Vec3 {
    Vec3::new(1.0 - 2.0 * u, -1.0, 1.0 - 2.0 * v).normalize()
}

fn lit(stage: &Stage, name: &str, emitter: &str, light: &str) {
    let ball = "<shape type='sphere'><bsdf type='diffuse'/></shape>";
    let xml = mitsuba(SENSOR, &format!("{emitter}{ball}"));
    let text = pbrt(CAMERA, &format!("{light} Shape \"sphere\""));
    compare_on(stage, name, [&xml, &text], &[], (64, 5e-3));
}

/// A slide of other colours in each corner: what is mirrored, turned or has another falloff differs.
#[test]
fn projections_agree() {
    let stage = Stage::new();
    let color = |u: f32, v: f32| Vec3::new(10.0 + 30.0 * u, 40.0 - 25.0 * v, 20.0 + 20.0 * u * v);
    image(&stage, "pbrt.exr", SIDE, color);
    let emitter = projector(&stage, |u, v| color(u, v) * 1.5);
    let light = "AttributeBegin Translate 0 6 0
        ConcatTransform [-1 0 0 0  0 0 1 0  0 -1 0 0  0 0 0 1]
        LightSource \"projection\" \"string filename\" \"pbrt.exr\" \"float fov\" 90
        \"float scale\" 1.5 AttributeEnd";
    lit(&stage, "projection", &emitter, light);
}

/// The book's smooth step in the cosine, section 12.2.1.
#[test]
fn spots_with_a_smooth_falloff_agree() {
    let stage = Stage::new();
    let [start, end] = [15f32, 40.0].map(|a| a.to_radians().cos());
    let emitter = projector(&stage, |u, v| {
        let t = ((-towards(u, v).y - end) / (start - end)).clamp(0.0, 1.0);
        Vec3::new(60.0, 40.0, 20.0) * (t * t * (3.0 - 2.0 * t))
    });
    let light = "LightSource \"spot\" \"point3 from\" [0 6 0] \"point3 to\" [0 0 0]
        \"float coneangle\" 40 \"float conedeltaangle\" 25 \"rgb I\" [60 40 20]";
    lit(&stage, "spot", &emitter, light);
}

/// An image of equal areas around the y axis of a light that is turned by 90 degrees around it: the
/// mean of its channels counts.
#[test]
fn goniometric_lights_agree() {
    let stage = Stage::new();
    // In the light's coordinates.
    let intensity = |w: Vec3| 1.0 + 0.6 * w.x - 0.3 * w.z - 0.2 * w.y;
    image(&stage, "lamp.exr", 128, |u, v| {
        let at = square_to_sphere(Vec2::new(u, v));
        let mean = intensity(Vec3::new(at.x, at.z, at.y));
        Vec3::new(1.5, 1.0, 0.5) * mean
    });
    let emitter = projector(&stage, |u, v| {
        let w = towards(u, v);
        // Turned by 90 degrees, the light's x is the world's -z, and its z the world's x.
        Vec3::new(40.0, 30.0, 20.0) * intensity(Vec3::new(-w.z, w.y, w.x))
    });
    let light = "AttributeBegin Translate 0 6 0 Rotate 90 0 1 0
        LightSource \"goniometric\" \"string filename\" \"lamp.exr\" \"rgb I\" [20 15 10]
        \"float scale\" 2 AttributeEnd";
    lit(&stage, "goniometric", &emitter, light);
    // The power is that of all directions, 4 pi times the mean of the image, which is 1.
    let light = "AttributeBegin Translate 0 6 0 Rotate 90 0 1 0
        LightSource \"goniometric\" \"string filename\" \"lamp.exr\" \"rgb I\" [1 1 1]
        \"float power\" 251.32741 AttributeEnd";
    let emitter = projector(&stage, |u, v| {
        let w = towards(u, v);
        Vec3::splat(20.0 * intensity(Vec3::new(-w.z, w.y, w.x)))
    });
    lit(&stage, "goniometric by its power", &emitter, light);
}

/// Voxels of a grid along an axis.
const VOXELS: usize = 4;
/// Those of Mitsuba's, which has empty ones around: there pbrt has nothing.
const PADDED: usize = VOXELS + 2;

/// A number for each voxel, different along each axis.
fn voxels() -> Vec<f32> {
    let value = |x: usize, y: usize, z: usize| {
        0.2 * (x + 1) as f32 + 0.35 * (VOXELS - y) as f32 + 0.1 * ((z + 1) * (z + 1)) as f32
    };
    let places = (0..VOXELS.pow(3)).map(|i| [i % VOXELS, i / VOXELS % VOXELS, i / VOXELS / VOXELS]);
    places.map(|[x, y, z]| value(x, y, z)).collect()
}

/// The same values with 0 around.
fn padded(values: &[f32]) -> Vec<f32> {
    let place = |i: usize| [i % PADDED, i / PADDED % PADDED, i / PADDED / PADDED];
    let value = |place: [usize; 3]| {
        let inside = |i: usize| i.checked_sub(1).filter(|i| *i < VOXELS);
        let [x, y, z] = place.map(inside);
        Some(values[(z? * VOXELS + y?) * VOXELS + x?])
    };
    let places = (0..PADDED.pow(3)).map(place);
    places.map(|place| value(place).unwrap_or(0.0)).collect()
}

/// Mitsuba's grid of three channels.
fn grid(stage: &Stage, name: &str, values: &[f32]) {
    let mut bytes = b"VOL\x03".to_vec();
    let n = PADDED as i32;
    bytes.extend([1, n, n, n, 3].iter().flat_map(|i: &i32| i.to_le_bytes()));
    let corners = [0f32, 0.0, 0.0, 1.0, 1.0, 1.0];
    bytes.extend(corners.iter().chain(values).flat_map(|x| x.to_le_bytes()));
    stage.write(name, bytes);
}

fn numbers(values: &[f32]) -> String {
    let words: Vec<String> = values.iter().map(f32::to_string).collect();
    words.join(" ")
}

/// The box around the fog.
const BOX: &str = "Shape \"trianglemesh\" \"point3 P\" [-1.5 -1 -1 1.5 -1 -1 -1.5 1 -1 1.5 1 -1
    -1.5 -1 1 1.5 -1 1 -1.5 1 1 1.5 1 1] \"integer indices\" [0 2 3 0 3 1 4 5 7 4 7 6
    0 1 5 0 5 4 2 6 7 2 7 3 0 4 6 0 6 2 1 3 7 1 7 5]";

fn fog(stage: &Stage, name: &str, medium: &str) {
    let volume = |of: &str, file: &str| {
        format!(
            "<volume name='{of}' type='gridvolume'><string name='filename' value='{file}'/>
             <boolean name='raw' value='true'/><transform name='to_world'>
             <translate value='-.5'/><scale x='4.5' y='3' z='3'/></transform></volume>"
        )
    };
    let (sigma_t, albedo) = (
        volume("sigma_t", "sigma_t.vol"),
        volume("albedo", "albedo.vol"),
    );
    let fog = format!(
        "<shape type='cube'><transform name='to_world'><scale x='1.5'/></transform><bsdf type='null'/>
         <medium name='interior' type='heterogeneous'>{sigma_t}{albedo}
         <phase type='hg'><float name='g' value='.4'/></phase></medium></shape>"
    );
    let text = format!(
        "MakeNamedMedium \"fog\" \"string type\" {medium} \"float g\" .4
         \"point3 p0\" [-1.5 -1 -1] \"point3 p1\" [1.5 1 1]
         \"integer nx\" {VOXELS} \"integer ny\" {VOXELS} \"integer nz\" {VOXELS}
         MediumInterface \"fog\" \"\" Material \"interface\" {BOX}"
    );
    let xml = mitsuba(SENSOR, &format!("{}{fog}", SKY[0]));
    let text = pbrt(CAMERA, &format!("{} {text}", SKY[1]));
    // Means of 64 samples differ by 2 % where the two draw other numbers.
    compare_on(stage, name, [&xml, &text], &[], (1024, 1e-2));
}

#[test]
fn grids_of_densities_agree() {
    let stage = Stage::new();
    let (density, albedo) = (voxels(), [0.9f32, 0.7, 0.5]);
    let colors = padded(&density).into_iter();
    let colors = colors.flat_map(|d| [d * 2.0, d * 1.5, d * 1.2]);
    grid(&stage, "sigma_t.vol", &colors.collect::<Vec<f32>>());
    grid(&stage, "albedo.vol", &albedo.repeat(PADDED.pow(3)));
    let medium = format!(
        "\"uniformgrid\" \"float density\" [{}] \"float scale\" 2
         \"rgb sigma_s\" [.9 .525 .3] \"rgb sigma_a\" [.1 .225 .3]",
        numbers(&density)
    );
    fog(&stage, "uniformgrid", &medium);
}

#[test]
fn grids_of_colours_agree() {
    let stage = Stage::new();
    let density = voxels();
    let of = |density: &[f32], share: [f32; 3]| -> Vec<f32> {
        density.iter().flat_map(|d| share.map(|s| d * s)).collect()
    };
    grid(
        &stage,
        "sigma_t.vol",
        &of(&padded(&density), [2.0, 1.5, 1.2]),
    );
    grid(&stage, "albedo.vol", &[0.9, 0.7, 0.5].repeat(PADDED.pow(3)));
    let scattered = of(&density, [0.9, 0.525, 0.3]);
    let absorbed = of(&density, [0.1, 0.225, 0.3]);
    let medium = format!(
        "\"rgbgrid\" \"rgb sigma_s\" [{}] \"rgb sigma_a\" [{}] \"float scale\" 2",
        numbers(&scattered),
        numbers(&absorbed)
    );
    fog(&stage, "rgbgrid", &medium);
}
