//! Plain numbers on disk instead of in memory, mapped: the system keeps in memory what is used and
//! drops it when memory runs short.
//!
//! The file has no name and is gone with the process. It lies in `$TMPDIR`, or in /var/tmp, since
//! /tmp is often memory itself.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

/// A file without a name: written from front to end, read through a map of what has been written.
#[derive(Debug)]
pub struct Spill {
    file: BufWriter<File>,
    map: Option<memmap2::Mmap>,
}

impl Spill {
    /// An empty file.
    pub fn new() -> io::Result<Self> {
        let large = Path::new("/var/tmp");
        let file = if std::env::var_os("TMPDIR").is_none() && large.is_dir() {
            tempfile::tempfile_in(large).or_else(|_| tempfile::tempfile())
        } else {
            tempfile::tempfile()
        }?;
        Ok(Self {
            file: BufWriter::with_capacity(1 << 18, file),
            map: None,
        })
    }

    /// Appends bytes. They can be read after [`Spill::map`]. A full disk is an error here and never
    /// a fault later, because the file has no holes.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.file.write_all(bytes)
    }

    /// Makes everything that has been written readable.
    pub fn map(&mut self) -> io::Result<()> {
        self.file.flush()?;
        self.map = None;
        // SAFETY: the file has no name, so that nobody else opens it, and this module only ever
        // makes it longer: the mapped bytes do not change.
        self.map = Some(unsafe { memmap2::Mmap::map(self.file.get_ref()) }?);
        Ok(())
    }

    /// What has been mapped; begins at a page.
    #[inline]
    pub fn bytes(&self) -> &[u8] {
        self.map.as_deref().unwrap_or(&[])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read_and_more_can_follow() {
        let mut spill = Spill::new().unwrap();
        assert!(spill.bytes().is_empty());
        let mut expected = Vec::new();
        for round in 0..3u8 {
            let part: Vec<u8> = (0..300_000u32).map(|i| (i % 251) as u8 ^ round).collect();
            spill.write(&part).unwrap();
            assert_eq!(spill.bytes(), expected);
            spill.map().unwrap();
            expected.extend(part);
            assert_eq!(spill.bytes(), expected);
        }
    }
}
