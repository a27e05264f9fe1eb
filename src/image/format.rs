//! Formats that images are written in.

use super::ImageError;
use std::path::Path;

/// A file format, from the name of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// OpenEXR: floats, any channels, tiles, parts.
    Exr,
    /// TIFF: any type, any channels.
    Tiff,
    /// Radiance RGBE: three channels with a shared exponent.
    Hdr,
    /// PNG, 8 or 16 bits with the sRGB curve.
    Png,
    /// JPEG, 8 bits with the sRGB curve.
    Jpeg,
}

impl Format {
    /// The format that a file's name asks for.
    pub fn of(path: &Path) -> Result<Self, ImageError> {
        let extension = path
            .extension()
            .map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("exr") => Ok(Self::Exr),
            Some("tif" | "tiff") => Ok(Self::Tiff),
            Some("hdr" | "rgbe" | "pic") => Ok(Self::Hdr),
            Some("png") => Ok(Self::Png),
            Some("jpg" | "jpeg") => Ok(Self::Jpeg),
            _ => Err(ImageError::new(
                path,
                "the name does not say which format to write: \
                 it should end in .exr, .hdr, .tif, .png or .jpg",
            )),
        }
    }

    /// Whether values are shown as they are: exposure, the sRGB curve and a limit at 1 apply.
    pub fn is_display(self) -> bool {
        matches!(self, Self::Png | Self::Jpeg)
    }

    /// OpenImageIO's name for it.
    #[cfg(feature = "oiio")]
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Exr => "openexr",
            Self::Tiff => "tiff",
            Self::Hdr => "hdr",
            Self::Png => "png",
            Self::Jpeg => "jpeg",
        }
    }
}
