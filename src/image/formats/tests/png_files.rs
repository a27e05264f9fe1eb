//! PNG of every type of colour and depth.

use super::*;

/// A PNG of random bits, and the codes of its samples.
pub(super) fn png_file(
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
