//! Files that lie, files that end early, places that cannot be written: errors in words, and no
//! file but the old one.

use super::*;

fn file(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (dir, path)
}

#[test]
fn what_is_no_image_is_an_error_that_names_it() {
    let missing = PathBuf::from("no-such-dir/no-such.exr");
    let e = read(&missing).unwrap_err();
    assert!(
        e.path.ends_with("no-such.exr") && e.reason.contains("No such file"),
        "{e}"
    );
    let dir = tempfile::tempdir().unwrap();
    assert!(
        read(dir.path())
            .unwrap_err()
            .reason
            .contains("not a regular file")
    );
    for name in ["a.exr", "a.png", "a.hdr", "a.tif", "a.jpg", "a"] {
        for bytes in [&b""[..], b"hello", &[0; 4000], &[0xff; 4000]] {
            let (_dir, path) = file(name, bytes);
            let e = read(&path).unwrap_err();
            assert!(e.path.ends_with(name) && !e.reason.is_empty(), "{e}");
        }
    }
}

/// A file cut anywhere is an error or an image, never a crash.
#[test]
fn cut_and_damaged_files_do_no_harm() {
    let dir = tempfile::tempdir().unwrap();
    let image = noise(64, 48, &["R", "G", "B"], 0.0, 1.0);
    let names: &[&str] = if cfg!(feature = "oiio") {
        &["a.exr", "a.png", "a.hdr", "a.tif", "a.jpg"]
    } else {
        &["a.exr", "a.png", "a.hdr", "a.jpg"]
    };
    let mut rng = Pcg32::new(1, 1);
    for name in names {
        let path = dir.path().join(name);
        write(&path, &image, &WriteOptions::default()).unwrap();
        let whole = std::fs::read(&path).unwrap();
        for i in 0..60 {
            let mut bytes = whole.clone();
            if i % 2 == 0 {
                bytes.truncate(whole.len() * i / 60);
            } else {
                for _ in 0..8 {
                    let reach = if i % 4 == 1 { 400 } else { whole.len() };
                    let at = rng.next_u32() as usize % reach.min(whole.len());
                    bytes[at] = rng.next_u32() as u8;
                }
            }
            std::fs::write(&path, &bytes).unwrap();
            if let Ok(back) = read(&path) {
                let n = back.width as usize * back.height as usize * back.channels.len();
                assert_eq!(back.pixels.len(), n);
            }
        }
    }
}

/// A header of a few bytes must not allocate what it promises.
#[test]
fn a_header_that_promises_too_much_is_refused_at_once() {
    let before = std::time::Instant::now();
    let header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n";
    let (_dir, hdr) = file("a.hdr", header);
    let e = read(&hdr).unwrap_err();
    assert!(e.reason.contains("60000 x 60000"), "{e}");
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(&path, &Image::new(16, 16, &["R"]), &WriteOptions::default()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    // dataWindow and displayWindow: four little-endian integers after name, type and size.
    for name in [&b"dataWindow\0box2i\0"[..], b"displayWindow\0box2i\0"] {
        let at = bytes.windows(name.len()).position(|w| w == name).unwrap() + name.len() + 4;
        bytes[at + 8..at + 12].copy_from_slice(&59_999i32.to_le_bytes());
        bytes[at + 12..at + 16].copy_from_slice(&59_999i32.to_le_bytes());
    }
    std::fs::write(&path, &bytes).unwrap();
    assert!(read(&path).is_err());
    assert!(before.elapsed().as_secs() < 5);
}

/// libpng takes the memory that a text's length promises before it reads of it.
#[test]
fn a_text_that_promises_too_much_is_refused_before_memory_is_taken() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.png");
    let image = noise(8, 8, &["R", "G", "B"], 0.0, 1.0);
    write(&path, &image, &WriteOptions::default()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let ahead = whole.windows(4).position(|w| w == b"IDAT").unwrap() - 4;
    for size in [whole.len() as u32 + 100, i32::MAX as u32] {
        let mut bytes = whole.clone();
        let chunk = [&size.to_be_bytes()[..], b"tEXtAuthor\0nobody"].concat();
        bytes.splice(ahead..ahead, chunk);
        std::fs::write(&path, &bytes).unwrap();
        let e = read(&path).unwrap_err();
        assert!(e.reason.contains(&format!("promises {size} bytes")), "{e}");
    }
}

#[test]
fn a_failed_write_leaves_the_old_file_and_no_other() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.exr");
    write(
        &path,
        &noise(8, 8, &["R"], 0.0, 1.0),
        &WriteOptions::default(),
    )
    .unwrap();
    let old = std::fs::read(&path).unwrap();
    let mut broken = noise(8, 8, &["R"], 0.0, 1.0);
    broken.pixels.pop();
    let e = write(&path, &broken, &WriteOptions::default()).unwrap_err();
    assert!(e.reason.contains("63 numbers"), "{e}");
    let empty = Image::new(0, 8, &["R"]);
    assert!(write(&path, &empty, &WriteOptions::default()).is_err());
    // Two channels of one name: the encoder's own error.
    let double = noise(8, 8, &["R", "R"], 0.0, 1.0);
    if let Err(e) = write(&path, &double, &WriteOptions::default()) {
        assert!(e.reason.contains("cannot be written"), "{e}");
        assert_eq!(std::fs::read(&path).unwrap(), old);
    }
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
}

#[cfg(not(feature = "oiio"))]
#[test]
fn other_formats_say_what_is_missing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.tif");
    let e = write(&path, &Image::new(2, 2, &["R"]), &WriteOptions::default()).unwrap_err();
    assert!(e.reason.contains("feature `oiio`"), "{e}");
    std::fs::write(&path, b"II*\0").unwrap();
    assert!(read(&path).unwrap_err().reason.contains("feature `oiio`"));
}
