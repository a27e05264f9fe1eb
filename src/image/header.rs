//! What a file says about an image in it.

use super::{Attribute, Channel, PixelType};

/// Size of an image or of one of its mip levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level {
    /// Width in pixels, > 0.
    pub width: u32,
    /// Height in pixels, > 0.
    pub height: u32,
}

/// Where the pixels of a file lie in the picture that they are a part of (OpenEXR's data window in
/// its display window).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// Column and row of the picture at which the pixels begin; negative beyond its edges.
    pub at: [i32; 2],
    /// Size of the picture.
    pub whole: Level,
}

impl Window {
    /// The window, unless it is the same as the pixels' own.
    pub fn of(pixels: Level, at: [i32; 2], whole: Level) -> Option<Self> {
        let same = at == [0, 0] && whole == pixels;
        (!same && whole.width > 0 && whole.height > 0).then_some(Self { at, whole })
    }
}

/// What a file says about an image in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// Size.
    pub level: Level,
    /// Where that lies in the picture, if it is not all of it.
    pub window: Option<Window>,
    /// Channels, at least one.
    pub channels: Vec<Channel>,
    /// The widest of the channels' types. Types that are none of ours are read as
    /// [`PixelType::Float`].
    pub pixel_type: PixelType,
    /// Height of its tiles; 0 for scan lines.
    pub tile_height: u32,
    /// Metadata.
    pub attributes: Vec<Attribute>,
    /// The format's name, such as `openexr` or `png`.
    pub format: String,
}
