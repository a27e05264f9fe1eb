//! Files that are damaged, that lie, that are of other formats, and files that were written.

use super::jpeg_files::{jpeg_file, ramp};
use super::png_files::png_file;
use super::*;

/// One file of each format, of noise.
fn written(dir: &Path) -> [(PathBuf, Vec<u8>); 3] {
    let mut rng = Pcg32::new(1, 2);
    let mut image = Image::new(40, 30, &["R", "G", "B"]);
    image.pixels.fill_with(|| rng.next_f32());
    [Format::Png, Format::Jpeg, Format::Hdr].map(|format| {
        let path = dir.join(format!("{format:?}"));
        write(
            &path,
            format,
            &image,
            PixelType::U8,
            &WriteOptions::default(),
        )
        .unwrap();
        let bytes = std::fs::read(&path).unwrap();
        (path, bytes)
    })
}

#[test]
fn the_content_decides_and_not_the_name() {
    let dir = tempfile::tempdir().unwrap();
    for (path, bytes) in written(dir.path()) {
        let named = dir.path().join("a.exr");
        std::fs::write(&named, bytes).unwrap();
        assert_eq!(ours(&named).unwrap().1, ours(&path).unwrap().1);
        let mut input = open(&named).unwrap();
        let found = [(0, 0), (1, 0), (0, 1)].map(|(part, level)| input.seek(part, level));
        assert_eq!(found, [Ok(true), Ok(false), Ok(false)], "it has one image");
    }
    let part = |name: &str, width| Image {
        attributes: vec![Attribute::text("oiio:subimagename", name)],
        ..Image::new(width, 2, &["Z"])
    };
    let (first, second) = (part("first", 3), part("second", 5));
    let parts = [&first, &second].map(|image| (image, vec![PixelType::Half]));
    let named = dir.path().join("a.png");
    openexr::write(&named, &parts, &WriteOptions::default()).unwrap();
    let mut input = open(&named).unwrap();
    assert_eq!((input.seek(1, 0), input.seek(2, 0)), (Ok(true), Ok(false)));
    assert_eq!(input.header().unwrap().level.width, 5);
}

/// A picture that ends early is not taken for a whole one.
#[test]
fn a_file_that_is_cut_short_anywhere_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    for (path, bytes) in written(dir.path()) {
        // The last bytes of PNG and JPEG say only that this was all.
        let ends = (0..60)
            .map(|i| bytes.len() * i / 60)
            .chain([bytes.len() - 20]);
        for end in ends {
            std::fs::write(&path, &bytes[..end]).unwrap();
            assert!(ours(&path).is_err(), "{} to {end}", path.display());
        }
    }
}

#[test]
fn damaged_files_do_no_harm() {
    let dir = tempfile::tempdir().unwrap();
    let mut rng = Pcg32::new(3, 4);
    for (path, whole) in written(dir.path()) {
        let mut read = 0;
        for round in 0..400 {
            let mut bytes = whole.clone();
            let reach = if round % 2 == 0 { 200 } else { whole.len() };
            for _ in 0..1 + round % 6 {
                let at = rng.next_u32() as usize % reach;
                bytes[at] = rng.next_u32() as u8;
            }
            std::fs::write(&path, &bytes).unwrap();
            match ours(&path) {
                Ok(_) => read += 1,
                Err(why) => assert!(!why.is_empty()),
            }
        }
        println!("{}: {read} of 400 are read", path.display());
    }
}

#[test]
fn a_header_that_promises_too_much_is_refused_before_anything_is_decoded() {
    let mut png = png_file(png::ColorType::Rgb, png::BitDepth::Eight, None, None).0;
    png[16..24].copy_from_slice(&[0, 0, 0xea, 0x60, 0, 0, 0xea, 0x60]);
    let mut crc = flate2::Crc::new();
    crc.update(&png[12..29]);
    png[29..33].copy_from_slice(&crc.sum().to_be_bytes());
    let mut jpeg = jpeg_file(Jpeg::Rgb, 3, SamplingFactor::F_1_1, true);
    let frame = jpeg.windows(2).position(|w| w == [0xff, 0xc2]).unwrap();
    jpeg[frame + 5..frame + 9].copy_from_slice(&[0xea, 0x60, 0xea, 0x60]);
    let hdr = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n".to_vec();
    for bytes in [png, jpeg, hdr] {
        let (_dir, path) = file("a", &bytes);
        let why = open(&path).unwrap_err();
        assert!(why.contains("60000 x 60000"), "{why}");
    }
}

/// The densest that PNG can be: a bit a pixel, all the same, through a palette with alpha.
#[test]
fn a_large_picture_of_one_colour_is_no_lie() {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 4096, 1024);
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::One);
    encoder.set_palette([1, 2, 3, 4, 5, 6].as_slice());
    encoder.set_trns([7, 8].as_slice());
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[0; 4096 / 8 * 1024]).unwrap();
    writer.finish().unwrap();
    let (_dir, path) = file("a.png", &bytes);
    println!("{} bytes", bytes.len());
    let (header, pixels) = ours(&path).unwrap();
    assert_eq!((header.level.width, header.level.height), (4096, 1024));
    assert_eq!(pixels.last().map(|a| a * 255.0), Some(7.0));
}

#[test]
fn formats_that_are_not_read_are_named() {
    for (bytes, parts) in [
        (&b"II*\0\x08\0\0\0"[..], ["TIFF", "feature `oiio`"]),
        (b"GIF89a", ["GIF", "Radiance"]),
        (b"RIFF\0\0\0\0WEBPVP8 ", ["WebP", "PNG"]),
        (b"\0\0\0\x1cftypavif", ["AVIF", "JPEG"]),
        (b"hello", ["none of", "feature `oiio`"]),
        (b"", ["empty", "file"]),
        (
            b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n",
            ["xyze", "32-bit_rle_rgbe"],
        ),
        (b"#?RADIANCE\n\n+Y 1 +X 1\n    ", ["+Y 1", "-Y HEIGHT"]),
    ] {
        let (_dir, path) = file("a.png", bytes);
        let why = open(&path).unwrap_err();
        assert!(parts.iter().all(|part| why.contains(part)), "{why}");
    }
}

/// By OpenImageIO where this build has it, or else by the same crates.
#[test]
fn what_is_written_is_read() -> Result<(), ImageError> {
    let dir = tempfile::tempdir().unwrap();
    for (names, format, stored, most) in [
        (&["Y"][..], Format::Png, PixelType::U8, 0.501 / 255.0),
        (
            &["R", "G", "B"],
            Format::Png,
            PixelType::U16,
            0.501 / 65535.0,
        ),
        (
            &["R", "G", "B", "A"],
            Format::Png,
            PixelType::U8,
            0.501 / 255.0,
        ),
        (&["Y"], Format::Jpeg, PixelType::U8, 0.02),
        (&["R", "G", "B"], Format::Jpeg, PixelType::U8, 0.02),
    ] {
        let mut image = Image::new(64, 48, names);
        let ramp = ramp(names.len());
        image.pixels = ramp.iter().map(|&c| f32::from(c) / 256.0).collect();
        let path = dir.path().join("a");
        let options = WriteOptions {
            compression: Compression::Quality(100),
            ..WriteOptions::default()
        };
        write(&path, format, &image, stored, &options).unwrap();
        let back = crate::image::read(&path)?;
        assert_eq!(back.channel_names(), names);
        let errors = back
            .pixels
            .iter()
            .zip(&image.pixels)
            .map(|(a, b)| (a - b).abs());
        let mean = errors.clone().sum::<f32>() / image.pixels.len() as f32;
        let largest = errors.fold(0.0, f32::max);
        let seen = if format == Format::Png { largest } else { mean };
        assert!(seen <= most, "{format:?} {names:?}: {seen}");
    }
    Ok(())
}
