//! What every reader of image files does, whichever library is behind it.

use super::PixelType;
use super::header::Header;
use std::fmt::Debug;
use std::ops::Range;

/// An open image file. Errors are the reason alone.
pub trait ReadRows: Debug + Send {
    /// Goes to a part and mip level; false if there is none.
    fn seek(&mut self, part: u32, level: u32) -> Result<bool, String>;

    /// Size, channels and attributes of the current part.
    fn header(&self) -> Result<Header, String>;

    /// Reads rows (0 is the top) of some channels, interleaved, as numbers of that type; `data` is
    /// as large as they are.
    fn rows(
        &mut self,
        rows: Range<u32>,
        channels: Range<usize>,
        pixel_type: PixelType,
        data: &mut [u8],
    ) -> Result<(), String>;
}
