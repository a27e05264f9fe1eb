//! JPEG of every kind.

use super::*;

/// A ramp in each channel, with an edge across.
pub(super) fn ramp(channels: usize) -> Vec<u8> {
    let value = |i: u32, c: usize| {
        let (x, y) = (i % 64, i / 64);
        let edge = if x + y > 90 { 60 } else { 0 };
        [2 * x + edge, 3 * y, 190 - 2 * y, 60 + x + y][c] as u8
    };
    (0..64 * 48)
        .flat_map(|i| (0..channels).map(move |c| value(i, c)))
        .collect()
}

pub(super) fn jpeg_file(
    color: Jpeg,
    channels: usize,
    sampling: SamplingFactor,
    progressive: bool,
) -> Vec<u8> {
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
