//! Image textures as a whole: files on disk against values computed from the same numbers in `f64`.

use super::curve::Curve;
use super::*;
use crate::image::{Image, PixelType, WriteOptions, write};
use crate::math::{Pcg32, Vec2, Vec3};
use std::path::{Path, PathBuf};

mod opening;
#[cfg(feature = "oiio")]
mod residence;

/// More than any test needs.
const PLENTY: usize = 1 << 28;

fn settings(path: &Path) -> BitmapSettings {
    BitmapSettings {
        path: path.to_owned(),
        raw: true,
        gamma: None,
        filter: Filter::Linear,
        wrap_u: Wrap::Repeat,
        wrap_v: Wrap::Repeat,
        to_uv: UvTransform(glam::Affine2::IDENTITY),
        channel: None,
    }
}

fn bitmap(texture: Texture) -> std::sync::Arc<Bitmap> {
    match texture {
        Texture::Bitmap(b) => b,
        other => panic!("{other:?}"),
    }
}

fn opened(settings: BitmapSettings) -> std::sync::Arc<Bitmap> {
    bitmap(TextureStore::new(PLENTY).open(settings).unwrap())
}

/// Noise in the named file.
fn noise(dir: &Path, name: &str, size: [u32; 2], names: &[&str], stored: PixelType) -> PathBuf {
    let mut rng = Pcg32::new(11, u64::from(size[0]));
    let mut image = Image::new(size[0], size[1], names);
    image.pixels.iter_mut().for_each(|x| *x = rng.next_f32());
    let path = dir.join(name);
    let options = WriteOptions {
        pixel_type: Some(stored),
        ..Default::default()
    };
    write(&path, &image, &options).unwrap();
    path
}

/// The texel's index along one axis, straight from the definition of the wrap modes.
fn wrapped_index(i: i64, n: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let j = i.rem_euclid(2 * n);
            if j < n { j } else { 2 * n - 1 - j }
        }
    }
}

/// Bilinear interpolation of linear texels in `f64`.
fn reference(
    texel: impl Fn(i64, i64) -> [f64; 3],
    size: [i64; 2],
    uv: Vec2,
    s: &BitmapSettings,
) -> [f64; 3] {
    let uv = s.to_uv.0.transform_point2(uv);
    let clamped = |u: f32, wrap| match wrap {
        Wrap::Clamp => f64::from(u).clamp(0.0, 1.0),
        _ => f64::from(u),
    };
    let x = clamped(uv.x, s.wrap_u) * size[0] as f64 - 0.5;
    let y = clamped(uv.y, s.wrap_v) * size[1] as f64 - 0.5;
    let (x0, y0) = (x.floor(), y.floor());
    let mut sum = [0.0; 3];
    for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let wx = if dx == 0 { 1.0 - (x - x0) } else { x - x0 };
        let wy = if dy == 0 { 1.0 - (y - y0) } else { y - y0 };
        let t = texel(
            wrapped_index(x0 as i64 + dx, size[0], s.wrap_u),
            wrapped_index(y0 as i64 + dy, size[1], s.wrap_v),
        );
        (0..3).for_each(|c| sum[c] += wx * wy * t[c]);
    }
    sum
}

/// Looks up thousands of places and compares with the reference over the stored image.
fn agrees(path: &Path, s: &BitmapSettings, stored: PixelType, tolerance: f64) {
    let image = crate::image::read(path).unwrap();
    let curve = Curve::of(s, stored, false);
    let n = image.channels.len();
    let texel = |x: i64, y: i64| {
        let p = image.pixel(x as u32, y as u32);
        std::array::from_fn(|c| f64::from(curve.decode(p[c.min(n - 1)])))
    };
    let size = [i64::from(image.width), i64::from(image.height)];
    let bitmap = opened(s.clone());
    let mut rng = Pcg32::new(2, 3);
    for _ in 0..20_000 {
        let uv = Vec2::new(rng.next_f32() * 5.0 - 2.0, rng.next_f32() * 5.0 - 2.0);
        let truth = reference(texel, size, uv, s);
        let value = bitmap.eval(&SurfacePoint::at_uv(uv));
        for c in 0..3 {
            let error = (f64::from(value[c]) - truth[c]).abs();
            assert!(error < tolerance, "{s:?} {uv}: {value} for {truth:?}");
        }
    }
}

#[test]
fn bilinear_look_ups_match_the_definition_in_every_wrap_mode() {
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.exr",
        [13, 7],
        &["R", "G", "B"],
        PixelType::Float,
    );
    let modes = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    for (wrap_u, wrap_v) in modes.iter().flat_map(|&u| modes.map(|v| (u, v))) {
        let s = BitmapSettings {
            wrap_u,
            wrap_v,
            to_uv: UvTransform(glam::Affine2::from_scale_angle_translation(
                Vec2::new(1.5, 0.75),
                0.3,
                Vec2::new(0.1, -0.2),
            )),
            ..settings(&path)
        };
        // 5 periods of 13 texels: a coordinate's rounding error, times the steepest slope.
        agrees(&path, &s, PixelType::Float, 3e-5);
    }
}

#[test]
fn every_storage_is_made_linear_before_it_is_interpolated() {
    let dir = tempfile::tempdir().unwrap();
    let float = if cfg!(feature = "oiio") {
        "float.tif"
    } else {
        "float.exr"
    };
    for (name, stored) in [
        ("8.png", PixelType::U8),
        ("16.png", PixelType::U16),
        ("half.exr", PixelType::Half),
        (float, PixelType::Float),
    ] {
        for channels in [&["R", "G", "B"][..], &["Y"]] {
            let path = noise(dir.path(), name, [32, 9], channels, stored);
            for (raw, gamma) in [
                (false, None),
                (true, None),
                (false, Some(2.2)),
                (false, Some(-1.0)),
            ] {
                let s = BitmapSettings {
                    raw,
                    gamma,
                    ..settings(&path)
                };
                // 16-bit colours are kept as halves, 11 bits of mantissa.
                let half = stored == PixelType::U16 && !raw;
                agrees(&path, &s, stored, if half { 3e-4 } else { 3e-5 });
            }
        }
    }
}

#[test]
fn the_first_row_lies_at_v_0_and_nearest_takes_one_texel() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let mut image = Image::new(2, 2, &["R", "G", "B"]);
    image.pixels = vec![1., 0., 0., 0., 1., 0., 0., 0., 1., 1., 1., 1.];
    write(&path, &image, &WriteOptions::default()).unwrap();
    let s = BitmapSettings {
        filter: Filter::Nearest,
        ..settings(&path)
    };
    let bitmap = opened(s);
    // As Mitsuba 3.9.1 answers for the same image and places.
    for (u, v, expected) in [
        (0.25, 0.25, Rgb::X),
        (0.75, 0.25, Rgb::Y),
        (0.25, 0.75, Rgb::Z),
        (1.25, -0.25, Rgb::Z),
        (1.0, 0.0, Rgb::X),
    ] {
        let at = SurfacePoint::at_uv(Vec2::new(u, v));
        assert_eq!(bitmap.eval(&at), expected, "{u} {v}");
    }
    assert_eq!(bitmap.texel(0, 1), Rgb::Z);
    assert_eq!((bitmap.width(), bitmap.height()), (2, 2));
}

#[test]
fn a_wide_footprint_sees_the_mean_and_a_narrow_one_the_texels() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let mut image = Image::new(256, 256, &["Y"]);
    for (i, x) in image.pixels.iter_mut().enumerate() {
        *x = ((i + i / 256) % 2) as f32;
    }
    write(&path, &image, &WriteOptions::default()).unwrap();
    let bitmap = opened(settings(&path));
    let at = |footprint| {
        let point = SurfacePoint {
            footprint,
            // A unit of u spans 10 world units, a unit of v 20.
            dp_du: Vec3::X * 10.0,
            dp_dv: Vec3::Y * 20.0,
            ..SurfacePoint::at_uv(Vec2::new(3.5 / 256.0, 8.5 / 256.0))
        };
        (bitmap.level_at(&point), bitmap.eval_scalar(&point))
    };
    assert_eq!(at(0.0), (0, 1.0));
    let texel = 20.0 / 256.0;
    assert_eq!(at(3.9 * texel), (0, 1.0));
    assert_eq!(at(4.1 * texel), (1, 0.5));
    assert_eq!(at(16.1 * texel), (3, 0.5));
    assert_eq!(at(1e9), (8, 0.5));
    assert_eq!(bitmap.level_count(), 9);
}

#[test]
fn means_are_those_of_the_texels() {
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.exr",
        [61, 17],
        &["R", "G", "B"],
        PixelType::Float,
    );
    let image = crate::image::read(&path).unwrap();
    let mut mean = glam::DVec3::ZERO;
    for p in image.rgb() {
        mean += p.as_dvec3() / f64::from(61 * 17);
    }
    let texture = TextureStore::new(PLENTY).open(settings(&path)).unwrap();
    assert!((texture.mean().as_dvec3() - mean).length() < 1e-6);
    let twice = Texture::Scale(std::sync::Arc::new((texture, Rgb::splat(2.0))));
    assert!((twice.mean().as_dvec3() - 2.0 * mean).length() < 2e-6);
}

#[test]
fn attributes_of_a_mesh_are_mixed_or_a_faces_own() {
    let attribute = |name: &str, per_face| MeshAttribute {
        name: name.into(),
        per_face,
        values: vec![Rgb::X, Rgb::Y, Rgb::Z],
    };
    let attributes = MeshAttributes {
        list: vec![
            attribute("vertex_color", false),
            attribute("face_color", true),
        ],
    };
    let point = SurfacePoint {
        prim: 2,
        vertices: [2, 0, 1],
        barycentric: Vec2::new(0.25, 0.125),
        attributes: Some(&attributes),
        ..SurfacePoint::at_uv(Vec2::ZERO)
    };
    let eval = |name: &str| Texture::MeshAttribute(name.into()).eval(&point);
    assert_eq!(eval("vertex_color"), Rgb::new(0.25, 0.125, 0.625));
    assert_eq!(eval("face_color"), Rgb::Z);
    assert_eq!(eval("vertex_speed"), Rgb::ZERO);
    let beyond = SurfacePoint { prim: 3, ..point };
    let face = Texture::MeshAttribute("face_color".into());
    assert_eq!(face.eval(&beyond), Rgb::ZERO);
}

/// The gradient against differences, inside texels and wherever an image is wrapped to.
#[test]
fn gradients_are_the_limits_of_differences() {
    const STEP: f32 = 1e-4;
    let dir = tempfile::tempdir().unwrap();
    let path = noise(dir.path(), "heights.exr", [7, 5], &["Y"], PixelType::Float);
    let turned =
        glam::Affine2::from_scale_angle_translation(Vec2::new(2.0, 0.5), 0.7, Vec2::new(0.1, -0.3));
    let mut rng = Pcg32::new(5, 2);
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        let image = opened(BitmapSettings {
            wrap_u: wrap,
            wrap_v: wrap,
            to_uv: UvTransform(turned),
            ..settings(&path)
        });
        let mut wrong = 0;
        for _ in 0..400 {
            let uv = Vec2::new(rng.next_f32(), rng.next_f32()) * 4.0 - 2.0;
            let [du, dv] = image.gradient(uv);
            let difference = |along: Vec2| {
                let at = |step: f32| image.eval_uv(uv + along * step, 0).x;
                (at(STEP) - at(-STEP)) / (2.0 * STEP)
            };
            let error = (du.x - difference(Vec2::X)).abs() + (dv.x - difference(Vec2::Y)).abs();
            wrong += i32::from(error > 0.05);
        }
        // Where a step leaves its texel: about 3 in 1000 for each of two axes.
        assert!(wrong < 12, "{wrap:?}: {wrong} of 400");
    }
}
