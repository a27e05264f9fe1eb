//! How numbers and pixels are stored in a file that is written.

use super::{PixelType, ViewTransform};

/// How the pixels of a file are packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compression {
    /// What suits the format: ZIP for EXR and TIFF, quality 92 for JPEG.
    #[default]
    Default,
    /// Not at all, where the format can.
    None,
    /// Deflate, lossless (EXR, TIFF).
    Zip,
    /// Wavelets, lossless, good on noisy half floats (EXR).
    Piz,
    /// Cosine transform, lossy, for previews (EXR).
    Dwaa,
    /// JPEG with this quality, 1 to 100.
    Quality(u8),
}

/// How to write.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct WriteOptions {
    /// How numbers are stored; `None` takes what suits the format (EXR half, TIFF float, PNG 8
    /// bits). Formats without the type take their own.
    pub pixel_type: Option<PixelType>,
    /// How pixels are packed.
    pub compression: Compression,
    /// Tiles of 64 x 64 instead of scan lines, where the format can.
    pub tiled: bool,
    /// PNG and JPEG show the picture times 2 to this power.
    pub exposure: f32,
    /// How they show it.
    pub view: ViewTransform,
}
