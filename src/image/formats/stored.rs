//! The numbers of an image as a file stores them.

use super::super::PixelType;
use super::super::header::Level;

/// Size of an image and how its numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Size in pixels.
    pub level: Level,
    /// Channels: 1 to 4.
    pub channels: usize,
    /// Type of the numbers.
    pub pixel_type: PixelType,
}

impl Shape {
    /// Numbers of the whole image.
    ///
    /// # Errors
    /// When memory has no place for them.
    pub fn numbers(&self) -> Result<usize, String> {
        (self.level.width as usize)
            .checked_mul(self.level.height as usize)
            .and_then(|n| n.checked_mul(self.channels))
            .ok_or_else(|| "the image is too large".into())
    }
}

/// All numbers of an image, interleaved, rows from the top.
#[derive(Debug)]
pub enum Stored {
    /// 0 to 255.
    U8(Vec<u8>),
    /// 0 to 65535.
    U16(Vec<u16>),
    /// As they are.
    Float(Vec<f32>),
}

impl Stored {
    /// A number, integers as 0 to 1.
    pub fn value(&self, at: usize) -> f32 {
        match self {
            Self::U8(codes) => f32::from(codes[at]) / 255.0,
            Self::U16(codes) => f32::from(codes[at]) / 65535.0,
            Self::Float(values) => values[at],
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::U8(codes) => codes.len(),
            Self::U16(codes) => codes.len(),
            Self::Float(values) => values.len(),
        }
    }
}
