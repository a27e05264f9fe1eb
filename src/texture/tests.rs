//! Image textures against closed forms, and the two ways to hold them against each other.

use super::*;
use crate::image::curve::srgb_to_linear;
use crate::image::{Image, PixelType, WriteOptions, write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

const WIDTH: u32 = 24;
const HEIGHT: u32 = 10;

/// 8-bit code of a channel at a texel.
fn code(x: u32, y: u32, c: u32) -> u8 {
    ((x * 37 + y * 91 + c * 53) % 256) as u8
}

/// Writes the test picture as 8-bit sRGB (`oiio`) or as float with the same linear values.
fn picture(folder: &Path, name: &str) -> PathBuf {
    let mut image = Image::new(WIDTH, HEIGHT, &["R", "G", "B"]);
    for (i, x) in image.pixels.iter_mut().enumerate() {
        let (pixel, c) = (i as u32 / 3, i as u32 % 3);
        *x = srgb_to_linear(f32::from(code(pixel % WIDTH, pixel / WIDTH, c)) / 255.0);
    }
    let path = folder.join(name);
    let options = WriteOptions {
        pixel_type: Some(if name.ends_with("png") {
            PixelType::U8
        } else {
            PixelType::Float
        }),
        ..WriteOptions::default()
    };
    write(&path, &image, &options).expect("the picture is written");
    path
}

fn settings(path: PathBuf, filter: Filter, wrap: Wrap) -> BitmapSettings {
    BitmapSettings {
        path,
        raw: false,
        gamma: None,
        filter,
        wrap_u: wrap,
        wrap_v: wrap,
        to_uv: UvTransform(glam::Affine2::IDENTITY),
        channel: None,
    }
}

fn bitmap(store: &TextureStore, settings: BitmapSettings) -> Arc<Bitmap> {
    match store.open(settings).expect("the texture opens") {
        Texture::Bitmap(bitmap) => bitmap,
        other => panic!("{other:?} is no bitmap"),
    }
}

fn wrap_index(i: i64, n: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Mirror => {
            let t = i.rem_euclid(2 * n);
            if t < n { t } else { 2 * n - 1 - t }
        }
    }
}

/// Bilinear interpolation of linear values, written down plainly.
fn truth(uv: Vec2, wrap: Wrap) -> Rgb {
    let (x, y) = (uv.x * WIDTH as f32 - 0.5, uv.y * HEIGHT as f32 - 0.5);
    let texel = |i: f32, j: f32| {
        let x = wrap_index(i as i64, i64::from(WIDTH), wrap) as u32;
        let y = wrap_index(j as i64, i64::from(HEIGHT), wrap) as u32;
        let value = |c| srgb_to_linear(f32::from(code(x, y, c)) / 255.0);
        Rgb::new(value(0), value(1), value(2))
    };
    let (x0, y0) = (x.floor(), y.floor());
    let top = texel(x0, y0).lerp(texel(x0 + 1.0, y0), x - x0);
    let bottom = texel(x0, y0 + 1.0).lerp(texel(x0 + 1.0, y0 + 1.0), x - x0);
    top.lerp(bottom, y - y0)
}

fn places() -> impl Iterator<Item = Vec2> {
    let mut rng = crate::math::Pcg32::new(2, 9);
    (0..2000).map(move |_| Vec2::new(rng.next_f32() * 5.0 - 2.5, rng.next_f32() * 5.0 - 2.5))
}

/// Names of the picture for this build: PNG needs OpenImageIO.
fn names() -> &'static [&'static str] {
    if cfg!(feature = "oiio") {
        &["a.exr", "a.png"]
    } else {
        &["a.exr"]
    }
}

#[test]
fn lookups_are_bilinear_in_linear_values_for_every_wrap() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for name in names() {
        let path = picture(folder.path(), name);
        // A budget of nothing sends every texture to the cache, if there is one.
        for budget in [1 << 30, 0] {
            let store = TextureStore::new(budget);
            for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
                let bitmap = bitmap(&store, settings(path.clone(), Filter::Linear, wrap));
                assert_eq!(bitmap.is_resident(), budget > 0 || !cfg!(feature = "oiio"));
                for uv in places() {
                    let difference = (bitmap.eval_uv(uv, 0) - truth(uv, wrap))
                        .abs()
                        .max_element();
                    // The positions are rounded to f32 before they meet texels of contrast 1.
                    assert!(difference < 2e-5, "{name} {wrap:?} {uv}: {difference}");
                }
            }
        }
    }
}

#[test]
fn nearest_takes_the_texel_itself() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let store = TextureStore::new(1 << 30);
    let path = picture(folder.path(), "a.exr");
    let bitmap = bitmap(&store, settings(path, Filter::Nearest, Wrap::Repeat));
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let uv = Vec2::new(
                (x as f32 + 0.3) / WIDTH as f32,
                (y as f32 + 0.6) / HEIGHT as f32,
            );
            assert_eq!(bitmap.eval_uv(uv, 0), bitmap.texel(x, y));
        }
    }
}

#[test]
fn coarse_levels_approach_the_mean() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let store = TextureStore::new(1 << 30);
    let bitmap = bitmap(
        &store,
        settings(
            picture(folder.path(), "a.exr"),
            Filter::Linear,
            Wrap::Repeat,
        ),
    );
    let last = bitmap.level_count() - 1;
    let seen = bitmap.eval_uv(Vec2::new(0.3, 0.8), last);
    assert!((seen - bitmap.mean()).abs().max_element() < 1e-5);
    let mut point = SurfacePoint::at_uv(Vec2::new(0.3, 0.8));
    point.footprint = 100.0;
    assert_eq!(bitmap.eval(&point), seen);
    point.footprint = 0.0;
    assert_eq!(bitmap.eval(&point), bitmap.eval_uv(point.uv, 0));
}

#[test]
fn a_file_is_held_once_whatever_its_placement() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let store = TextureStore::new(1 << 30);
    let path = picture(folder.path(), "a.exr");
    let one = bitmap(&store, settings(path.clone(), Filter::Linear, Wrap::Repeat));
    let bytes = store.memory_bytes();
    let mut moved = settings(path.clone(), Filter::Nearest, Wrap::Clamp);
    moved.to_uv = UvTransform(glam::Affine2::from_scale(Vec2::splat(2.0)));
    let two = bitmap(&store, moved);
    assert_eq!((store.file_count(), store.memory_bytes()), (1, bytes));
    assert_eq!(two.eval_uv(Vec2::new(0.1, 0.2), 0), one.texel(4, 4));
    let mut green = settings(path, Filter::Nearest, Wrap::Repeat);
    green.channel = Some("g".into());
    let green = bitmap(&store, green);
    assert!(green.is_grey());
    assert_eq!(green.texel(3, 2).x, one.texel(3, 2).y);
}

#[test]
fn missing_files_and_channels_are_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let store = TextureStore::new(1 << 30);
    let absent = settings(
        folder.path().join("absent.png"),
        Filter::Linear,
        Wrap::Repeat,
    );
    assert!(
        store
            .open(absent)
            .expect_err("absent")
            .to_string()
            .contains("absent.png")
    );
    let mut odd = settings(
        picture(folder.path(), "a.exr"),
        Filter::Linear,
        Wrap::Repeat,
    );
    odd.channel = Some("depth".into());
    let error = store.open(odd).expect_err("no such channel").to_string();
    assert!(
        error.contains("depth") && error.contains("R, G, B"),
        "{error}"
    );
}

#[test]
fn many_threads_may_open_and_look_up_at_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = picture(folder.path(), names()[names().len() - 1]);
    let store = TextureStore::new(0);
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let bitmap = bitmap(&store, settings(path.clone(), Filter::Linear, Wrap::Repeat));
                for uv in places() {
                    let difference = bitmap.eval_uv(uv, 0) - truth(uv, Wrap::Repeat);
                    assert!(difference.abs().max_element() < 2e-5);
                }
            });
        }
    });
    assert_eq!(store.file_count(), 1);
}

#[test]
fn mesh_attributes_interpolate_and_absent_ones_are_black() {
    let attributes = MeshAttributes {
        list: vec![
            MeshAttribute {
                name: "vertex_color".into(),
                per_face: false,
                values: vec![Rgb::X, Rgb::Y, Rgb::Z],
            },
            MeshAttribute {
                name: "face_color".into(),
                per_face: true,
                values: vec![Rgb::ZERO, Rgb::splat(0.25)],
            },
        ],
    };
    let mut point = SurfacePoint::at_uv(Vec2::ZERO);
    point.attributes = Some(&attributes);
    (point.vertices, point.prim) = ([2, 0, 1], 1);
    point.barycentric = Vec2::new(0.5, 0.25);
    let value = |name: &str| Texture::MeshAttribute(name.into()).eval(&point);
    assert_eq!(value("vertex_color"), Rgb::new(0.5, 0.25, 0.25));
    assert_eq!(value("face_color"), Rgb::splat(0.25));
    assert_eq!(value("vertex_heat"), Rgb::ZERO);
}
