//! Radiance RGBE, in old and new runs.

use super::*;

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
