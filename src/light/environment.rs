//! Environment maps from files.

use super::area::sanitized;
use super::latlong::LatLong;
use crate::image::{Image, ImageError};
use crate::math::{Affine3A, Mat3, Rgb};
use std::f32::consts::PI;
use std::path::Path;

/// A map, if it is not black, and the number of channel values that were rejected.
pub(super) fn load(
    path: &Path,
    scale: f32,
    to_world: &Affine3A,
    gamma: Option<f32>,
) -> Result<(Option<LatLong>, usize), ImageError> {
    let image = crate::image::read(path)?;
    let error = |reason: String| ImageError {
        path: path.display().to_string(),
        reason,
    };
    let [width, height] = [image.width as usize, image.height as usize];
    if width == 0 || height < 2 {
        let reason = format!("an environment map needs at least two rows, not {width} x {height}");
        return Err(error(reason));
    }
    let channels = colour_channels(&image).ok_or_else(|| error("no channels".into()))?;
    let mut rejected = 0;
    let pixels: Vec<Rgb> = image
        .pixels
        .chunks_exact(image.channels.len())
        .map(|texel| {
            let value = Rgb::from(channels.map(|c| texel[c]));
            let value = gamma.map_or(value, |g| value.powf(g)) * scale;
            let clean = sanitized(value);
            rejected += clean
                .to_array()
                .iter()
                .zip(value.to_array())
                .filter(|(a, b)| **a != *b)
                .count();
            clean
        })
        .collect();
    if rejected > 0 {
        tracing::warn!(
            "{}: {rejected} values are negative, infinite or not numbers; they count as 0",
            path.display()
        );
    }
    let map = LatLong::new([width, height], pixels, PI, Mat3::from(to_world.matrix3));
    Ok((map, rejected))
}

/// Positions of red, green and blue; of the first channel three times in an image without colour.
fn colour_channels(image: &Image) -> Option<[usize; 3]> {
    let find = |name: &str| {
        image
            .channels
            .iter()
            .position(|c| c.name.eq_ignore_ascii_case(name))
    };
    match (find("r"), find("g"), find("b")) {
        (Some(r), Some(g), Some(b)) => Some([r, g, b]),
        _ if image.channels.len() >= 3 => Some([0, 1, 2]),
        _ if image.channels.is_empty() => None,
        _ => Some([0; 3]),
    }
}
