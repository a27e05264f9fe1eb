//! Opening files that are read as a whole: regular files, and nothing else.
//!
//! A pipe may never end or never begin, and a device such as `/dev/zero` has no end: whoever reads
//! one waits or grows for ever. Every reader opens its files here.

use rustix::fs::OFlags;
use std::fs::{File, OpenOptions};
use std::io::{Error, ErrorKind, Read, Result};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::Path;

/// Opens a regular file for reading.
///
/// # Errors
/// When it cannot be opened, or is a directory, a pipe, a socket or a device.
pub fn open(path: &Path) -> Result<File> {
    // Opening a pipe waits for who writes into it, unless this flag says otherwise; it changes
    // nothing about regular files.
    let flags = OFlags::NONBLOCK.bits() as i32;
    let file = OpenOptions::new()
        .read(true)
        .custom_flags(flags)
        .open(path)?;
    let kind = file.metadata()?.file_type();
    let what = match kind {
        kind if kind.is_file() => return Ok(file),
        kind if kind.is_dir() => "a directory",
        kind if kind.is_fifo() => "a pipe",
        kind if kind.is_char_device() || kind.is_block_device() => "a device",
        kind if kind.is_socket() => "a socket",
        _ => "something else",
    };
    let message = format!("it is {what}, not a regular file");
    Err(Error::new(ErrorKind::InvalidInput, message))
}

/// The bytes of a regular file.
///
/// # Errors
/// As [`open`], or when reading fails.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    let mut file = open(path)?;
    let size = file.metadata().map_or(0, |m| m.len());
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or(0));
    file.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The text of a regular file.
///
/// # Errors
/// As [`read`], or when it is no UTF-8.
pub fn read_to_string(path: &Path) -> Result<String> {
    let wrong = |e: std::string::FromUtf8Error| Error::new(ErrorKind::InvalidData, e);
    String::from_utf8(read(path)?).map_err(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pipes_devices_and_directories_are_refused_at_once() {
        let dir = tempfile::tempdir().unwrap();
        let pipe = dir.path().join("pipe");
        let mode = rustix::fs::Mode::RUSR | rustix::fs::Mode::WUSR;
        rustix::fs::mkfifoat(rustix::fs::CWD, &pipe, mode).unwrap();
        for (path, word) in [
            (pipe.as_path(), "a pipe"),
            (Path::new("/dev/zero"), "a device"),
            (dir.path(), "a directory"),
        ] {
            for error in [read(path).unwrap_err(), open(path).unwrap_err()] {
                let text = error.to_string();
                assert!(
                    text.contains(word) && text.contains("not a regular"),
                    "{text}"
                );
            }
        }
    }

    #[test]
    fn files_and_links_to_files_are_read() {
        let dir = tempfile::tempdir().unwrap();
        let [file, link] = ["file", "link"].map(|n| dir.path().join(n));
        std::fs::write(&file, "here").unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        assert_eq!(read(&link).unwrap(), b"here");
        assert_eq!(read_to_string(&file).unwrap(), "here");
        std::fs::write(&file, [0xff]).unwrap();
        assert_eq!(
            read_to_string(&file).unwrap_err().kind(),
            ErrorKind::InvalidData
        );
        assert_eq!(
            read(&dir.path().join("absent")).unwrap_err().kind(),
            ErrorKind::NotFound
        );
    }
}
