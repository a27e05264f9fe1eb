//! Texels in memory, on disk and in OpenImageIO's cache.

use super::*;
use std::process::Command;

/// A store in which nothing can be resident.
fn no_memory() -> TextureStore {
    TextureStore::new(0)
}

fn places(count: usize) -> Vec<Vec2> {
    let mut rng = Pcg32::new(8, 8);
    let mut one = || rng.next_f32() * 3.0 - 1.0;
    (0..count).map(|_| Vec2::new(one(), one())).collect()
}

/// The same noise, tiled.
fn tiled(path: &Path, stored: PixelType) -> PathBuf {
    let image = crate::image::read(path).unwrap();
    let name = path.file_name().unwrap().to_str().unwrap();
    let to = path.with_file_name(format!("tiled-{name}"));
    let options = WriteOptions {
        pixel_type: Some(stored),
        tiled: true,
        ..Default::default()
    };
    write(&to, &image, &options).unwrap();
    to
}

#[test]
fn memory_disk_and_cache_give_the_same_numbers() {
    let dir = tempfile::tempdir().unwrap();
    for (name, stored, tolerance) in [
        ("8.tif", PixelType::U8, 0.0),
        ("16.tif", PixelType::U16, 3e-4),
        ("half.exr", PixelType::Half, 0.0),
        ("float.exr", PixelType::Float, 0.0),
    ] {
        for channels in [&["R", "G", "B"][..], &["Y"]] {
            let path = noise(dir.path(), name, [170, 83], channels, stored);
            let tiled = tiled(&path, stored);
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for filter in [Filter::Linear, Filter::Nearest] {
                    let s = |path: &Path| BitmapSettings {
                        raw: false,
                        filter,
                        wrap_u: wrap,
                        wrap_v: wrap,
                        ..settings(path)
                    };
                    let resident = opened(s(&path));
                    let spilled = bitmap(no_memory().open(s(&path)).unwrap());
                    let cached = bitmap(no_memory().open(s(&tiled)).unwrap());
                    assert!(resident.is_resident());
                    assert!(!cached.is_resident() && !spilled.is_resident());
                    for uv in places(300) {
                        let a = resident.eval_uv(uv, 0);
                        let error = (a - cached.eval_uv(uv, 0)).abs().max_element();
                        assert!(error <= tolerance, "{name} {wrap:?} {uv}: {error}");
                        for level in 0..resident.level_count() {
                            assert_eq!(resident.eval_uv(uv, level), spilled.eval_uv(uv, level));
                        }
                    }
                    assert_eq!(resident.mean(), spilled.mean());
                    let means = (resident.mean() - cached.mean()).abs().max_element();
                    assert!(means < 1e-5 + tolerance, "{means}");
                }
            }
        }
    }
}

/// OpenImageIO averages stored values, ours are averages of linear ones: for linear files they
/// agree.
#[test]
fn coarse_levels_of_linear_files_agree() {
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.exr",
        [128, 64],
        &["R", "G", "B"],
        PixelType::Float,
    );
    let resident = opened(settings(&path));
    let tiled = tiled(&path, PixelType::Float);
    let cached = bitmap(no_memory().open(settings(&tiled)).unwrap());
    assert_eq!(resident.level_count(), cached.level_count());
    for level in 0..resident.level_count() {
        for uv in places(200) {
            let (a, b) = (resident.eval_uv(uv, level), cached.eval_uv(uv, level));
            assert!((a - b).abs().max_element() < 2e-3, "{level} {uv}: {a} {b}");
        }
    }
}

/// OpenImageIO's own bilinear look-up of a linear file is a third opinion.
#[test]
fn openimageio_interpolates_to_the_same() {
    use crate::image::oiio::textures::{Lookup, TextureSystem};
    let dir = tempfile::tempdir().unwrap();
    let path = noise(
        dir.path(),
        "a.exr",
        [40, 30],
        &["R", "G", "B"],
        PixelType::Float,
    );
    let resident = opened(settings(&path));
    let system = TextureSystem::new(1 << 24).unwrap();
    let handle = system.open(&path).unwrap();
    for uv in places(2000) {
        let lookup = Lookup {
            st: uv.to_array(),
            dx: [0.0; 2],
            dy: [0.0; 2],
            first_channel: 0,
            wrap: [0; 2],
            nearest: false,
        };
        let mut theirs = [0f32; 3];
        assert!(system.lookup(handle, &lookup, &mut theirs));
        let ours = resident.eval_uv(uv, 0);
        let error = (ours - Rgb::from(theirs)).abs().max_element();
        assert!(error < 2e-5, "{uv}: {ours} {theirs:?}");
    }
}

#[test]
fn many_threads_share_a_small_cache() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("large.exr");
    // 48 MB of texels under a cap of 16.
    let (width, height) = (2048u32, 2048u32);
    let value = |x: u32, y: u32| [x as f32, y as f32, ((x ^ y) & 255) as f32];
    let mut image = Image::new(width, height, &["R", "G", "B"]);
    for (i, p) in image.pixels.chunks_exact_mut(3).enumerate() {
        p.copy_from_slice(&value(i as u32 % width, i as u32 / width));
    }
    let options = WriteOptions {
        pixel_type: Some(PixelType::Float),
        compression: crate::image::Compression::None,
        tiled: true,
        ..Default::default()
    };
    write(&path, &image, &options).unwrap();
    drop(image);
    let cap = 16 << 20;
    let store = TextureStore::new(4 * cap);
    let s = BitmapSettings {
        filter: Filter::Nearest,
        ..settings(&path)
    };
    let bitmap = bitmap(store.open(s).unwrap());
    assert!(!bitmap.is_resident());
    std::thread::scope(|scope| {
        for thread in 0..4u64 {
            let (bitmap, store) = (&bitmap, &store);
            scope.spawn(move || {
                let mut rng = Pcg32::new(thread, 1);
                for i in 0..4000 {
                    let (x, y) = (rng.next_u32() % width, rng.next_u32() % height);
                    assert_eq!(bitmap.texel(x, y), Rgb::from(value(x, y)));
                    // Tiles that a thread holds in its hands come on top of the cap.
                    if i % 500 == 0 {
                        assert!(store.memory_bytes() < cap + (4 << 20));
                    }
                }
            });
        }
    });
    assert!(store.memory_bytes() > 1 << 20);
}

/// Files made for paging are paged when they are large, and use their own levels.
#[test]
fn files_of_maketx_are_read_in_pieces() {
    let dir = tempfile::tempdir().unwrap();
    let plain = noise(
        dir.path(),
        "a.tif",
        [512, 512],
        &["R", "G", "B"],
        PixelType::U8,
    );
    let tx = dir.path().join("a.tx");
    let made = Command::new("maketx")
        .args([&plain, Path::new("-o"), &tx].map(|p| p.as_os_str()))
        .output();
    if !made.is_ok_and(|m| m.status.success()) {
        eprintln!("skipped: maketx is not installed (openimageio-tools)");
        return;
    }
    let finest = 512 * 512 * 3;
    let small = TextureStore::new(finest * 8);
    let paged = bitmap(small.open(settings(&tx)).unwrap());
    let plain = bitmap(small.open(settings(&plain)).unwrap());
    assert!(plain.is_resident() && !paged.is_resident());
    assert!(opened(settings(&tx)).is_resident());
    assert_eq!(paged.level_count(), 10);
    assert!((paged.mean() - plain.mean()).abs().max_element() < 5e-3);
    for uv in places(300) {
        assert_eq!(paged.eval_uv(uv, 0), plain.eval_uv(uv, 0), "{uv}");
        let coarse = (paged.eval_uv(uv, 3) - plain.eval_uv(uv, 3)).abs();
        assert!(coarse.max_element() < 0.1, "{uv} {coarse}");
    }
}
