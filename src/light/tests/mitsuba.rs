//! Environment maps, spots and projectors against Mitsuba 3's.

use super::scenes::*;
use super::*;
use crate::image::decoded::DecodeLimit;
use crate::texture::{Checkerboard, UvTransform};
use std::path::Path;

/// The numbers of every line that starts with `name`.
fn lines(name: &str) -> Vec<Vec<f32>> {
    let lines: Vec<Vec<f32>> = include_str!("../../../tests/vectors/emitters.txt")
        .lines()
        .filter_map(|line| line.strip_prefix(name)?.strip_prefix(' '))
        .map(|rest| rest.split(' ').map(|w| w.parse().unwrap()).collect())
        .collect();
    assert!(!lines.is_empty());
    lines
}

fn vec3(v: &[f32]) -> Vec3 {
    Vec3::from_slice(v)
}

fn read(path: &Path) -> EnvironmentImage {
    EnvironmentImage::read(path, None, DecodeLimit::default()).unwrap()
}

fn environment() -> Lights {
    let turn = &lines("turn")[0];
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/vectors/environment.exr");
    let map = Emitter::EnvironmentMap {
        image: Arc::new(read(path.as_ref())),
        scale: 2.0,
        to_world: Affine3A::from_mat3(Mat3::from_cols_slice(turn)),
    };
    setup(vec![], vec![map]).lights
}

#[test]
fn environment_maps() {
    let lights = environment();
    for v in lines("map") {
        let (dir, expected) = (vec3(&v), vec3(&v[3..]));
        let radiance = lights.environment(dir);
        // Beside the sun a rounded direction is worth a few parts in 1e5 of it.
        assert!(
            (radiance - expected).length() < 1e-3 * expected.length() + 0.02,
            "{dir}: {radiance} instead of {expected}"
        );
        let pdf = lights.environment_pdf(Vec3::ZERO, Vec3::ZERO, dir).1;
        // Ours has a little more weight in the rows at the poles and a trace of the largest
        // channel.
        let polar = dir.dot(environment_pole()).abs() > 0.9;
        let allowed = if polar { 0.5 } else { 2e-3 };
        assert!(
            (pdf - v[6]).abs() <= allowed * v[6] + 1e-6,
            "{dir}: density {pdf} instead of {}",
            v[6]
        );
    }
}

/// World direction of the map's zenith.
fn environment_pole() -> Vec3 {
    Mat3::from_cols_slice(&lines("turn")[0]).y_axis
}

/// Each sample's density and radiance, looked up again, are the sample's; and their ratio
/// integrates to the map's power.
#[test]
fn environment_samples() {
    let lights = environment();
    let mut rng = Pcg32::new(5, 6);
    let (mut sum, draws) = (0.0, 100_000);
    for _ in 0..draws {
        let u = [(); 3].map(|()| rng.next_f32());
        let s = lights.sample(Vec3::ZERO, Vec3::ZERO, &mut (), u).unwrap();
        let pdf = lights.environment_pdf(Vec3::ZERO, Vec3::ZERO, s.dir).1;
        assert!((pdf / s.pdf - 1.0).abs() < 2e-3, "{s:?} {pdf}");
        let radiance = lights.environment(s.dir);
        assert!((radiance - lights.radiance(&s.incoming)).length() < 2e-3 * radiance.length());
        sum += f64::from(lights.radiance(&s.incoming).y / s.pdf);
    }
    let Distant::Map(map) = &lights.distant[0].1 else {
        panic!("not a map");
    };
    let integral = f64::from(map.integral().y);
    assert!(
        (sum / f64::from(draws) / integral - 1.0).abs() < 3e-3,
        "{sum} {integral}"
    );
}

/// Irradiance at each point of the file against the light's own.
fn compare(name: &str, emitter: Emitter) {
    let lights = setup(vec![], vec![emitter]).lights;
    let mut lit = 0;
    for v in lines(name) {
        let (p, expected) = (vec3(&v), vec3(&v[3..]));
        let got = lights
            .sample(p, Vec3::ZERO, &mut (), [0.5; 3])
            .map_or(Rgb::ZERO, |s| lights.radiance(&s.incoming) / s.pdf);
        lit += usize::from(got != Rgb::ZERO);
        assert!(
            (got - expected).length() < 1e-3 * expected.length() + 1e-5,
            "{name} at {p}: {got} instead of {expected}"
        );
    }
    assert!(lit > 10);
}

#[test]
fn spots_and_projectors() {
    let m = &lines("place")[0];
    let to_world = Affine3A::from_cols_slice(m);
    compare(
        "spot",
        Emitter::Spot {
            to_world,
            intensity: Rgb::new(3.0, 2.0, 1.0),
            cutoff_degrees: 30.0,
            beam_degrees: 18.0,
            falloff: Falloff::Linear,
            texture: None,
        },
    );
    let grey = |v: f32| Texture::Constant(Rgb::splat(v));
    let check = Checkerboard {
        color0: grey(0.1),
        color1: grey(0.9),
        to_uv: UvTransform(glam::Affine2::IDENTITY),
        swaps_numbers: false,
    };
    compare(
        "check",
        Emitter::Spot {
            to_world,
            intensity: Rgb::splat(3.0),
            cutoff_degrees: 30.0,
            beam_degrees: 22.5,
            falloff: Falloff::Linear,
            texture: Some(Texture::Checkerboard(Arc::new(check))),
        },
    );
    compare(
        "slide",
        Emitter::Projector {
            to_world,
            slide: grey(0.7),
            values: Slide::Irradiance,
            scale: 2.0,
            fov_degrees: 40.0,
            aspect: 8.0 / 6.0,
        },
    );
}

/// Texels that are no light are told of and dark; what is infinite is the brightest number of the
/// file.
#[test]
fn texels_that_are_no_light() {
    let file = tempfile::Builder::new().suffix(".exr").tempfile().unwrap();
    let bad = [f32::NAN, -3.0, f32::INFINITY];
    let texel = |x: usize, y: usize| {
        let v = if y == 2 && x < 3 { bad[x] } else { 0.5 };
        (v, 0.5f32, 0.25f32)
    };
    exr::prelude::write_rgb_file(file.path(), 8, 6, texel).unwrap();
    let image = read(file.path());
    let all = image.oddities().join("\n");
    assert!(all.contains("2 values are negative"), "{all}");
    assert!(
        all.contains("1 texels are infinite") && all.contains("count as 0.5"),
        "{all}"
    );
    let map = Emitter::EnvironmentMap {
        image: Arc::new(image),
        scale: 1.0,
        to_world: Affine3A::IDENTITY,
    };
    let lights = setup(vec![], vec![map]).lights;
    let mut rng = Pcg32::new(2, 2);
    for _ in 0..20_000 {
        let u = [(); 3].map(|()| rng.next_f32());
        let s = lights.sample(Vec3::ZERO, Vec3::ZERO, &mut (), u).unwrap();
        assert!(s.pdf > 0.0 && s.pdf.is_finite());
        let radiance = lights.radiance(&s.incoming);
        assert!(radiance.cmpge(Rgb::ZERO).all() && radiance.max_element() <= 0.5);
    }
    let missing = EnvironmentImage::read("no such map.exr".as_ref(), None, DecodeLimit::default());
    assert!(missing.unwrap_err().to_string().contains("no such map.exr"));
}

/// A sun beyond the range of half floats is as bright as they can say, and not dark.
#[test]
fn a_clipped_sun_shines() {
    let file = tempfile::Builder::new().suffix(".exr").tempfile().unwrap();
    let half = half::f16::from_f32;
    let texel = |x: usize, y: usize| {
        let sun = if (x, y) == (5, 2) {
            f32::INFINITY
        } else {
            0.25
        };
        (half(sun), half(sun), half(0.25))
    };
    exr::prelude::write_rgb_file(file.path(), 16, 8, texel).unwrap();
    let image = read(file.path());
    let all = image.oddities().join("\n");
    assert!(
        all.contains("1 texels are infinite") && all.contains("65504"),
        "{all}"
    );
    let map = image.into_map(Rgb::ONE, &Affine3A::IDENTITY).unwrap();
    let brightest = map.integral();
    assert!(brightest.x > 1000.0 && brightest.z < 10.0, "{brightest}");
}

/// A file that holds a part of its picture lights that part: the rest is black, and nothing is
/// moved.
#[test]
fn a_data_window_has_its_place_in_the_picture() {
    use exr::prelude::*;
    let file = tempfile::Builder::new().suffix(".exr").tempfile().unwrap();
    // Rows 1 and 2 and columns 3 to 6 of a picture of 8 by 6, and one column beyond the edge in
    // another.
    for (start, size, seen) in [((3, 1), (4, 2), 8), ((-1, 0), (4, 6), 18)] {
        let channels = SpecificChannels::rgb(|_: Vec2<usize>| (1.0f32, 1.0f32, 1.0f32));
        let attributes = LayerAttributes {
            layer_position: Vec2(start.0, start.1),
            ..LayerAttributes::default()
        };
        let layer = Layer::new(size, attributes, Encoding::FAST_LOSSLESS, channels);
        let window = IntegerBounds::from_dimensions((8, 6));
        Image::empty(ImageAttributes::new(window))
            .with_layer(layer)
            .write()
            .to_file(file.path())
            .unwrap();
        let image = self::read(file.path());
        let all = image.oddities().join("\n");
        assert!(all.contains("of a picture of 8 x 6"), "{all}");
        assert_eq!(image.lit(), seen, "{start:?}");
    }
}

/// The ends of the random numbers' range give light like any other.
#[test]
fn ends_of_the_random_numbers() {
    let lights = environment();
    let ends = [0.0, 0.5, 1.0 - f32::EPSILON * 0.5];
    for a in ends {
        for b in ends {
            for c in ends {
                let s = lights.sample(Vec3::ZERO, Vec3::ZERO, &mut (), [a, b, c]);
                // At the poles the density is a ratio of zeros: such a sample may be refused.
                let Some(s) = s else { continue };
                assert!(s.dir.is_finite() && (s.dir.length() - 1.0).abs() < 1e-5);
                assert!(
                    s.pdf > 0.0 && s.pdf.is_finite() && lights.radiance(&s.incoming).is_finite()
                );
            }
        }
    }
}
