//! Binary PLY, written in batches.

use super::Pattern;
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, Write};
use std::ops::Range;
use std::path::Path;

/// Rows that one thread makes at once.
const ROWS: u64 = 1 << 14;
/// Such pieces in a batch: with the rows above, at most 14 MiB.
const PIECES: u64 = 64;

/// Writes a pattern to the file `path`.
///
/// # Errors
/// When the file cannot be written.
pub fn write(pattern: &Pattern, path: &Path) -> io::Result<()> {
    let mut file = File::create(path)?;
    write!(
        file,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\n\
         property float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        pattern.vertices(),
        pattern.triangles()
    )?;
    rows(&mut file, pattern.vertices(), |rows, bytes| {
        for i in rows {
            let p = pattern.vertex(i).to_array();
            bytes.extend(p.iter().flat_map(|x| x.to_le_bytes()));
        }
    })?;
    rows(&mut file, pattern.triangles(), |rows, bytes| {
        for i in rows {
            bytes.push(3);
            let corners = pattern.triangle(i);
            bytes.extend(corners.iter().flat_map(|v| v.to_le_bytes()));
        }
    })
}

/// Writes `count` rows, which `make` appends.
fn rows(
    file: &mut File,
    count: u64,
    make: impl Fn(Range<u64>, &mut Vec<u8>) + Sync,
) -> io::Result<()> {
    let mut pieces: Vec<Vec<u8>> = vec![Vec::new(); PIECES as usize];
    for start in (0..count).step_by((ROWS * PIECES) as usize) {
        pieces.par_iter_mut().enumerate().for_each(|(n, bytes)| {
            bytes.clear();
            let from = (start + n as u64 * ROWS).min(count);
            make(from..(from + ROWS).min(count), bytes);
        });
        for bytes in &pieces {
            file.write_all(bytes)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::make::Kind;
    use crate::scene::import::mesh::{self, MeshKind, MeshOptions};

    #[test]
    fn what_is_written_is_read_again() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.ply");
        let pattern = Pattern::new(Kind::TorusKnot, 20_000);
        write(&pattern, &path).unwrap();
        let loaded = mesh::load(&path, MeshKind::Ply, &MeshOptions::default()).unwrap();
        assert_eq!(loaded.warnings, Vec::<String>::new());
        let triangles = &loaded.mesh.triangles;
        let count = pattern.vertices();
        assert_eq!(triangles.positions().len() as u64, count);
        assert!((0..count).all(|i| triangles.positions()[i as usize] == pattern.vertex(i)));
        let count = pattern.triangles();
        assert_eq!(triangles.triangles().len() as u64, count);
        assert!((0..count).all(|i| triangles.triangles()[i as usize] == pattern.triangle(i)));
    }
}
