//! Programs and libraries that the program carries inside itself, as files that the system can load.

use rustix::fs::{MemfdFlags, memfd_create};
use std::fs::File;
use std::io::{self, Write};
use std::os::fd::AsRawFd;
use std::path::PathBuf;

/// A file in memory with that content, and a path to it that holds while the file is open. `name` is
/// what lists of open files show.
///
/// # Errors
/// When the system has no memory or no number left for it.
pub fn in_memory(name: &str, content: &[u8]) -> io::Result<(File, PathBuf)> {
    let mut file = File::from(memfd_create(name, MemfdFlags::CLOEXEC)?);
    file.write_all(content)?;
    let path = format!("/proc/self/fd/{}", file.as_raw_fd());
    Ok((file, path.into()))
}
