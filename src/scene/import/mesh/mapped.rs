//! The file as a slice of memory, without a copy: a mesh of gigabytes is read once, by all threads.

use super::ImportError;
use std::fs::File;
use std::ops::Deref;
use std::path::Path;

/// The bytes of a file.
pub(super) enum Mapped {
    Map(memmap2::Mmap),
    /// A file of no bytes cannot be mapped.
    Empty,
}

impl Deref for Mapped {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        match self {
            Self::Map(map) => map,
            Self::Empty => &[],
        }
    }
}

/// Maps the file `path`.
pub(super) fn open(path: &Path) -> Result<Mapped, ImportError> {
    let fail = |e: std::io::Error| ImportError {
        at: None,
        file: Some(path.to_owned()),
        message: format!("cannot be read: {e}"),
        help: None,
    };
    let file = File::open(path).map_err(fail)?;
    let meta = file.metadata().map_err(fail)?;
    if meta.is_dir() {
        return Err(fail(std::io::Error::other("it is a directory")));
    }
    if meta.len() == 0 {
        return Ok(Mapped::Empty);
    }
    // SAFETY: the map is read only and lives no longer than the load. Bytes that another program
    // changes meanwhile are as good as any other bytes to the readers, which trust none; only a file
    // cut short during the load would end the process (SIGBUS), as with every mapped file.
    let map = unsafe { memmap2::Mmap::map(&file) }.map_err(fail)?;
    Ok(Mapped::Map(map))
}
