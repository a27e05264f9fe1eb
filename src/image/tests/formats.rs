//! Round trips through the formats other than EXR.

use super::*;
use crate::image::curve::{linear_to_srgb, srgb_to_linear};
use crate::image::file::read_linear;

fn written(name: &str, image: &Image, options: &WriteOptions) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    write(&path, image, options).unwrap();
    (dir, path)
}

#[cfg(feature = "oiio")]
#[test]
fn tiff_keeps_every_type() {
    let image = noise(70, 45, &["R", "G", "B"], 0.0, 1.0);
    for (pixel_type, step) in [
        (PixelType::U8, 0.5 / 255.0),
        (PixelType::U16, 0.5 / 65535.0),
        (PixelType::Float, 0.0),
    ] {
        for tiled in [false, true] {
            let options = WriteOptions {
                pixel_type: Some(pixel_type),
                tiled,
                ..Default::default()
            };
            let (_dir, path) = written("a.tif", &image, &options);
            let mut file = ImageFile::open(&path).unwrap();
            assert_eq!(file.header().pixel_type, pixel_type);
            assert_eq!(file.header().tile_height > 0, tiled);
            assert!(!file.seek(1, 0).unwrap());
            let back = read(&path).unwrap();
            for (a, b) in back.pixels.iter().zip(&image.pixels) {
                assert!((a - b).abs() <= step + 1e-7, "{pixel_type:?} {a} {b}");
            }
            assert_eq!(
                back.attribute("Software"),
                Some(&AttributeValue::Text("twintree test".into()))
            );
        }
    }
}

#[test]
fn png_shows_exposure_and_the_srgb_curve() {
    let image = noise(50, 30, &["R", "G", "B", "depth.Z", "A"], 0.0, 0.6);
    for (pixel_type, steps) in [(PixelType::U8, 255.0), (PixelType::U16, 65535.0)] {
        let options = WriteOptions {
            pixel_type: Some(pixel_type),
            exposure: 1.0,
            ..Default::default()
        };
        let (_dir, path) = written("a.png", &image, &options);
        let back = read(&path).unwrap();
        assert_eq!(back.channel_names(), ["R", "G", "B", "A"]);
        let linear = read_linear(&path).unwrap();
        for (i, pixel) in image.pixels.chunks_exact(5).enumerate() {
            for (c, value) in pixel[..3].iter().enumerate() {
                // Colours are multiplied by alpha in memory, and not in the file.
                let shown = linear_to_srgb(2.0 * value / pixel[4]).min(1.0);
                let code = back.pixels[4 * i + c];
                assert!((code - shown).abs() <= 0.501 / steps, "{code} {shown}");
                assert_eq!(linear.pixels[4 * i + c], srgb_to_linear(code));
            }
            assert!((back.pixels[4 * i + 3] - pixel[4]).abs() <= 0.501 / steps);
        }
    }
}

#[test]
fn grey_stays_grey() {
    for name in ["a.png", "a.jpg"] {
        let mut image = Image::new(16, 16, &["Y"]);
        image.pixels.fill(0.5);
        let (_dir, path) = written(name, &image, &WriteOptions::default());
        let back = read_linear(&path).unwrap();
        assert_eq!(back.channels.len(), 1, "{name}");
        assert!((back.pixels[100] - 0.5).abs() < 0.005, "{name}");
    }
}

#[test]
fn jpeg_comes_close_and_quality_counts() {
    let mut image = Image::new(128, 128, &["R", "G", "B"]);
    for (i, p) in image.pixels.chunks_exact_mut(3).enumerate() {
        let (x, y) = ((i % 128) as f32 / 128.0, (i / 128) as f32 / 128.0);
        p.copy_from_slice(&[x, y, 0.25]);
    }
    let mut sizes = Vec::new();
    for quality in [30, 95] {
        let options = WriteOptions {
            compression: Compression::Quality(quality),
            ..Default::default()
        };
        let (_dir, path) = written("a.jpg", &image, &options);
        sizes.push(std::fs::metadata(&path).unwrap().len());
        let back = read_linear(&path).unwrap();
        let error: f32 = back
            .pixels
            .iter()
            .zip(&image.pixels)
            .map(|(a, b)| (a - b).abs())
            .sum();
        let mean = error / image.pixels.len() as f32;
        assert!(
            mean < if quality > 90 { 0.006 } else { 0.03 },
            "{quality}: {mean}"
        );
    }
    assert!(sizes[0] < sizes[1]);
}

#[test]
fn radiance_hdr_keeps_the_range() {
    let mut image = noise(40, 20, &["R", "G", "B"], 0.5, 1.0);
    for (i, x) in image.pixels.iter_mut().enumerate() {
        *x *= 10f32.powi((i / 3) as i32 % 9 - 4);
    }
    let (_dir, path) = written("a.hdr", &image, &WriteOptions::default());
    let back = read(&path).unwrap();
    for (a, b) in back
        .pixels
        .chunks_exact(3)
        .zip(image.pixels.chunks_exact(3))
    {
        let largest = b.iter().copied().fold(0.0, f32::max);
        for c in 0..3 {
            // 8 bits of mantissa, shared: half a step of the largest channel's, rounded down.
            assert!((a[c] - b[c]).abs() <= largest / 127.0, "{a:?} {b:?}");
        }
    }
}

#[test]
fn iinfo_lists_channels_types_and_metadata() {
    let mut image = noise(12, 8, &["R", "G", "B", "depth.Z"], 0.0, 1.0);
    image.channels[3].pixel_type = Some(PixelType::Float);
    let (_dir, path) = written("a.exr", &image, &WriteOptions::default());
    let Ok(run) = std::process::Command::new("iinfo")
        .arg("-v")
        .arg(&path)
        .output()
    else {
        eprintln!("skipped: iinfo is not installed (openimageio-tools)");
        return;
    };
    let text = String::from_utf8_lossy(&run.stdout).into_owned();
    for expected in [
        "12 x    8",
        "half/half/half/float",
        "depth.Z (float)",
        "twintree:scene: \"scenes/a b.xml\"",
        "twintree:passes: 17",
        "twintree:seconds: 1.5",
        "compression: \"zip\"",
    ] {
        assert!(text.contains(expected), "no {expected} in\n{text}");
    }
}
