//! Writing PNG, JPEG and Radiance HDR. The curve has been applied before.

use super::super::{AttributeValue, Compression, Format, Image, PixelType, WriteOptions};
use super::radiance;
use jpeg_encoder::{ColorType, Encoder, SamplingFactor};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::Path;

/// Quality of JPEG unless it is given.
const QUALITY: u8 = 92;

/// Writes an image of 1, 3 or 4 channels. The error is the reason alone.
pub fn write(
    path: &Path,
    format: Format,
    image: &Image,
    stored: PixelType,
    options: &WriteOptions,
) -> Result<(), String> {
    let file = File::create(path).map_err(|e| e.to_string())?;
    let mut file = BufWriter::new(file);
    match format {
        Format::Png => png(&mut file, image, stored, options)?,
        Format::Jpeg => jpeg(&mut file, image, options)?,
        Format::Hdr => {
            let written = radiance::write(&mut file, image.width as usize, &image.pixels);
            written.map_err(|e| e.to_string())?;
        }
        Format::Exr | Format::Tiff => {
            return Err(
                "this build writes no TIFF: it was made without the feature `oiio`; take .exr"
                    .into(),
            );
        }
    }
    file.flush().map_err(|e| e.to_string())
}

/// 0 to 1 as a code of 0 to `most`; what is no number becomes 0.
fn code(x: f32, most: f32) -> f32 {
    (x.clamp(0.0, 1.0) * most).round()
}

fn eight_bits(image: &Image) -> Vec<u8> {
    image.pixels.iter().map(|&x| code(x, 255.0) as u8).collect()
}

fn png(
    file: &mut impl Write,
    image: &Image,
    stored: PixelType,
    options: &WriteOptions,
) -> Result<(), String> {
    let mut encoder = png::Encoder::new(file, image.width, image.height);
    encoder.set_color(match image.channels.len() {
        1 => png::ColorType::Grayscale,
        4 => png::ColorType::Rgba,
        _ => png::ColorType::Rgb,
    });
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    if options.compression == Compression::None {
        encoder.set_compression(png::Compression::NoCompression);
    }
    for attribute in &image.attributes {
        if let AttributeValue::Text(text) = &attribute.value {
            // A key that PNG cannot have (more than 79 bytes, not Latin) is left out.
            let _ = encoder.add_itxt_chunk(attribute.name.clone(), text.clone());
        }
    }
    let data = if stored == PixelType::U16 {
        encoder.set_depth(png::BitDepth::Sixteen);
        let codes = image.pixels.iter().map(|&x| code(x, 65535.0) as u16);
        codes.flat_map(u16::to_be_bytes).collect()
    } else {
        encoder.set_depth(png::BitDepth::Eight);
        eight_bits(image)
    };
    encoder
        .write_header()
        .and_then(|mut writer| {
            writer.write_image_data(&data)?;
            writer.finish()
        })
        .map_err(|e| e.to_string())
}

fn jpeg(file: &mut impl Write, image: &Image, options: &WriteOptions) -> Result<(), String> {
    let side = |n: u32| {
        u16::try_from(n).map_err(|_| format!("JPEG has at most 65535 pixels a side, not {n}"))
    };
    let (width, height) = (side(image.width)?, side(image.height)?);
    let quality = match options.compression {
        Compression::Quality(quality) => quality.clamp(1, 100),
        _ => QUALITY,
    };
    let mut encoder = Encoder::new(file, quality);
    encoder.set_sampling_factor(SamplingFactor::F_2_2);
    let color = match image.channels.len() {
        1 => ColorType::Luma,
        _ => ColorType::Rgb,
    };
    let encoded = encoder.encode(&eight_bits(image), width, height, color);
    encoded.map_err(|e| e.to_string())
}
