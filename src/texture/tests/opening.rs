//! What the store opens, shares and refuses.

use super::*;
use std::sync::Arc;

#[test]
fn errors_name_the_file_and_what_it_has() {
    let dir = tempfile::tempdir().unwrap();
    let store = TextureStore::new(PLENTY);
    let e = store
        .open(settings(Path::new("textures/wood.exr")))
        .unwrap_err();
    assert!(e.to_string().starts_with("textures/wood.exr: "), "{e}");
    let path = noise(
        dir.path(),
        "a.exr",
        [4, 4],
        &["R", "G", "B"],
        PixelType::Half,
    );
    let s = BitmapSettings {
        channel: Some("roughness".into()),
        ..settings(&path)
    };
    let e = store.open(s).unwrap_err();
    assert!(
        e.reason.contains("roughness") && e.reason.contains("R, G, B"),
        "{e}"
    );
    // A file that came into being later is not looked for again within one render.
    assert!(
        store
            .open(settings(Path::new("textures/wood.exr")))
            .is_err()
    );
}

#[test]
fn the_same_file_is_opened_once_from_any_number_of_threads() {
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.exr",
        [300, 200],
        &["R", "G", "B"],
        PixelType::Half,
    );
    let store = TextureStore::new(PLENTY);
    let all: Vec<_> = std::thread::scope(|scope| {
        let run = || bitmap(store.open(settings(&path)).unwrap());
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(run)).collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    assert!(all.iter().all(|b| Arc::ptr_eq(b, &all[0])));
    let once = store.memory_bytes();
    let finest = 300 * 200 * 3 * 2;
    assert!(once > finest && once < finest * 7 / 5, "{once}");
    // Another placement shares the texels; another reading of them does not.
    let clamped = BitmapSettings {
        wrap_u: Wrap::Clamp,
        ..settings(&path)
    };
    assert!(!Arc::ptr_eq(&bitmap(store.open(clamped).unwrap()), &all[0]));
    assert_eq!(store.memory_bytes(), once);
    let green = BitmapSettings {
        channel: Some("g".into()),
        ..settings(&path)
    };
    let green = bitmap(store.open(green).unwrap());
    assert!(green.is_grey());
    assert_eq!(green.texel(7, 9).x, all[0].texel(7, 9).y);
    assert!(store.memory_bytes() > once);
}

#[test]
fn texels_that_are_no_colours_count_as_black() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    let mut image = Image::new(3, 2, &["R", "G", "B"]);
    image.pixels.fill(0.5);
    image.pixels[0] = f32::NAN;
    image.pixels[3] = f32::INFINITY;
    image.pixels[6] = -1.0;
    image.pixels[9] = 1e30;
    let options = WriteOptions {
        pixel_type: Some(PixelType::Float),
        ..Default::default()
    };
    write(&path, &image, &options).unwrap();
    for (raw, bad, third) in [(false, 3, 0.0), (true, 2, -1.0)] {
        let b = opened(BitmapSettings {
            raw,
            ..settings(&path)
        });
        assert_eq!(b.bad_texels(), bad);
        assert_eq!(b.texel(0, 0), Rgb::new(0.0, 0.5, 0.5));
        assert_eq!(b.texel(1, 0).x, 0.0);
        assert_eq!(b.texel(2, 0).x, third);
        assert_eq!(b.texel(0, 1).x, 1e30);
        assert!(b.mean().is_finite());
    }
}

#[test]
fn channels_are_found_by_letter_and_alpha_has_no_curve() {
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.png",
        [8, 8],
        &["R", "G", "B", "A"],
        PixelType::U8,
    );
    let image = crate::image::read(&path).unwrap();
    let one = |channel: &str| {
        let s = BitmapSettings {
            raw: false,
            channel: Some(channel.into()),
            ..settings(&path)
        };
        opened(s).texel(5, 3).x
    };
    let pixel = image.pixel(5, 3);
    assert!((one("a") - pixel[3]).abs() < 1e-6);
    let green = crate::image::curve::srgb_to_linear(pixel[1]);
    assert!((one("g") - green).abs() < 1e-6);
    assert!((one("G") - green).abs() < 1e-6);
}
