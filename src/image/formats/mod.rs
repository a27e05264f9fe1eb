//! Images by Rust crates alone, for builds without OpenImageIO: EXR, PNG, JPEG and Radiance HDR.
//!
//! Which of them a file is follows from its first bytes, not from its name. The numbers are those
//! that OpenImageIO reads, and the tests compare the two; so are the names of channels and types.

mod flat;
mod jpeg_reader;
mod output;
mod png_reader;
mod radiance;
mod stored;
#[cfg(test)]
mod tests;
mod unread;

pub use output::write;

use super::read_rows::ReadRows;
use super::{openexr, promise};
use std::io::Read;
use std::path::Path;

/// What this build reads, in words.
pub const READ: &str = "EXR, PNG, JPEG and Radiance HDR";

/// Opens a file, which is decoded whole when its first rows are asked for. The error is the reason
/// alone.
pub fn open(path: &Path) -> Result<Box<dyn ReadRows>, String> {
    let mut head = Vec::with_capacity(unread::HEAD);
    let file = super::regular::open(path).map_err(|e| e.to_string())?;
    file.take(unread::HEAD as u64)
        .read_to_end(&mut head)
        .map_err(|e| e.to_string())?;
    if head.starts_with(&promise::EXR_MAGIC) {
        return openexr::open(path);
    }
    match flat::Format::of(&head) {
        Some(format) => flat::open(path, format),
        None => Err(unread::reason(&head)),
    }
}
