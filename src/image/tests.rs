//! Round trips, metadata through an independent reader, and files that are whole or not there.

use super::*;
use std::path::PathBuf;

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

/// A picture of `names` with values from 0 to 1, every pixel different.
fn ramp(width: u32, height: u32, names: &[&str]) -> Image {
    let mut image = Image::new(width, height, names);
    let n = image.pixels.len() as f32;
    for (i, x) in image.pixels.iter_mut().enumerate() {
        *x = (i as f32 + 0.5) / n;
    }
    image
}

fn worst(a: &Image, b: &Image) -> f32 {
    assert_eq!(
        (a.width, a.height, a.pixels.len()),
        (b.width, b.height, b.pixels.len())
    );
    let differences = a.pixels.iter().zip(&b.pixels).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f32::max)
}

#[test]
fn every_format_comes_back_within_its_precision() {
    let folder = folder();
    let image = ramp(37, 21, &["R", "G", "B"]);
    let cases: &[(&str, Option<PixelType>, bool, f32)] = &[
        ("a.exr", Some(PixelType::Float), false, 0.0),
        ("b.exr", Some(PixelType::Half), false, 5e-4),
        ("c.exr", Some(PixelType::Float), true, 0.0),
        #[cfg(feature = "oiio")]
        ("d.tif", Some(PixelType::Float), false, 0.0),
        #[cfg(feature = "oiio")]
        ("e.tif", Some(PixelType::U16), false, 1e-5),
        #[cfg(feature = "oiio")]
        ("f.hdr", None, false, 4e-3),
        #[cfg(feature = "oiio")]
        ("g.png", Some(PixelType::U16), false, 3e-5),
        #[cfg(feature = "oiio")]
        ("h.png", None, false, 5e-3),
    ];
    for &(name, pixel_type, tiled, tolerance) in cases {
        let path = folder.path().join(name);
        let options = WriteOptions {
            pixel_type,
            tiled,
            ..WriteOptions::default()
        };
        write(&path, &image, &options).expect(name);
        let back = match Format::of(&path).expect(name).is_display() {
            true => read_linear(&path),
            false => read(&path),
        };
        let error = worst(&image, &back.expect(name));
        assert!(error <= tolerance, "{name}: {error}");
    }
}

#[cfg(feature = "oiio")]
#[test]
fn an_independent_reader_finds_layers_types_and_metadata() {
    let folder = folder();
    let path = folder.path().join("layers.exr");
    let mut image = ramp(
        19,
        11,
        &["R", "G", "B", "normal.X", "normal.Y", "normal.Z", "depth.Z"],
    );
    image.channels[6].pixel_type = Some(PixelType::Float);
    image
        .attributes
        .push(Attribute::text("twintree:scene", "a scene"));
    image
        .attributes
        .push(Attribute::float("twintree:seconds", 2.5));
    for compression in [
        Compression::Default,
        Compression::None,
        Compression::Zip,
        Compression::Piz,
    ] {
        let options = WriteOptions {
            compression,
            ..WriteOptions::default()
        };
        write(&path, &image, &options).expect("written");
        let parts = openexr::read_parts(&path).expect("readable");
        assert_eq!(parts.len(), 1);
        let back = &parts[0];
        for (c, channel) in image.channels.iter().enumerate() {
            let found = back.channel(&channel.name).expect("the channel");
            let tolerance = if channel.pixel_type.is_some() {
                0.0
            } else {
                5e-4
            };
            for y in 0..11 {
                for x in 0..19 {
                    let difference = (image.pixel(x, y)[c] - back.pixel(x, y)[found]).abs();
                    assert!(difference <= tolerance, "{} {x} {y}", channel.name);
                }
            }
        }
        let scene = back.attribute("twintree:scene").expect("metadata");
        assert_eq!(*scene, AttributeValue::Text("a scene".into()));
        let seconds = back.attribute("twintree:seconds").expect("metadata");
        assert_eq!(*seconds, AttributeValue::Float(2.5));
    }
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = folder();
    let path = folder.path().join("kept.exr");
    std::fs::write(&path, "the old file").expect("written");
    let mut broken = ramp(8, 8, &["R", "G", "B"]);
    broken.pixels.truncate(5);
    assert!(write(&path, &broken, &WriteOptions::default()).is_err());
    assert!(atomic::replace(&path, |_| Err("the disk is full".into())).is_err());
    assert_eq!(
        std::fs::read_to_string(&path).expect("still there"),
        "the old file"
    );
    assert_eq!(std::fs::read_dir(folder.path()).expect("listed").count(), 1);
}

#[test]
fn what_cannot_be_read_or_written_is_said_in_words() {
    let folder = folder();
    let at = |name: &str| folder.path().join(name);
    let image = ramp(4, 4, &["R", "G", "B"]);
    let options = WriteOptions::default();
    let fails = |path: PathBuf, words: &str| {
        let error = write(&path, &image, &options).expect_err(words).to_string();
        assert!(
            error.contains(words) && error.contains(&path.display().to_string()),
            "{error}"
        );
    };
    fails(at("picture"), "which format");
    fails(at("no/such/folder/a.exr"), "no directory");

    let missing = read(&at("missing.exr")).expect_err("missing").to_string();
    assert!(
        missing.contains("missing.exr") && missing.contains("cannot be opened"),
        "{missing}"
    );
    std::fs::write(at("noise.exr"), [7u8; 300]).expect("written");
    assert!(read(&at("noise.exr")).is_err());
}

/// A file cut short or with flipped bits is an error or an image, never a panic.
#[test]
fn damaged_files_are_refused_or_read() {
    let folder = folder();
    let path = folder.path().join("whole.exr");
    write(
        &path,
        &ramp(16, 16, &["R", "G", "B"]),
        &WriteOptions::default(),
    )
    .expect("written");
    let whole = std::fs::read(&path).expect("read");
    let damaged = folder.path().join("damaged.exr");
    let mut rng = crate::math::Pcg32::new(11, 3);
    for round in 0..200 {
        let mut bytes = whole.clone();
        if round % 2 == 0 {
            bytes.truncate(rng.next_u32() as usize % bytes.len());
        } else {
            for _ in 0..4 {
                let at = rng.next_u32() as usize % bytes.len();
                bytes[at] ^= 1 << (rng.next_u32() % 8);
            }
        }
        std::fs::write(&damaged, &bytes).expect("written");
        if let Ok(image) = read(&damaged) {
            let expected = image.width as usize * image.height as usize * image.channels.len();
            assert_eq!(image.pixels.len(), expected);
        }
    }
}
