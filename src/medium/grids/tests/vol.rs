//! Files: what is written comes back, and nothing hostile is taken.

use crate::math::{Affine3A, Pcg32, Vec3};
use crate::medium::grids::vol::{Vol, VolProblem};
use crate::medium::grids::{Grid, GridError, Lookup};
use std::path::Path;

/// What Mitsuba 3.9.1 writes for a grid of 2 x 1 x 1 voxels, 1 and 8.
const MITSUBA: [u8; 56] = [
    0x56, 0x4f, 0x4c, 0x03, 0x01, 0, 0, 0, 0x02, 0, 0, 0, 0x01, 0, 0, 0, 0x01, 0, 0, 0, 0x01, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0x80, 0x3f, 0, 0, 0x80, 0x3f, 0,
    0, 0x80, 0x3f, 0, 0, 0, 0x41,
];

fn example(channels: u32) -> Vol {
    let mut rng = Pcg32::new(1, u64::from(channels));
    Vol {
        resolution: [4, 3, 2],
        channels,
        bbox: [Vec3::new(1.0, -2.0, 3.0), Vec3::new(3.0, 2.0, 8.0)],
        values: (0..24 * channels).map(|_| rng.next_f32()).collect(),
    }
}

/// The bytes of [`example`] with some of them replaced.
fn patched(at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = example(1).bytes().unwrap();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    file
}

fn problem(bytes: &[u8]) -> String {
    Vol::parse(bytes).unwrap_err().to_string()
}

#[test]
fn what_is_written_is_read() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.vol");
    for channels in [1, 3, 6] {
        let vol = example(channels);
        vol.write(&path).unwrap();
        assert_eq!(Vol::read(&path).unwrap(), vol);
    }
}

#[test]
fn bytes_are_those_of_mitsuba() {
    let vol = Vol::parse(&MITSUBA).unwrap();
    assert_eq!(vol.resolution, [2, 1, 1]);
    assert_eq!(vol.values, [1.0, 8.0]);
    assert_eq!(vol.bbox, [Vec3::ZERO, Vec3::ONE]);
    assert_eq!(vol.bytes().unwrap(), MITSUBA);
}

#[test]
fn the_message_says_what_is_wrong() {
    let half = 1 << 16;
    let huge = [half, half, half].map(i32::to_le_bytes).concat();
    for (bytes, words) in [
        (Vec::new(), "does not begin with \"VOL\""),
        (patched(0, b"OVL"), "does not begin with \"VOL\""),
        (patched(3, &[2]), "version 2"),
        (
            patched(4, &2i32.to_le_bytes()),
            "type 2 is not read, only float32",
        ),
        (patched(8, &0i32.to_le_bytes()), "resolution of 0 x 3 x 2"),
        (patched(12, &i32::MIN.to_le_bytes()), "4 x -2147483648 x 2"),
        (patched(16, &i32::MAX.to_le_bytes()), "4 x 3 x 2147483647"),
        (patched(20, &2i32.to_le_bytes()), "2 channels"),
        (patched(20, &(-1i32).to_le_bytes()), "-1 channels"),
        (
            patched(20, &3i32.to_le_bytes()),
            "it has 144 bytes and needs 336",
        ),
        (
            patched(8, &huge),
            "it has 144 bytes and needs 1125899906842672",
        ),
        (
            patched(8, b"")[..143].to_vec(),
            "it has 143 bytes and needs 144",
        ),
        (b"VOL\x03".to_vec(), "it has 4 bytes and needs 48"),
        (
            patched(48 + 4 * 17, &f32::NAN.to_le_bytes()),
            "1 values are not finite, the first is NaN in channel 0 of voxel (1, 1, 1)",
        ),
        (
            patched(48 + 4 * 23, &(-0.5f32).to_le_bytes()),
            "1 values are negative, the first is -0.5 in channel 0 of voxel (3, 2, 1)",
        ),
    ] {
        let text = problem(&bytes);
        assert!(text.contains(words), "{text}: {words}");
    }
}

#[test]
fn bad_values_are_counted_by_kind() {
    let mut vol = example(3);
    vol.values[40] = f32::INFINITY;
    vol.values[41] = -1.0;
    vol.values[60] = f32::NAN;
    let text = problem(&vol.bytes().unwrap());
    assert!(text.starts_with("2 values are not finite, the first is inf"));
    assert!(text.contains("channel 1 of voxel (1, 0, 1)"), "{text}");
}

#[test]
fn no_beginning_of_a_file_is_taken_and_more_than_a_file_is() {
    let mut file = example(3).bytes().unwrap();
    for length in 0..file.len() {
        assert!(Vol::parse(&file[..length]).is_err(), "{length}");
    }
    file.extend([1, 2, 3]);
    assert_eq!(Vol::parse(&file).unwrap(), example(3));
}

#[test]
fn random_headers_never_panic() {
    let mut rng = Pcg32::new(2, 0);
    for _ in 0..100_000 {
        let at = 3 + rng.next_u32() as usize % 90;
        let file = patched(at, &rng.next_u32().to_le_bytes());
        if let Ok(vol) = Vol::parse(&file) {
            let lookup = Lookup::default();
            let place = vol.bbox_transform().unwrap_or(Affine3A::IDENTITY);
            let _ = Grid::from_vol(vol, place, lookup);
        }
    }
}

#[test]
fn files_that_are_none_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let text = |path: &Path| Vol::read(path).unwrap_err().to_string();
    assert!(text(dir.path()).contains("not a regular file"));
    assert!(text(Path::new("/dev/zero")).contains("not a regular file"));
    let missing = dir.path().join("none.vol");
    assert!(text(&missing).contains("none.vol"));
}

#[test]
fn what_would_not_come_back_is_not_written() {
    let mut vol = example(1);
    vol.values.pop();
    let error = vol.bytes().unwrap_err();
    assert!(matches!(error, VolProblem::Count { has: 23, needs: 24 }));
    vol.bbox[1].y = vol.bbox[0].y;
    assert!(vol.bbox_transform().is_err());
}

#[test]
fn grids_refuse_what_is_no_density() {
    let lookup = Lookup::default();
    let of = |vol: Vol, place| Grid::from_vol(vol, place, lookup).unwrap_err();
    let identity = Affine3A::IDENTITY;
    assert_eq!(of(example(6), identity), GridError::Channels(6));
    let flat = Affine3A::from_scale(Vec3::new(1.0, 0.0, 1.0));
    for place in [flat, Affine3A::NAN, Affine3A::from_scale(Vec3::MAX * 2.0)] {
        assert_eq!(of(example(1), place), GridError::Transform);
    }
    let mut vol = example(1);
    vol.values[3] = -1.0;
    assert!(matches!(of(vol, identity), GridError::Values(_)));
    let mut vol = example(1);
    vol.resolution[0] = 5;
    let error = of(vol, identity);
    assert_eq!(error, GridError::Count { has: 24, needs: 30 });
}
