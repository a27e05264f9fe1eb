//! Image files opened for reading.

use super::decoded::DecodeLimit;
#[cfg(not(feature = "oiio"))]
use super::formats::open;
use super::header::{Header, Level};
#[cfg(feature = "oiio")]
use super::oiio::input::open;
use super::read_rows::ReadRows;
use super::{Image, ImageError, PixelType, foreign, promise};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// An image file, open for reading.
#[derive(Debug)]
pub struct ImageFile {
    path: PathBuf,
    input: Box<dyn ReadRows>,
    header: Header,
}

impl ImageFile {
    /// Opens a file at its first part.
    pub fn open(path: &Path) -> Result<Self, ImageError> {
        let error = |reason: String| ImageError::new(path, reason);
        // The libraries open the file by its name: here it is seen to be one that has an end.
        let meta = super::regular::open(path)
            .and_then(|file| file.metadata())
            .map_err(|e| error(format!("the image cannot be opened: {e}")))?;
        if let Some(foreign) = foreign::by_path(path) {
            return Err(error(foreign.to_string()));
        }
        let unreadable = |why| error(format!("the image cannot be read: {why}"));
        promise::check(path, meta.len()).map_err(unreadable)?;
        let input = open(path).map_err(unreadable)?;
        let header = input.header().map_err(unreadable)?;
        numbers(&header, meta.len()).map_err(unreadable)?;
        Ok(Self {
            path: path.to_owned(),
            input,
            header,
        })
    }

    /// What the file says about its current part.
    pub fn header(&self) -> &Header {
        &self.header
    }

    /// Size of the file in bytes.
    pub fn file_bytes(&self) -> u64 {
        std::fs::metadata(&self.path).map_or(0, |m| m.len())
    }

    /// Holds what `decoded` bytes of memory are to be taken for against a limit.
    ///
    /// # Errors
    /// When that is more than the limit allows.
    pub fn check(&self, limit: DecodeLimit, decoded: u64) -> Result<(), ImageError> {
        let Level { width, height } = self.header.level;
        let what = format!("an image of {width} x {height} pixels");
        limit
            .check(&what, decoded, self.file_bytes())
            .map_err(|why| ImageError::new(&self.path, why))
    }

    /// Goes to a part (and mip level) of the file; false if there is none.
    pub fn seek(&mut self, part: u32, level: u32) -> Result<bool, ImageError> {
        let found = self
            .input
            .seek(part, level)
            .and_then(|found| {
                if found {
                    self.header = self.input.header()?;
                    let size = std::fs::metadata(&self.path).map_or(0, |m| m.len());
                    numbers(&self.header, size)?;
                }
                Ok(found)
            })
            .map_err(|e| ImageError::new(&self.path, format!("cannot be read: {e}")))?;
        Ok(found)
    }

    /// Reads rows (0 is the top) of some channels, interleaved, as `T`, which must be the Rust type
    /// of `pixel_type`. In a tiled file the range begins at a multiple of [`Header::tile_height`]
    /// and ends at one or at the last row.
    pub fn rows<T: bytemuck::Pod>(
        &mut self,
        rows: Range<u32>,
        channels: Range<usize>,
        pixel_type: PixelType,
        data: &mut [T],
    ) -> Result<(), ImageError> {
        self.input
            .rows(rows, channels, pixel_type, bytemuck::cast_slice_mut(data))
            .map_err(|e| ImageError::new(&self.path, format!("the image cannot be read: {e}")))
    }

    /// Height of the strips to read the image in: about `numbers` numbers each, cut where tiles
    /// are.
    pub fn strip_height(&self, numbers: usize) -> u32 {
        let row = self.header.level.width as usize * self.header.channels.len();
        let rows = (numbers / row.max(1)).clamp(1, 1 << 20) as u32;
        match self.header.tile_height {
            0 => rows,
            tile => rows.div_ceil(tile) * tile,
        }
    }

    /// The current part, numbers as stored in `f32`; integers become 0 to 1.
    pub(super) fn image(&mut self) -> Result<Image, ImageError> {
        let Header {
            level, channels, ..
        } = self.header.clone();
        let n = channels.len();
        let file_bytes = std::fs::metadata(&self.path).map_or(0, |m| m.len());
        let numbers =
            numbers(&self.header, file_bytes).map_err(|e| ImageError::new(&self.path, e))?;
        // Zeroed memory is not real memory until it is written: a file that is cut short costs
        // little.
        let mut pixels = vec![0.0f32; numbers];
        let row = level.width as usize * n;
        let strip = self.strip_height(1 << 22);
        for y0 in (0..level.height).step_by(strip as usize) {
            let y1 = (y0 + strip).min(level.height);
            let part = &mut pixels[y0 as usize * row..y1 as usize * row];
            self.rows(y0..y1, 0..n, PixelType::Float, part)?;
        }
        Ok(Image {
            width: level.width,
            height: level.height,
            window: self.header.window,
            channels,
            pixels,
            attributes: self.header.attributes.clone(),
        })
    }
}

/// Numbers in the whole image, once it is clear that a file of `file_bytes` can hold them.
fn numbers(header: &Header, file_bytes: u64) -> Result<usize, String> {
    let held = (file_bytes, header.format.as_str());
    promise::numbers(header.level, header.channels.len(), held)
}

/// Reads the first part of an image file: all its channels as stored, converted to `f32`.
///
/// Integers become 0 to 1 and keep their curve: an 8-bit sRGB picture is *not* made linear here
/// (see [`read_linear`]). Alpha is not multiplied in.
pub fn read(path: &Path) -> Result<Image, ImageError> {
    ImageFile::open(path)?.image()
}

/// Like [`read`], but the colours of 8- and 16-bit pictures are made linear by the sRGB curve.
pub fn read_linear(path: &Path) -> Result<Image, ImageError> {
    let mut file = ImageFile::open(path)?;
    let mut image = file.image()?;
    if matches!(file.header().pixel_type, PixelType::U8 | PixelType::U16) {
        let n = image.channels.len();
        let color: Vec<bool> = image.channels.iter().map(|c| c.name != "A").collect();
        for pixel in image.pixels.chunks_exact_mut(n) {
            for (value, _) in pixel.iter_mut().zip(&color).filter(|(_, c)| **c) {
                *value = super::curve::srgb_to_linear(*value);
            }
        }
    }
    Ok(image)
}
