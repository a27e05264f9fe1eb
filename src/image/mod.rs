//! Images: reading, writing and cached texture look-ups through Debian's OpenImageIO.
//!
//! [`read`] and [`write()`] move whole images of any channels as linear `f32`; [`file::ImageFile`]
//! reads rows in the file's own precision, for textures. The format of a file to be written follows
//! from its name. [`metrics`] says how far one image is from another, [`denoise`] takes noise away.
//! With the feature `oiio` off Rust crates read and write EXR, PNG, JPEG and Radiance HDR, and
//! nothing else is known.
//!
//! ```no_run
//! use std::path::Path;
//! use twintree::image::{Image, WriteOptions, read, write};
//! let picture = read(Path::new("in.exr"))?;
//! write(Path::new("out.png"), &picture, &WriteOptions { exposure: 1.0, ..Default::default() })?;
//! # Ok::<(), twintree::image::ImageError>(())
//! ```

pub mod atomic;
mod color_config;
pub mod curve;
pub mod decoded;
pub mod denoise;
#[cfg(any(feature = "oiio", feature = "openvdb"))]
pub mod embedded;
pub mod file;
pub mod foreign;
mod format;
#[cfg(any(test, not(feature = "oiio")))]
mod formats;
pub mod header;
mod loading;
pub mod mapped;
pub mod metrics;
#[cfg(feature = "oiio")]
pub mod oiio;
#[cfg(any(test, not(feature = "oiio")))]
mod openexr;
pub mod passing;
mod promise;
mod read_rows;
pub mod regular;
pub mod spill;
#[cfg(test)]
mod tests;
mod view_transform;
pub mod windows;
mod write;
mod write_options;

pub use color_config::DisplayView;
pub use file::{read, read_linear};
pub use format::Format;
pub use loading::{LibraryLoading, library_is_missing, load_library};
pub use view_transform::ViewTransform;
pub use write::write;
pub use write_options::{Compression, WriteOptions};

use std::path::Path;

/// An image could not be read or written. Names the file and what the library said.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {reason}")]
pub struct ImageError {
    /// The file.
    pub path: String,
    /// What went wrong.
    pub reason: String,
}

impl ImageError {
    /// An error about the file at `path`.
    pub fn new(path: &Path, reason: impl Into<String>) -> Self {
        Self {
            path: path.display().to_string(),
            reason: reason.into(),
        }
    }
}

/// How a number is stored in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PixelType {
    /// 8 bits, 0 to 1.
    U8,
    /// 16 bits, 0 to 1.
    U16,
    /// 16-bit float.
    Half,
    /// 32-bit float.
    #[default]
    Float,
}

/// The value of an attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue {
    /// Text.
    Text(String),
    /// A whole number.
    Int(i32),
    /// A number.
    Float(f32),
}

/// A named value that a file carries beside its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: AttributeValue,
}

impl Attribute {
    /// A text.
    pub fn text(name: &str, value: impl Into<String>) -> Self {
        Self {
            name: name.to_owned(),
            value: AttributeValue::Text(value.into()),
        }
    }

    /// A whole number.
    pub fn int(name: &str, value: i32) -> Self {
        Self {
            name: name.to_owned(),
            value: AttributeValue::Int(value),
        }
    }

    /// A number.
    pub fn float(name: &str, value: f32) -> Self {
        Self {
            name: name.to_owned(),
            value: AttributeValue::Float(value),
        }
    }
}

/// A channel of an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Channel {
    /// Its name, `R` or `normal.X`.
    pub name: String,
    /// How to store it in a float format instead of [`WriteOptions::pixel_type`], for channels that
    /// need more (sample counts, depth). Of an image that was read, how the file has it, if its
    /// channels differ in that.
    pub pixel_type: Option<PixelType>,
}

impl Channel {
    /// A channel stored like the others.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            pixel_type: None,
        }
    }
}

/// An image in memory: any number of named channels, interleaved, rows from the top.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Where they lie in the picture that they are a part of, if they are not all of it. EXR files
    /// say so; other formats do not.
    pub window: Option<header::Window>,
    /// Channels in the order of the numbers of a pixel.
    pub channels: Vec<Channel>,
    /// `width * height * channels` numbers.
    pub pixels: Vec<f32>,
    /// Metadata.
    pub attributes: Vec<Attribute>,
}

impl Image {
    /// A black image with the named channels.
    pub fn new(width: u32, height: u32, names: &[&str]) -> Self {
        Self {
            width,
            height,
            window: None,
            channels: names.iter().map(|&n| Channel::new(n)).collect(),
            pixels: vec![0.0; width as usize * height as usize * names.len()],
            attributes: Vec::new(),
        }
    }

    /// A colour image; `pixels` holds `width * height` triples.
    pub fn from_rgb(width: u32, height: u32, pixels: &[crate::math::Rgb]) -> Self {
        Self {
            pixels: bytemuck::cast_slice(pixels).to_vec(),
            ..Self::new(width, 0, &["R", "G", "B"])
        }
        .with_height(height)
    }

    fn with_height(mut self, height: u32) -> Self {
        self.height = height;
        self
    }

    /// Position of the channel of that name.
    pub fn channel(&self, name: &str) -> Option<usize> {
        self.channels.iter().position(|c| c.name == name)
    }

    /// The numbers of a pixel; empty outside.
    pub fn pixel(&self, x: u32, y: u32) -> &[f32] {
        let n = self.channels.len();
        let at = (y as usize * self.width as usize + x as usize) * n;
        if x >= self.width {
            return &[];
        }
        self.pixels.get(at..at + n).unwrap_or(&[])
    }

    /// The colours: `R`, `G`, `B` by name, or the first three channels, or the first as grey.
    pub fn rgb(&self) -> Vec<crate::math::Rgb> {
        let n = self.channels.len().max(1);
        let [r, g, b] = color_channels(&self.channel_names()).map(|c| c.min(n - 1));
        self.pixels
            .chunks_exact(n)
            .map(|p| crate::math::Rgb::new(p[r], p[g], p[b]))
            .collect()
    }

    /// Names of the channels.
    pub fn channel_names(&self) -> Vec<&str> {
        self.channels.iter().map(|c| c.name.as_str()).collect()
    }

    /// The attribute of that name.
    pub fn attribute(&self, name: &str) -> Option<&AttributeValue> {
        self.attributes
            .iter()
            .find(|a| a.name == name)
            .map(|a| &a.value)
    }
}

/// Which channels make a colour: `R`, `G`, `B` by name in either case; else the first three; else
/// the first for all three.
pub fn color_channels(names: &[&str]) -> [usize; 3] {
    let find = |want: &str| names.iter().position(|n| n.eq_ignore_ascii_case(want));
    if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
        return [r, g, b];
    }
    if names.len() >= 3 { [0, 1, 2] } else { [0; 3] }
}
