//! Writing images, whole or not at all.

#[cfg(feature = "oiio")]
use super::Compression;
use super::{
    Attribute, Format, Image, ImageError, PixelType, WriteOptions, atomic, color_channels,
};
use crate::math::Rgb;
use std::path::Path;

/// Writes an image. The format follows from the name: EXR, HDR and TIFF keep linear numbers, PNG
/// and JPEG get exposure and the sRGB curve. Formats with few channels get the colours (`R`, `G`,
/// `B`, for PNG also `A`, or the first channels).
///
/// The file appears whole under its name, or the old one stays and the error says why.
pub fn write(path: &Path, image: &Image, options: &WriteOptions) -> Result<(), ImageError> {
    write_parts(path, &[(image, "")], options)
}

/// Writes several images into one EXR or TIFF file as named parts.
pub fn write_parts(
    path: &Path,
    parts: &[(&Image, &str)],
    options: &WriteOptions,
) -> Result<(), ImageError> {
    let format = Format::of(path)?;
    let prepared = parts
        .iter()
        .map(|(image, name)| prepare(image, name, format, options))
        .collect::<Result<Vec<Image>, String>>()
        .map_err(|why| ImageError::new(path, why))?;
    for (image, (original, _)) in prepared.iter().zip(parts) {
        let expected = image.width as usize * image.height as usize * original.channels.len();
        if expected == 0 || expected != original.pixels.len() {
            return Err(ImageError::new(
                path,
                format!(
                    "{} numbers do not make {} x {} pixels of {} channels",
                    original.pixels.len(),
                    image.width,
                    image.height,
                    original.channels.len()
                ),
            ));
        }
    }
    atomic::replace(path, |file| encode(file, format, &prepared, options))
}

/// How each channel of `image` is stored.
fn types(image: &Image, format: Format, options: &WriteOptions) -> Vec<PixelType> {
    let asked = options.pixel_type;
    let whole = match (format, asked) {
        (Format::Jpeg, _) => PixelType::U8,
        (Format::Png, Some(PixelType::U16)) => PixelType::U16,
        (Format::Png, _) => PixelType::U8,
        (Format::Hdr, _) => PixelType::Float,
        (Format::Exr, Some(PixelType::Float)) => PixelType::Float,
        (Format::Exr, _) => PixelType::Half,
        (Format::Tiff, asked) => asked.unwrap_or_default(),
    };
    image
        .channels
        .iter()
        .map(|c| match (format, c.pixel_type) {
            (Format::Exr, Some(t @ (PixelType::Half | PixelType::Float))) => t,
            _ => whole,
        })
        .collect()
}

/// The channels that the format takes, with its curve.
fn prepare(
    image: &Image,
    name: &str,
    format: Format,
    options: &WriteOptions,
) -> Result<Image, String> {
    let mut attributes = image.attributes.clone();
    // Names of mattes are of use beside the mattes alone, and may be many.
    attributes.retain(|a| format == Format::Exr || !a.name.starts_with("cryptomatte/"));
    if !name.is_empty() {
        attributes.push(Attribute::text("oiio:subimagename", name));
    }
    let keep = kept_channels(image, format);
    let n = image.channels.len();
    let half_limit = f32::from(half::f16::MAX);
    let chosen = |c: &usize| image.channels[*c].clone();
    let mut out = Image {
        width: image.width,
        height: image.height,
        window: image.window.filter(|_| format == Format::Exr),
        channels: keep.iter().map(chosen).collect(),
        pixels: Vec::new(),
        attributes,
    };
    let stored = types(&out, format, options);
    // Non-finite numbers are left alone: hiding them would hide a bug. Finite ones stay finite.
    let convert = |stored: PixelType, x: f32| match stored {
        PixelType::Half if x.is_finite() => x.clamp(-half_limit, half_limit),
        _ => x,
    };
    out.pixels = image
        .pixels
        .chunks_exact(n.max(1))
        .flat_map(|p| keep.iter().enumerate().map(|(i, &c)| (i, p[c])))
        .map(|(i, x)| convert(stored[i], x))
        .collect();
    if format.is_display() {
        show(&mut out, options)?;
    }
    Ok(out)
}

/// Turns linear light into what is shown of it: of the first three channels, or the only one.
/// Where there is alpha, that of what covers the pixel is shown: PNG keeps colours that are not
/// multiplied by alpha, and a curve bends those that are.
fn show(image: &mut Image, options: &WriteOptions) -> Result<(), String> {
    let gain = options.exposure.exp2();
    let alpha = image.channel("A").filter(|alpha| *alpha >= 3);
    let channels = image.channels.len().max(1);
    let colors = if channels < 3 { 1 } else { 3 };
    let light = |pixel: &[f32]| {
        let light = match colors {
            1 => Rgb::splat(pixel[0]),
            _ => Rgb::new(pixel[0], pixel[1], pixel[2]),
        };
        let light = match alpha.map(|alpha| pixel[alpha].clamp(0.0, 1.0)) {
            // What covers nothing has no colour.
            Some(0.0) => light * 0.0,
            Some(alpha) => light / alpha,
            None => light,
        };
        (light * gain).to_array()
    };
    for row in image
        .pixels
        .chunks_mut(channels * image.width.max(1) as usize)
    {
        let mut shown: Vec<[f32; 3]> = row.chunks_exact(channels).map(light).collect();
        options.view.apply(&mut shown)?;
        for (pixel, shown) in row.chunks_exact_mut(channels).zip(shown) {
            pixel[..colors].copy_from_slice(&shown[..colors]);
        }
    }
    Ok(())
}

/// Which channels a format takes.
fn kept_channels(image: &Image, format: Format) -> Vec<usize> {
    let names = image.channel_names();
    let n = names.len();
    match format {
        Format::Exr | Format::Tiff => (0..n).collect(),
        Format::Png | Format::Jpeg if n < 3 && format != Format::Hdr => (0..n.min(1)).collect(),
        Format::Hdr | Format::Png | Format::Jpeg => {
            let mut keep = if n == 0 {
                Vec::new()
            } else {
                color_channels(&names).to_vec()
            };
            keep.extend(image.channel("A").filter(|_| format == Format::Png));
            keep
        }
    }
}

#[cfg(feature = "oiio")]
fn encode(
    file: &Path,
    format: Format,
    images: &[Image],
    options: &WriteOptions,
) -> Result<(), String> {
    use super::oiio::output::{ImagePart, write};
    let compression = match (options.compression, format) {
        (Compression::Quality(q), _) => format!("jpeg:{}", q.clamp(1, 100)),
        (_, Format::Jpeg) => "jpeg:92".into(),
        (Compression::None, _) => "none".into(),
        (Compression::Piz, Format::Exr) => "piz".into(),
        (Compression::Dwaa, Format::Exr) => "dwaa".into(),
        _ => "zip".into(),
    };
    let tile = match (options.tiled, format) {
        (true, Format::Exr | Format::Tiff) => 64,
        _ => 0,
    };
    let space = if format.is_display() {
        "sRGB"
    } else {
        "Linear"
    };
    let parts: Vec<ImagePart> = images
        .iter()
        .map(|image| {
            let mut attributes = image.attributes.clone();
            attributes.push(Attribute::text("compression", compression.clone()));
            attributes.push(Attribute::text("oiio:ColorSpace", space));
            // Colours of all formats but PNG are multiplied by alpha, as they are in memory.
            let unassociated = i32::from(format != Format::Tiff);
            attributes.push(Attribute::int("oiio:UnassociatedAlpha", unassociated));
            ImagePart {
                image,
                types: types(image, format, options),
                tile,
                attributes,
            }
        })
        .collect();
    write(file, format.name(), &parts)
}

#[cfg(not(feature = "oiio"))]
fn encode(
    file: &Path,
    format: Format,
    images: &[Image],
    options: &WriteOptions,
) -> Result<(), String> {
    let parts: Vec<_> = images
        .iter()
        .map(|i| (i, types(i, format, options)))
        .collect();
    match (format, &parts[..]) {
        (Format::Exr, _) => super::openexr::write(file, &parts, options),
        (_, [(image, stored)]) => {
            let stored = stored.first().copied().unwrap_or_default();
            super::formats::write(file, format, image, stored, options)
        }
        _ => Err("only EXR and TIFF files hold several images".into()),
    }
}
