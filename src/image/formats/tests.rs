//! What the crates read and write, against the numbers that went in, and against OpenImageIO where
//! this build has it.

use super::super::header::Header;
use super::super::{Attribute, Compression, Format, Image, ImageError, WriteOptions};
use super::*;
use crate::image::PixelType;
use crate::math::Pcg32;
use jpeg_encoder::{ColorType as Jpeg, Encoder, SamplingFactor};
use std::io::Write as _;
use std::path::PathBuf;

/// A directory, and the name of a file in it with that content.
fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (dir, path)
}

type Whole = (Header, Vec<f32>);

macro_rules! whole {
    ($input:ty, $path:expr) => {{
        let mut input = <$input>::open($path)?;
        let header = input.header()?;
        let rows = 0..header.level.height;
        let channels = 0..header.channels.len();
        let numbers = header.level.width as usize * rows.len() * channels.len();
        let mut pixels = vec![0.0f32; numbers];
        let data = bytemuck::cast_slice_mut(&mut pixels);
        input.rows(rows, channels, PixelType::Float, data)?;
        Ok((header, pixels))
    }};
}

/// Reads a file by the crates.
fn ours(path: &Path) -> Result<Whole, String> {
    whole!(Input, path)
}

#[cfg(feature = "oiio")]
fn theirs(path: &Path) -> Result<Whole, String> {
    whole!(crate::image::oiio::input::Input, path)
}

/// Reads a file by the crates, and where this build has OpenImageIO holds that against what it
/// reads: the same header, and numbers that differ by no more than `most`, and by `mean` on average,
/// floats in relation to their size.
fn read(what: &str, path: &Path, most: f32, mean: f32) -> Whole {
    let ours = ours(path).unwrap_or_else(|e| panic!("{what}: {e}"));
    #[cfg(feature = "oiio")]
    {
        let theirs = theirs(path).unwrap_or_else(|e| panic!("{what}: {e}"));
        let told = |header: &Header| {
            let Header {
                level,
                window,
                channels,
                pixel_type,
                ..
            } = header.clone();
            (level, window, channels, pixel_type, header.format.clone())
        };
        assert_eq!(told(&ours.0), told(&theirs.0), "{what}");
        let size = |b: f32| match ours.0.pixel_type {
            PixelType::Float => b.abs().max(f32::MIN_POSITIVE),
            _ => 1.0,
        };
        let difference = |(a, b): (&f32, &f32)| (a - b).abs() / size(*b);
        let differences = ours.1.iter().zip(&theirs.1).map(difference);
        let largest = differences.clone().fold(0.0, f32::max);
        let average = differences.sum::<f32>() / ours.1.len() as f32;
        println!("{what}: {largest} at most, {average} on average");
        assert!(
            largest <= most && average <= mean,
            "{what}: {largest} {average}"
        );
    }
    let _ = (most, mean);
    ours
}

const WIDTH: u32 = 37;
const HEIGHT: u32 = 21;

/// A PNG of random bits, and the codes of its samples.
fn png_file(
    color: png::ColorType,
    depth: png::BitDepth,
    palette: Option<&[u8]>,
    transparent: Option<&[u8]>,
) -> (Vec<u8>, Vec<u16>) {
    let bits = depth as u32;
    let mut rng = Pcg32::new(bits.into(), color as u64);
    let samples = WIDTH as usize * color.samples();
    let (mut data, mut codes) = (Vec::new(), Vec::new());
    for _ in 0..HEIGHT {
        let mut row = vec![0u8; (samples * bits as usize).div_ceil(8)];
        for i in 0..samples {
            let code = (rng.next_u32() & ((1 << bits) - 1)) as u16;
            codes.push(code);
            match bits {
                16 => row[2 * i..2 * i + 2].copy_from_slice(&code.to_be_bytes()),
                _ => {
                    let at = i * bits as usize;
                    row[at / 8] |= (code as u8) << (8 - bits as usize - at % 8);
                }
            }
        }
        data.extend(row);
    }
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, WIDTH, HEIGHT);
    encoder.set_color(color);
    encoder.set_depth(depth);
    // Neither changes what is read.
    encoder.set_source_gamma(png::ScaledFloat::new(1.0));
    if let Some(palette) = palette {
        encoder.set_palette(palette);
    }
    if let Some(transparent) = transparent {
        encoder.set_trns(transparent);
    }
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&data).unwrap();
    writer.finish().unwrap();
    (bytes, codes)
}

#[test]
fn a_png_of_every_kind_has_the_numbers_that_went_in() {
    use png::{BitDepth as D, ColorType as C};
    let kinds = [
        (
            C::Grayscale,
            [D::One, D::Two, D::Four, D::Eight, D::Sixteen].as_slice(),
        ),
        (C::GrayscaleAlpha, &[D::Eight, D::Sixteen]),
        (C::Rgb, &[D::Eight, D::Sixteen]),
        (C::Rgba, &[D::Eight, D::Sixteen]),
    ];
    for (color, depth) in kinds.iter().flat_map(|(c, d)| d.iter().map(|d| (*c, *d))) {
        let (bytes, codes) = png_file(color, depth, None, None);
        let (_dir, path) = file("a.png", &bytes);
        let what = format!("{color:?} {depth:?}");
        let (header, pixels) = read(&what, &path, 1e-6, 1e-6);
        let sixteen = depth == D::Sixteen;
        let stored = if sixteen {
            PixelType::U16
        } else {
            PixelType::U8
        };
        assert_eq!(header.pixel_type, stored);
        assert_eq!(header.channels.len(), color.samples());
        let most = ((1u32 << depth as u32) - 1) as f32;
        for (value, code) in pixels.iter().zip(&codes) {
            assert!((value - f32::from(*code) / most).abs() < 1e-6, "{what}");
        }
    }
}

#[test]
fn palettes_and_transparent_colours_become_colours_and_alpha() {
    use png::{BitDepth as D, ColorType as C};
    for depth in [D::One, D::Two, D::Four, D::Eight] {
        let entries = 1usize << depth as u32;
        let palette: Vec<u8> = (0..3 * entries).map(|i| (i * 37 % 256) as u8).collect();
        let alpha: Vec<u8> = (0..entries / 2).map(|i| (i * 91 % 256) as u8).collect();
        for alpha in [None, Some(alpha.as_slice())] {
            let (bytes, codes) = png_file(C::Indexed, depth, Some(&palette), alpha);
            let (_dir, path) = file("a.png", &bytes);
            let (header, pixels) = read(&format!("{depth:?}"), &path, 1e-6, 1e-6);
            let channels = if alpha.is_some() { 4 } else { 3 };
            assert_eq!(header.channels.len(), channels);
            for (pixel, code) in pixels.chunks_exact(channels).zip(codes) {
                let code = usize::from(code);
                let opacity = alpha.and_then(|a| a.get(code)).copied().unwrap_or(255);
                let color = palette[3 * code..3 * code + 3].iter().copied();
                for (value, expected) in pixel.iter().zip(color.chain([opacity])) {
                    assert!((value - f32::from(expected) / 255.0).abs() < 1e-6);
                }
            }
        }
    }
    let (bytes, codes) = png_file(C::Grayscale, D::Four, None, Some(&[0, 7]));
    let (_dir, path) = file("a.png", &bytes);
    let (_, pixels) = read("a grey that is clear", &path, 1e-6, 1e-6);
    for (pixel, code) in pixels.chunks_exact(2).zip(codes) {
        assert_eq!(pixel[1], if code == 7 { 0.0 } else { 1.0 });
    }
}

/// First column and row of each pass of Adam7, and the steps from there.
const PASSES: [[u32; 4]; 7] = [
    [0, 0, 8, 8],
    [4, 0, 8, 8],
    [0, 4, 4, 8],
    [2, 0, 4, 4],
    [0, 2, 2, 4],
    [1, 0, 2, 2],
    [0, 1, 1, 2],
];

#[test]
fn an_interlaced_png_is_the_same_as_a_plain_one() {
    let (plain, codes) = png_file(png::ColorType::Rgb, png::BitDepth::Eight, None, None);
    let mut zlib = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::fast());
    for [x0, y0, dx, dy] in PASSES {
        for y in (y0..HEIGHT).step_by(dy as usize) {
            zlib.write_all(&[0]).unwrap();
            for x in (x0..WIDTH).step_by(dx as usize) {
                let at = 3 * (y * WIDTH + x) as usize;
                let pixel: Vec<u8> = codes[at..at + 3].iter().map(|&c| c as u8).collect();
                zlib.write_all(&pixel).unwrap();
            }
        }
    }
    let mut info = png::Info::with_size(WIDTH, HEIGHT);
    (info.color_type, info.bit_depth) = (png::ColorType::Rgb, png::BitDepth::Eight);
    info.interlaced = true;
    let mut bytes = Vec::new();
    let encoder = png::Encoder::with_info(&mut bytes, info).unwrap();
    let mut writer = encoder.write_header().unwrap();
    writer
        .write_chunk(png::chunk::IDAT, &zlib.finish().unwrap())
        .unwrap();
    drop(writer);
    let (_dir, path) = file("a.png", &bytes);
    let (_dir, other) = file("b.png", &plain);
    let whole = read("interlaced", &path, 1e-6, 1e-6);
    assert_eq!(whole.1, ours(&other).unwrap().1);
}

/// A ramp in each channel, with an edge across.
fn ramp(channels: usize) -> Vec<u8> {
    let value = |i: u32, c: usize| {
        let (x, y) = (i % 64, i / 64);
        let edge = if x + y > 90 { 60 } else { 0 };
        [2 * x + edge, 3 * y, 190 - 2 * y, 60 + x + y][c] as u8
    };
    (0..64 * 48)
        .flat_map(|i| (0..channels).map(move |c| value(i, c)))
        .collect()
}

fn jpeg_file(color: Jpeg, channels: usize, sampling: SamplingFactor, progressive: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, 95);
    encoder.set_sampling_factor(sampling);
    encoder.set_progressive(progressive);
    encoder.encode(&ramp(channels), 64, 48, color).unwrap();
    bytes
}

/// Within two codes of OpenImageIO's (libjpeg's), whose cosine transform rounds elsewhere; where
/// colours have fewer pixels, within what the interpolation between them makes.
#[test]
fn a_jpeg_of_every_kind_has_the_numbers_that_went_in() {
    use SamplingFactor::{F_1_1, F_2_1, F_2_2};
    let code = 1.0 / 255.0;
    for (color, channels) in [
        (Jpeg::Luma, 1),
        (Jpeg::Rgb, 3),
        (Jpeg::Cmyk, 4),
        (Jpeg::CmykAsYcck, 4),
    ] {
        for sampling in [F_1_1, F_2_1, F_2_2] {
            for progressive in [false, true] {
                let what = format!("{color:?} {sampling:?} {progressive}");
                let (_dir, path) =
                    file("a.jpg", &jpeg_file(color, channels, sampling, progressive));
                if color == Jpeg::Cmyk && sampling != F_1_1 {
                    let why = ours(&path).unwrap_err();
                    assert!(why.contains("first component"), "{what}: {why}");
                    continue;
                }
                let coarse = channels > 1 && sampling != F_1_1;
                let (most, mean) = if coarse { (4.01, 0.7) } else { (2.01, 0.1) };
                let (header, pixels) = read(&what, &path, most * code, mean * code);
                let colors = if channels == 1 { 1 } else { 3 };
                assert_eq!(
                    (header.channels.len(), header.pixel_type),
                    (colors, PixelType::U8)
                );
                // The encoder inverts CMYK, and a colour is its ink times black.
                let wanted = ramp(channels);
                let wanted = wanted.chunks_exact(channels).flat_map(|p| {
                    let black = p.get(3).map_or(255, |k| 255 - k);
                    let of = |c: &u8| if channels == 4 { 255 - c } else { *c };
                    let ink = |c| f32::from(of(c)) * f32::from(black) / 255.0 / 255.0;
                    p[..colors].iter().map(ink).collect::<Vec<f32>>()
                });
                let errors = pixels.iter().zip(wanted).map(|(a, b)| (a - b).abs());
                let mean = errors.sum::<f32>() / pixels.len() as f32;
                assert!(mean < 3.0 * code, "{what}: {mean}");
            }
        }
    }
}

fn hdr_image(width: u32) -> Image {
    let mut rng = Pcg32::new(9, width.into());
    let mut image = Image::new(width, 9, &["R", "G", "B"]);
    for (i, pixel) in image.pixels.chunks_exact_mut(3).enumerate() {
        // Runs, and numbers of every size.
        let size = 10f32.powi(i as i32 / 40 % 70 - 35);
        pixel.fill(0.7 * size);
        if i % 60 > 40 {
            pixel.fill_with(|| rng.next_f32() * size);
        }
    }
    image
}

/// In rows that are too short or too long for runs, and in runs.
#[test]
fn radiance_files_keep_eight_bits_of_the_largest_channel() {
    for width in [1, 7, 8, 300, 33000] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.hdr");
        let image = hdr_image(width);
        let options = WriteOptions::default();
        write(&path, Format::Hdr, &image, PixelType::Float, &options).unwrap();
        // OpenImageIO's powers of two are rounded.
        let (_, pixels) = read(&format!("{width}"), &path, 2e-7, 2e-7);
        for (a, b) in pixels.chunks_exact(3).zip(image.pixels.chunks_exact(3)) {
            let largest = b.iter().copied().fold(0.0, f32::max);
            let most = if largest < 1e-32 {
                largest
            } else {
                largest / 128.0
            };
            let pairs = a.iter().zip(b);
            assert!(
                pairs.clone().all(|(a, b)| a <= b && b - a <= most),
                "{a:?} {b:?}"
            );
        }
        // What comes out goes in again without loss.
        let again = Image {
            pixels: pixels.clone(),
            ..image
        };
        write(&path, Format::Hdr, &again, PixelType::Float, &options).unwrap();
        assert_eq!(ours(&path).unwrap().1, pixels);
        #[cfg(feature = "oiio")]
        {
            crate::image::write(&path, &again, &options).unwrap();
            assert_eq!(read("OpenImageIO's", &path, 2e-7, 2e-7).1, pixels);
        }
    }
}

#[test]
fn old_runs_of_radiance_files_repeat_the_pixel_before() {
    let mut bytes = b"#?RGBE\n# a comment\nEXPOSURE=2\n\n-Y 1 +X 300\n".to_vec();
    // One, 3 times; then another, 255 + 256 * 0 and 41 more times.
    bytes.extend([
        128, 0, 0, 129, 1, 1, 1, 2, 0, 64, 0, 129, 1, 1, 1, 40, 1, 1, 1, 1,
    ]);
    let (_dir, path) = file("a.hdr", &bytes);
    let (_, pixels) = ours(&path).unwrap();
    let expected = |x: usize| {
        if x < 3 {
            [1.0, 0.0, 0.0]
        } else {
            [0.0, 0.5, 0.0]
        }
    };
    for (x, pixel) in pixels.chunks_exact(3).enumerate() {
        assert_eq!(pixel, expected(x), "{x}");
    }
    bytes.extend([1, 1, 1, 9]);
    let wide = String::from_utf8_lossy(&bytes[..44]).replace("300", "301");
    let (_dir, path) = file("a.hdr", &[wide.as_bytes(), &bytes[44..]].concat());
    assert!(ours(&path).is_err(), "a run beyond the row");
}

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
        let mut input = Input::open(&named).unwrap();
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
    let mut input = Input::open(&named).unwrap();
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
        let why = Input::open(&path).unwrap_err();
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
        let why = Input::open(&path).unwrap_err();
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
