//! PNG by the `png` crate.
//!
//! Palettes become colours, fewer than 8 bits become 8, a colour that counts as transparent becomes
//! alpha, and alpha is not multiplied in: as OpenImageIO has them. What the chunks gAMA, sRGB and
//! iCCP say of the curve changes no number, there as here.

use super::super::PixelType;
use super::super::header::Level;
use super::stored::{Shape, Stored};
use png::{BitDepth, Decoder, Limits, Reader, Transformations};
use std::fs::File;
use std::io::BufReader;

/// Bytes that the decoder may take for itself: rows, and the chunks beside the pixels.
const MOST_BYTES: usize = 256 << 20;

fn reader(file: &mut BufReader<File>) -> Result<Reader<&mut BufReader<File>>, String> {
    let mut decoder = Decoder::new_with_limits(file, Limits { bytes: MOST_BYTES });
    decoder.set_transformations(Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    decoder.read_info().map_err(|e| e.to_string())
}

fn shape_of<R: std::io::BufRead + std::io::Seek>(reader: &Reader<R>) -> Shape {
    let info = reader.info();
    let (color, depth) = reader.output_color_type();
    Shape {
        level: Level {
            width: info.width,
            height: info.height,
        },
        channels: color.samples(),
        pixel_type: match depth {
            BitDepth::Sixteen => PixelType::U16,
            _ => PixelType::U8,
        },
    }
}

/// Size and type of the image. The error is the reason alone.
pub fn shape(file: &mut BufReader<File>) -> Result<Shape, String> {
    Ok(shape_of(&reader(file)?))
}

/// Its numbers. The error is the reason alone.
pub fn decode(mut file: BufReader<File>, shape: Shape) -> Result<Stored, String> {
    let mut reader = reader(&mut file)?;
    if shape_of(&reader) != shape {
        return Err("it has changed since it was opened".into());
    }
    let bytes = reader
        .output_buffer_size()
        .ok_or("the image is too large")?;
    let mut data = vec![0; bytes];
    reader.next_frame(&mut data).map_err(|e| e.to_string())?;
    Ok(match shape.pixel_type {
        PixelType::U8 => Stored::U8(data),
        _ => {
            let codes = data.chunks_exact(2);
            Stored::U16(codes.map(|c| u16::from_be_bytes([c[0], c[1]])).collect())
        }
    })
}
