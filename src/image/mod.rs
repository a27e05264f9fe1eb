//! Images: reading, writing and cached texture look-ups through Debian's OpenImageIO.

/// An image could not be read or written. Names the file and what the library said.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct ImageError {
    /// The file.
    pub path: String,
    /// What went wrong.
    pub reason: String,
}

/// An image in memory.
#[derive(Debug, Clone)]
pub struct Image {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// Names of the channels.
    pub channels: Vec<String>,
    /// Values, rows from the top, channels interleaved.
    pub pixels: Vec<f32>,
}

/// Reads an image.
pub fn read(path: &std::path::Path) -> Result<Image, ImageError> {
    let fail = |e: &dyn std::fmt::Display| ImageError {
        path: path.display().to_string(),
        reason: e.to_string(),
    };
    let image = exr::prelude::read_first_rgba_layer_from_file(
        path,
        |size, _| (size.0, vec![0f32; size.0 * size.1 * 3]),
        |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
            let i = (at.y() * *width + at.x()) * 3;
            pixels[i..i + 3].copy_from_slice(&[r, g, b]);
        },
    )
    .map_err(|e| fail(&e))?;
    let size = image.layer_data.size;
    Ok(Image {
        width: size.0,
        height: size.1,
        channels: ["R", "G", "B"].map(String::from).to_vec(),
        pixels: image.layer_data.channel_data.pixels.1,
    })
}
