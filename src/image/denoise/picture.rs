//! A picture with its layers, denoised.
//!
//! The picture's own channels become the denoised ones, for all that read nothing else; the noisy
//! ones are kept in the layer `noisy`. A picture that has such a layer was denoised before, and is
//! denoised from there.

use super::{DenoiseError, Denoiser, Noisy, Progress};
use crate::image::{Attribute, Channel, Image, color_channels};

/// Channels of the layer that keeps the noisy picture.
pub const NOISY: [&str; 3] = ["noisy.R", "noisy.G", "noisy.B"];
const ALBEDO: [&str; 3] = ["albedo.R", "albedo.G", "albedo.B"];
const NORMAL: [&str; 3] = ["normal.X", "normal.Y", "normal.Z"];
/// The attribute that tells what has denoised a picture.
const ATTRIBUTE: &str = "twintree:denoised";

/// What a picture brings for its denoising.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// It has no colours.
    Nothing,
    /// Colours alone.
    Color,
    /// The layers `albedo` and `normal`, too.
    Features,
}

/// What a picture brings for its denoising.
pub fn known(image: &Image) -> Known {
    let has = |names| layer(image, names).is_some();
    match (image.channels.len() >= 3, has(ALBEDO) && has(NORMAL)) {
        (false, _) => Known::Nothing,
        (true, false) => Known::Color,
        (true, true) => Known::Features,
    }
}

/// The picture, denoised with the layers `albedo` and `normal` if it has both. All its layers are
/// kept, and `noisy` is among them.
///
/// # Errors
/// When the picture has no colours, `progress` ends it, or memory runs out.
pub fn denoised(
    denoiser: &Denoiser,
    image: &Image,
    progress: Progress,
) -> Result<Image, DenoiseError> {
    let known = known(image);
    if known == Known::Nothing {
        return Err(DenoiseError::Failed("the picture has no colours".into()));
    }
    let picture = color_channels(&image.channel_names());
    let before = layer(image, NOISY);
    let color = numbers(image, before.unwrap_or(picture));
    let features = [ALBEDO, NORMAL].map(|names| layer(image, names).map(|l| numbers(image, l)));
    let [albedo, normal] = &features;
    let noisy = Noisy {
        width: image.width as usize,
        height: image.height as usize,
        color: &color,
        features: albedo.as_deref().zip(normal.as_deref()).map(<[_; 2]>::from),
    };
    let clean = denoiser.denoise(&noisy, progress)?;
    let mut result = match before {
        Some(_) => image.clone(),
        None => with_noisy(image, &color, picture),
    };
    let n = result.channels.len();
    let pixels = result.pixels.chunks_exact_mut(n);
    for (pixel, clean) in pixels.zip(clean.chunks_exact(3)) {
        for (&channel, &value) in picture.iter().zip(clean) {
            pixel[channel] = value;
        }
    }
    let by = format!("Open Image Denoise {}", denoiser.version());
    result.attributes.retain(|a| a.name != ATTRIBUTE);
    result.attributes.push(Attribute::text(ATTRIBUTE, by));
    Ok(result)
}

/// The channels of those names, if all are there.
fn layer(image: &Image, names: [&str; 3]) -> Option<[usize; 3]> {
    let [a, b, c] = names.map(|name| image.channel(name));
    Some([a?, b?, c?])
}

/// Three channels.
fn numbers(image: &Image, channels: [usize; 3]) -> Vec<f32> {
    let pixels = image.pixels.chunks_exact(image.channels.len());
    pixels
        .flat_map(|pixel| channels.map(|c| pixel[c]))
        .collect()
}

/// The image with one more layer behind all others, which is stored as the picture's `channels`
/// are.
fn with_noisy(image: &Image, color: &[f32], channels: [usize; 3]) -> Image {
    let mut result = Image {
        channels: image.channels.clone(),
        pixels: Vec::with_capacity(image.pixels.len() + color.len()),
        attributes: image.attributes.clone(),
        ..*image
    };
    for (name, like) in NOISY.iter().zip(channels) {
        result.channels.push(Channel {
            name: (*name).to_owned(),
            pixel_type: image.channels[like].pixel_type,
        });
    }
    let pixels = image.pixels.chunks_exact(image.channels.len());
    for (pixel, color) in pixels.zip(color.chunks_exact(3)) {
        result.pixels.extend_from_slice(pixel);
        result.pixels.extend_from_slice(color);
    }
    result
}
