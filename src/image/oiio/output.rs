//! Writing through OpenImageIO's `ImageOutput`.

use super::{Reason, c_path, c_text, ffi, type_number};
use crate::image::header::Window;
use crate::image::{Attribute, AttributeValue, Image, PixelType};
use std::ffi::{CString, c_char};
use std::path::Path;
use std::ptr;

/// One part of a file: pixels and how to store them.
pub struct ImagePart<'a> {
    /// Pixels and channel names.
    pub image: &'a Image,
    /// How to store each channel.
    pub types: Vec<PixelType>,
    /// Edge of square tiles; 0 for scan lines.
    pub tile: u32,
    /// Attributes, OpenImageIO's own among them.
    pub attributes: Vec<Attribute>,
}

/// The memory behind an [`ffi::RawPart`].
struct Held {
    _texts: Vec<CString>,
    names: Vec<*const c_char>,
    types: Vec<i32>,
    attributes: Vec<ffi::Attribute>,
}

impl Held {
    fn new(part: &ImagePart) -> Self {
        let mut texts = Vec::new();
        let mut hold = |s: &str| {
            texts.push(c_text(s));
            // The bytes stay where they are when the vector of strings grows.
            texts.last().map_or(ptr::null(), |t| t.as_ptr())
        };
        let names = part.image.channels.iter().map(|c| hold(&c.name)).collect();
        let attributes = part
            .attributes
            .iter()
            .map(|a| {
                let mut raw = ffi::Attribute {
                    name: hold(&a.name),
                    kind: ffi::TEXT,
                    integer: 0,
                    real: 0.0,
                    text: ptr::null(),
                };
                match &a.value {
                    AttributeValue::Text(t) => raw.text = hold(t),
                    AttributeValue::Int(i) => (raw.kind, raw.integer) = (ffi::INT, *i),
                    AttributeValue::Float(f) => (raw.kind, raw.real) = (ffi::REAL, *f),
                }
                raw
            })
            .collect();
        Self {
            names,
            attributes,
            types: part.types.iter().map(|&t| type_number(t)).collect(),
            _texts: texts,
        }
    }
}

/// Writes a file at `path`. The error is the reason alone.
pub fn write(path: &Path, format: &str, parts: &[ImagePart]) -> Result<(), String> {
    let int = |n: usize| i32::try_from(n).map_err(|_| "the image is too large".to_string());
    for part in parts {
        let image = part.image;
        let n = image.width as usize * image.height as usize * image.channels.len();
        if n == 0 || n != image.pixels.len() || part.types.len() != image.channels.len() {
            return Err(format!(
                "{} numbers do not make {} x {} pixels of {} channels",
                image.pixels.len(),
                image.width,
                image.height,
                image.channels.len()
            ));
        }
    }
    ffi::load()?;
    let (path, format) = (c_path(path)?, c_text(format));
    let held: Vec<Held> = parts.iter().map(Held::new).collect();
    let mut raw = Vec::with_capacity(parts.len());
    for (part, held) in parts.iter().zip(&held) {
        let Window { at, whole } = part.image.place().window;
        raw.push(ffi::RawPart {
            width: int(part.image.width as usize)?,
            height: int(part.image.height as usize)?,
            channels: int(part.image.channels.len())?,
            names: held.names.as_ptr(),
            types: held.types.as_ptr(),
            tile: int(part.tile as usize)?,
            attributes: held.attributes.as_ptr(),
            attribute_count: int(held.attributes.len())?,
            x: at[0],
            y: at[1],
            full_width: int(whole.width as usize)?,
            full_height: int(whole.height as usize)?,
            pixels: part.image.pixels.as_ptr(),
        });
    }
    let mut reason = Reason::new();
    // SAFETY: every pointer in `raw` belongs to `held` or `parts`, of the lengths checked above.
    let bad = unsafe {
        ffi::twt_output_write(
            path.as_ptr(),
            format.as_ptr(),
            raw.as_ptr(),
            int(raw.len())?,
            reason.pointer(),
            reason.len(),
        )
    };
    if bad != 0 {
        return Err(reason.text());
    }
    Ok(())
}
