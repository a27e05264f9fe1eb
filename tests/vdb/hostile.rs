//! Damaged files: each is an error, or a grid that keeps its promises.

#[path = "../fuzz/mutate.rs"]
mod mutate;

use super::{Files, read};
use mutate::{Reproduce, mutated};
use std::path::Path;
use std::time::Instant;
use twintree::math::Pcg32;

/// Seconds that a file of some kilobytes may take; without damage it is 0.05.
const MOST_SECONDS: f64 = 40.0;
/// Changed copies of each file.
const ROUNDS: u64 = 60;

/// Reads these bytes as a file; whether they are a grid.
fn is_grid(folder: &Files, bytes: &[u8]) -> bool {
    let path = folder.0.path().join("damaged.vdb");
    std::fs::write(&path, bytes).unwrap();
    let begin = Instant::now();
    let found = read(&path, None);
    assert!(begin.elapsed().as_secs_f64() < MOST_SECONDS);
    match found {
        Ok(vdb) => {
            let count = vdb.resolution.iter().product::<u32>() * vdb.channels;
            assert_eq!(vdb.values.len(), count as usize);
            assert!(vdb.values.iter().all(|v| v.is_finite() && *v >= 0.0));
            true
        }
        Err(error) => {
            assert!(error.contains("damaged.vdb: "), "{error}");
            assert!(error.len() > 40 && error.len() < 8000, "{error}");
            false
        }
    }
}

#[test]
fn no_beginning_of_a_file_is_taken() {
    let files = Files::new();
    for kind in ["float", "half", "vec3d"] {
        let whole = std::fs::read(files.write(kind)).unwrap();
        let end = whole.len();
        for length in (0..end).step_by(397).chain(end - 25..end) {
            assert!(
                !is_grid(&files, &whole[..length]),
                "{kind}: {length} of {end}"
            );
        }
    }
}

#[test]
fn damaged_files_are_errors_or_grids() {
    let files = Files::new();
    for (stream, kind) in ["float", "half", "vec3d", "several"]
        .into_iter()
        .enumerate()
    {
        let whole = std::fs::read(files.write(kind)).unwrap();
        let mut rng = Pcg32::new(7, stream as u64);
        let mut accepted = 0;
        for round in 0..ROUNDS {
            let input = mutated(&whole, &mut rng);
            let guard = Reproduce::new("vdb", Path::new(kind), round, &input);
            accepted += u32::from(is_grid(&files, &input));
            guard.survived();
        }
        println!("{kind}: {accepted} of {ROUNDS} accepted");
        assert!(
            kind == "several" || accepted > 0,
            "only the first check was tested"
        );
    }
}
