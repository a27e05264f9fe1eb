//! KTX2 images of Basis Universal (`KHR_texture_basisu`), made PNG for the texture loader.
//!
//! The crate that decodes them takes what a file says for true. So the lengths in the header and in
//! the list of levels are held against the file and the picture first (KTX 2.0, section 3).

use crate::image::decoded::DecodeLimit;
use basisu::{DecodeFlags, Error, TargetFormat, Transcoder};
use std::path::Path;

/// The first bytes of a KTX2 file.
const MAGIC: &[u8] = b"\xabKTX 20\xbb\r\n\x1a\n";
/// Where the list of levels begins, and how long its entries are.
const LEVELS: usize = 80;
const LEVEL: usize = 24;
/// Bytes of an uncompressed texel.
const TEXEL: u64 = 4;

/// Whether the bytes are a KTX2 file.
pub(super) fn is(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// A number of 32 bits.
fn word(bytes: &[u8], at: usize) -> Option<u64> {
    let word = bytes.get(at..)?.first_chunk()?;
    Some(u32::from_le_bytes(*word).into())
}

/// A number of 64 bits.
fn long(bytes: &[u8], at: usize) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.get(at..)?.first_chunk()?))
}

/// Checks the header and the list of levels; returns the picture's size.
fn check(bytes: &[u8], limit: DecodeLimit) -> Result<(u32, u32), String> {
    let early = || "the file ends inside of its header".to_owned();
    let field = |at| word(bytes, at).ok_or_else(early);
    let [format, width, height, depth, layers, faces, levels] = [
        field(12)?,
        field(20)?,
        field(24)?,
        field(28)?,
        field(32)?,
        field(36)?,
        field(40)?.max(1),
    ];
    if format != 0 {
        return Err(format!(
            "its texels are in Vulkan's format {format}, and Basis Universal is read: `ktx extract` makes a PNG of it"
        ));
    }
    if width == 0 || height == 0 || depth > 0 || layers > 1 || faces != 1 || levels > 32 {
        return Err("it is no picture: it has several layers, faces or no height".into());
    }
    let texels = (width + 12) * (height + 12);
    limit.check(
        "the picture",
        texels.saturating_mul(TEXEL),
        bytes.len() as u64,
    )?;
    let inside = |offset: u64, length: u64| {
        let end = offset.checked_add(length);
        end.is_some_and(|end| end <= bytes.len() as u64)
    };
    let pair = |at: usize| Some((word(bytes, at)?, word(bytes, at + 4)?));
    let wide = |at: usize| Some((long(bytes, at)?, long(bytes, at + 8)?));
    let parts = [pair(48), pair(56), wide(64)];
    let mut sound = parts.iter().all(|p| p.is_some_and(|(o, l)| inside(o, l)));
    for level in 0..levels as usize {
        let at = LEVELS + LEVEL * level;
        let unpacked = long(bytes, at + 16).unwrap_or(u64::MAX);
        sound &= wide(at).is_some_and(|(o, l)| inside(o, l)) && unpacked <= texels * TEXEL;
    }
    match sound {
        true => Ok((width as u32, height as u32)),
        false => Err("its header names bytes that the file does not have".into()),
    }
}

/// What is said about a file that cannot be decoded.
fn reason(error: Error) -> String {
    let why = match error {
        Error::InvalidData | Error::Truncated => "damaged, or none of Basis Universal",
        _ => "of a kind of Basis Universal that is not read: `ktx extract` makes a PNG of it",
    };
    format!("it is {why}")
}

/// Writes the largest level of a KTX2 file as a PNG.
///
/// # Errors
/// Why the file cannot be read, or the PNG not be written.
pub(super) fn unpack(bytes: &[u8], limit: DecodeLimit, png: &Path) -> Result<(), String> {
    let (width, height) = check(bytes, limit)?;
    let texture = Transcoder::new(bytes).map_err(reason)?;
    let texels = texture.transcode(0, TargetFormat::Rgba32, DecodeFlags::NONE);
    let texels = texels.map_err(reason)?;
    let (color, data) = match texture.has_alpha() {
        true => (png::ColorType::Rgba, texels),
        false => {
            let opaque = texels.chunks_exact(4).flat_map(|t| [t[0], t[1], t[2]]);
            (png::ColorType::Rgb, opaque.collect())
        }
    };
    let write = || -> Result<(), Box<dyn std::error::Error>> {
        let file = std::io::BufWriter::new(std::fs::File::create(png)?);
        let mut encoder = png::Encoder::new(file, width, height);
        encoder.set_color(color);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fastest);
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        Ok(writer.finish()?)
    };
    write().map_err(|e| format!("it cannot be unpacked: {e}"))
}
