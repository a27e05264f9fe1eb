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

use super::header::Header;
use super::{PixelType, openexr, promise};
use std::io::Read;
use std::ops::Range;
use std::path::Path;

/// What this build reads, in words.
pub const READ: &str = "EXR, PNG, JPEG and Radiance HDR";

/// An image file, decoded whole when its first rows are asked for.
#[derive(Debug)]
pub enum Input {
    /// EXR: several parts.
    Exr(openexr::Input),
    /// Everything else: one image.
    Flat(flat::Input),
}

impl Input {
    /// Opens a file. The error is the reason alone.
    pub fn open(path: &Path) -> Result<Self, String> {
        let mut head = Vec::with_capacity(unread::HEAD);
        let file = super::regular::open(path).map_err(|e| e.to_string())?;
        file.take(unread::HEAD as u64)
            .read_to_end(&mut head)
            .map_err(|e| e.to_string())?;
        if head.starts_with(&promise::EXR_MAGIC) {
            return openexr::Input::open(path).map(Self::Exr);
        }
        match flat::Format::of(&head) {
            Some(format) => flat::Input::open(path, format).map(Self::Flat),
            None => Err(unread::reason(&head)),
        }
    }

    /// Goes to a part; mip levels beyond the first are not read.
    pub fn seek(&mut self, part: u32, level: u32) -> Result<bool, String> {
        match self {
            Self::Exr(input) => input.seek(part, level),
            Self::Flat(_) => Ok(part == 0 && level == 0),
        }
    }

    /// Size and channels of the current part.
    pub fn header(&self) -> Result<Header, String> {
        match self {
            Self::Exr(input) => input.header(),
            Self::Flat(input) => Ok(input.header().clone()),
        }
    }

    /// Reads rows of some channels as numbers of that type.
    pub fn rows(
        &mut self,
        rows: Range<u32>,
        channels: Range<usize>,
        pixel_type: PixelType,
        data: &mut [u8],
    ) -> Result<(), String> {
        match self {
            Self::Exr(input) => input.rows(rows, channels, pixel_type, data),
            Self::Flat(input) => input.rows(rows, channels, pixel_type, data),
        }
    }
}
