//! JPEG by the `zune-jpeg` crate: grey, colours, and CMYK or YCCK as colours.
//!
//! CMYK is taken for inverted, as all programs that write it in JPEG do, and a colour is its ink
//! times black: OpenImageIO's way. The decoder is strict: a file that ends early is an error, where
//! others fill what is missing with grey.

use super::super::PixelType;
use super::super::header::Level;
use super::stored::Shape;
use std::fs::File;
use std::io::{BufReader, Read};
use zune_core::bytestream::{ZByteReaderTrait, ZCursor};
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;
use zune_jpeg::JpegDecoder;

/// The largest side that the format allows.
const MOST_PIXELS: usize = 65535;

fn decoder<R: ZByteReaderTrait>(file: R, out: ColorSpace) -> JpegDecoder<R> {
    let options = DecoderOptions::default()
        .set_strict_mode(true)
        .set_max_width(MOST_PIXELS)
        .set_max_height(MOST_PIXELS)
        .jpeg_set_out_colorspace(out);
    JpegDecoder::new_with_options(file, options)
}

/// Size and channels of the image. The error is the reason alone.
pub fn shape(file: &mut BufReader<File>) -> Result<Shape, String> {
    let mut decoder = decoder(file, ColorSpace::RGB);
    decoder.decode_headers().map_err(|e| e.to_string())?;
    let info = decoder.info().ok_or("it has no header")?;
    let channels = match info.components {
        1 => 1,
        3 | 4 => 3,
        n => return Err(format!("it has {n} components, and 1, 3 or 4 are known")),
    };
    Ok(Shape {
        level: Level {
            width: info.width.into(),
            height: info.height.into(),
        },
        channels,
        pixel_type: PixelType::U8,
    })
}

/// Markers: the start of a scan and the end of the image. Inside a scan neither occurs.
const SCAN: [u8; 2] = [0xff, 0xda];
const END: [u8; 2] = [0xff, 0xd9];

/// Whether the image ends: the decoder does not miss the end of the last rows.
fn has_end(bytes: &[u8]) -> bool {
    let scan = bytes.windows(2).rposition(|w| w == SCAN).unwrap_or(0);
    bytes[scan..].windows(2).any(|w| w == END)
}

/// Numbers in a block of the minimum coded unit, across and down, of each component: the frame
/// header's sampling factors (ITU-T T.81, B.2.2). Empty where there is no frame header.
fn samplings(bytes: &[u8]) -> Vec<[u8; 2]> {
    let mut at = 2;
    while let Some(&[0xff, marker, high, low]) = bytes.get(at..at + 4) {
        if matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            // Length, precision, height, width and number of components come before.
            let count = bytes.get(at + 9).map_or(0, |&n| usize::from(n));
            let components = bytes.get(at + 10..at + 10 + 3 * count).unwrap_or(&[]);
            let factors = components.chunks_exact(3).map(|c| [c[1] >> 4, c[1] & 15]);
            return factors.collect();
        }
        at += 2 + usize::from(u16::from_be_bytes([high, low]));
    }
    Vec::new()
}

/// Its numbers. The error is the reason alone.
pub fn decode(mut file: BufReader<File>, shape: Shape) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes).map_err(|e| e.to_string())?;
    if !has_end(&bytes) {
        return Err("the file ends before the image".into());
    }
    let samplings = samplings(&bytes);
    let coarse = |c: &[u8; 2], of: &[u8; 2]| c[0] < of[0] || c[1] < of[1];
    if samplings.iter().any(|of| coarse(&samplings[0], of)) {
        // The decoder would make black of it.
        return Err(
            "its first component has fewer numbers than another, which only builds with OpenImageIO (the feature `oiio`) read".into(),
        );
    }
    let out = match shape.channels {
        1 => ColorSpace::Luma,
        _ => ColorSpace::RGB,
    };
    let mut decoder = decoder(ZCursor::new(bytes), out);
    decoder.decode().map_err(|e| e.to_string())
}
