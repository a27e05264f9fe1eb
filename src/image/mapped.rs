//! A file as a slice of memory, without a copy: a mesh of gigabytes is read once, by all threads.
//!
//! It stands here, with the images, because this is the room for code that leaves Rust's
//! guarantees.

use std::ops::Deref;
use std::path::Path;

/// The bytes of a file.
#[derive(Debug)]
pub enum Mapped {
    /// Mapped into memory.
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
///
/// # Errors
/// When it cannot be opened or is no regular file.
pub fn open(path: &Path) -> std::io::Result<Mapped> {
    let file = super::regular::open(path)?;
    if file.metadata()?.len() == 0 {
        return Ok(Mapped::Empty);
    }
    // SAFETY: the map is read only and lives no longer than the load. Bytes that another program
    // changes meanwhile are as good as any other bytes to the readers, which trust none; only a
    // file cut short during the load would end the process (SIGBUS), as with every mapped file.
    let map = unsafe { memmap2::Mmap::map(&file) }?;
    Ok(Mapped::Map(map))
}
