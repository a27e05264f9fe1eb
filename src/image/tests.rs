//! Tests of whole files.

use super::file::ImageFile;
use super::write::write_parts;
use super::*;
use crate::math::Pcg32;
use std::path::PathBuf;

mod damage;
mod formats;

/// An image of noise, `low` to `high`, with metadata of all kinds.
fn noise(width: u32, height: u32, names: &[&str], low: f32, high: f32) -> Image {
    let mut rng = Pcg32::new(5, u64::from(width));
    let mut image = Image::new(width, height, names);
    for x in &mut image.pixels {
        *x = low + (high - low) * rng.next_f32();
    }
    image.attributes = vec![
        Attribute::text("Software", "twintree test"),
        Attribute::text("twintree:scene", "scenes/a b.xml"),
        Attribute::int("twintree:passes", 17),
        Attribute::float("twintree:seconds", 1.5),
    ];
    image
}

fn half_rounded(image: &Image) -> Vec<f32> {
    let round = |x: &f32| half::f16::from_f32(*x).to_f32();
    image.pixels.iter().map(round).collect()
}

const FILM: [&str; 8] = [
    "R", "G", "B", "albedo.R", "albedo.G", "albedo.B", "depth.Z", "normal.X",
];

/// Reads all parts of an image file.
fn read_parts(path: &Path) -> Result<Vec<Image>, ImageError> {
    let mut file = ImageFile::open(path)?;
    let mut parts = vec![file.image()?];
    while file.seek(parts.len() as u32, 0)? {
        parts.push(file.image()?);
    }
    Ok(parts)
}

/// By our own reader and by an independent one, in lines and in tiles.
#[test]
fn an_exr_says_where_its_pixels_lie() {
    use super::header::{Level, Window};
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let whole = Level {
        width: 300,
        height: 200,
    };
    for at in [[17, 131], [0, 0], [233, 0], [-5, -7]] {
        let mut image = noise(67, 41, &FILM, -3.0, 100.0);
        image.window = Some(Window { at, whole });
        for tiled in [false, true] {
            let options = WriteOptions {
                pixel_type: Some(PixelType::Float),
                tiled,
                ..Default::default()
            };
            write(&path, &image, &options).unwrap();
            let back = read(&path).unwrap();
            assert_eq!((back.window, &back.pixels), (image.window, &image.pixels));
            let theirs = openexr::read_parts(&path).unwrap();
            assert_eq!(theirs[0].window, image.window);
            assert_eq!(theirs[0].pixels, image.pixels);
        }
    }
    let tiff = dir.path().join("a.tif");
    if cfg!(feature = "oiio") {
        let mut image = noise(6, 4, &["R", "G", "B"], 0.0, 1.0);
        image.window = Some(Window { at: [1, 1], whole });
        write(&tiff, &image, &WriteOptions::default()).unwrap();
        assert_eq!(read(&tiff).unwrap().window, None);
    }
}

#[test]
fn exr_returns_what_it_got_in_every_packing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let image = noise(67, 41, &FILM, -3.0, 100.0);
    for pixel_type in [PixelType::Half, PixelType::Float] {
        for compression in [Compression::Default, Compression::None, Compression::Piz] {
            for tiled in [false, true] {
                let options = WriteOptions {
                    pixel_type: Some(pixel_type),
                    compression,
                    tiled,
                    exposure: 3.0,
                    view: ViewTransform::Agx,
                };
                write(&path, &image, &options).unwrap();
                let back = read(&path).unwrap();
                assert_eq!(back.channel_names(), FILM, "{options:?}");
                assert_eq!((back.width, back.height), (67, 41));
                let expected = match pixel_type {
                    PixelType::Float => image.pixels.clone(),
                    _ => half_rounded(&image),
                };
                assert_eq!(back.pixels, expected, "{options:?}");
                for a in &image.attributes {
                    assert_eq!(back.attribute(&a.name), Some(&a.value), "{options:?}");
                }
            }
        }
    }
}

/// The `exr` crate and OpenImageIO share no code.
#[test]
fn another_reader_sees_the_same_pixels_and_attributes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let mut image = noise(33, 20, &FILM, 0.0, 4.0);
    image.channels[6].pixel_type = Some(PixelType::Float);
    write(&path, &image, &WriteOptions::default()).unwrap();
    let other = openexr::read_parts(&path).unwrap().remove(0);
    assert_eq!((other.width, other.height), (33, 20));
    let halves = half_rounded(&image);
    for (c, name) in FILM.iter().enumerate() {
        let theirs = other.channel(name).unwrap();
        for i in 0..(33 * 20) {
            let got = other.pixels[i * 8 + theirs];
            let exact = if c == 6 { &image.pixels } else { &halves };
            assert_eq!(got, exact[i * 8 + c], "{name} of pixel {i}");
        }
    }
    for a in &image.attributes {
        assert_eq!(other.attribute(&a.name), Some(&a.value));
    }
    // Both tell how each channel is stored, as they differ in that.
    for read in [&other, &read(&path).unwrap()] {
        for (c, name) in FILM.iter().enumerate() {
            let stored = read.channels[read.channel(name).unwrap()].pixel_type;
            let expected = if c == 6 {
                PixelType::Float
            } else {
                PixelType::Half
            };
            assert_eq!(stored, Some(expected), "{name}");
        }
    }
}

/// What the `exr` crate writes when OpenImageIO is not there, the usual reader reads.
#[test]
fn the_writer_of_builds_without_openimageio_is_understood() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let image = noise(33, 20, &FILM, 0.0, 4.0);
    for tiled in [false, true] {
        let options = WriteOptions {
            tiled,
            ..Default::default()
        };
        openexr::write(&path, &[(&image, vec![PixelType::Float; 8])], &options).unwrap();
        let back = read(&path).unwrap();
        assert_eq!(back.channel_names(), FILM);
        assert_eq!(back.pixels, image.pixels);
        for a in &image.attributes {
            assert_eq!(back.attribute(&a.name), Some(&a.value));
        }
    }
}

#[test]
fn parts_keep_their_names_sizes_and_order() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("parts.exr");
    let first = noise(20, 10, &["R", "G", "B"], 0.0, 1.0);
    let second = noise(20, 10, &["Z"], 0.0, 9.0);
    let options = WriteOptions {
        pixel_type: Some(PixelType::Float),
        ..Default::default()
    };
    write_parts(&path, &[(&first, "beauty"), (&second, "depth")], &options).unwrap();
    let back = read_parts(&path).unwrap();
    assert_eq!(back.len(), 2);
    assert_eq!(back[0].pixels, first.pixels);
    assert_eq!(back[1].pixels, second.pixels);
    assert_eq!(back[1].channel_names(), ["Z"]);
    let name = AttributeValue::Text("depth".into());
    assert_eq!(back[1].attribute("oiio:subimagename"), Some(&name));
}

#[test]
fn finite_numbers_stay_finite_in_half_floats() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("bright.exr");
    let mut image = Image::new(2, 1, &["R", "G", "B"]);
    image.pixels = vec![1e9, -1e9, 65504.0, f32::INFINITY, f32::NAN, 1e-9];
    write(&path, &image, &WriteOptions::default()).unwrap();
    let back = read(&path).unwrap().pixels;
    assert_eq!(back[..4], [65504.0, -65504.0, 65504.0, f32::INFINITY]);
    assert!(back[4].is_nan());
}

#[test]
fn strips_and_channels_are_the_parts_of_the_whole() {
    let dir = tempfile::tempdir().unwrap();
    let image = noise(150, 133, &["R", "G", "B", "A"], 0.0, 1.0);
    for tiled in [false, true] {
        let path = dir.path().join(format!("{tiled}.exr"));
        let options = WriteOptions {
            pixel_type: Some(PixelType::Float),
            tiled,
            ..Default::default()
        };
        write(&path, &image, &options).unwrap();
        let mut file = ImageFile::open(&path).unwrap();
        let strip = file.strip_height(20 * 150 * 4);
        let mut y0 = 0;
        while y0 < 133 {
            let y1 = (y0 + strip).min(133);
            let mut two = vec![0f32; 150 * (y1 - y0) as usize * 2];
            file.rows(y0..y1, 1..3, PixelType::Float, &mut two).unwrap();
            for (i, pair) in two.chunks_exact(2).enumerate() {
                let at = (y0 as usize * 150 + i) * 4;
                assert_eq!(pair, &image.pixels[at + 1..at + 3]);
            }
            y0 = y1;
        }
    }
}

#[test]
fn names_that_say_no_format_are_refused() {
    let image = Image::new(1, 1, &["R"]);
    for name in ["picture", "picture.xyz", "exr"] {
        let e = write(&PathBuf::from(name), &image, &WriteOptions::default()).unwrap_err();
        assert!(e.reason.contains(".exr"), "{e}");
        assert!(!PathBuf::from(name).exists());
    }
}
