//! Files compressed by gzip, unpacked in memory and no farther than is allowed.

use crate::image::decoded::DecodeLimit;
use crate::image::mapped::{self, Mapped};
use flate2::bufread::MultiGzDecoder;
use std::borrow::Cow;
use std::io::Read;
use std::ops::Deref;
use std::path::Path;

/// How a file begins that gzip made.
const MAGIC: [u8; 2] = [0x1f, 0x8b];

/// The bytes of a file, unpacked where it was packed.
#[derive(Debug)]
pub(super) enum Bytes {
    /// As they lie on disk.
    Mapped(Mapped),
    /// Unpacked.
    Unpacked(Vec<u8>),
}

impl Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Mapped(bytes) => bytes,
            Self::Unpacked(bytes) => bytes,
        }
    }
}

/// Whether a file's name says that it is packed.
pub(super) fn is_packed(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("gz"))
}

/// The name without its `.gz`.
pub(super) fn unpacked_name(path: &Path) -> Cow<'_, Path> {
    match is_packed(path) {
        true => Cow::Owned(path.with_extension("")),
        false => Cow::Borrowed(path),
    }
}

/// Reads a file, which is unpacked if its name ends with `.gz` and it is packed.
///
/// # Errors
/// When it cannot be read, is no gzip all through, or unpacks to more than `limit` allows.
pub(super) fn open(path: &Path, limit: DecodeLimit) -> Result<Bytes, String> {
    let bytes = mapped::open(path).map_err(|e| format!("cannot be read: {e}"))?;
    if !is_packed(path) || !bytes.starts_with(&MAGIC) {
        return Ok(Bytes::Mapped(bytes));
    }
    let packed = bytes.len() as u64;
    let most = limit.most(packed);
    let mut unpacked = Vec::new();
    let mut reader = MultiGzDecoder::new(&*bytes).take(most.saturating_add(1));
    reader
        .read_to_end(&mut unpacked)
        .map_err(|e| format!("cannot be unpacked: {e}"))?;
    limit.check("it, unpacked,", unpacked.len() as u64, packed)?;
    Ok(Bytes::Unpacked(unpacked))
}

#[cfg(test)]
mod tests {
    use super::*;
    use flate2::Compression;
    use flate2::write::GzEncoder;
    use std::io::Write;

    fn packed(text: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn files_are_unpacked_and_bombs_are_not() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.pbrt.gz");
        let limit = DecodeLimit { bytes: 1 << 16 };
        std::fs::write(&path, packed(b"Identity")).unwrap();
        assert_eq!(&*open(&path, limit).unwrap(), b"Identity");
        assert_eq!(unpacked_name(&path), dir.path().join("a.pbrt"));
        std::fs::write(&path, packed(&vec![b' '; 10 << 20])).unwrap();
        let refused = open(&path, limit).unwrap_err();
        assert!(refused.contains("--limit-decoded"), "{refused}");
        let cut = packed(&b"Identity ".repeat(100));
        std::fs::write(&path, &cut[..cut.len() / 2]).unwrap();
        assert!(open(&path, limit).unwrap_err().contains("unpacked"));
        std::fs::write(&path, b"Identity").unwrap();
        assert_eq!(&*open(&path, limit).unwrap(), b"Identity");
    }
}
