//! Environment maps from files.

use super::area::sanitized;
use super::latlong::LatLong;
use crate::image::ImageError;
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
    // An exponent given by the scene takes the place of the file's own curve.
    let image = match gamma {
        Some(_) => crate::image::read(path)?,
        None => crate::image::file::read_linear(path)?,
    };
    let [width, height] = [image.width, image.height];
    if width == 0 || height < 2 {
        return Err(ImageError {
            path: path.display().to_string(),
            reason: format!("an environment map needs at least two rows, not {width} x {height}"),
        });
    }
    let mut rejected = 0;
    let pixels: Vec<Rgb> = image
        .rgb()
        .into_iter()
        .map(|value| {
            let value = gamma.map_or(value, |g| value.powf(g)) * scale;
            let clean = sanitized(value);
            rejected += usize::from(clean.x != value.x)
                + usize::from(clean.y != value.y)
                + usize::from(clean.z != value.z);
            clean
        })
        .collect();
    if rejected > 0 {
        tracing::warn!(
            "{}: {rejected} values are negative, infinite or not numbers; they count as 0",
            path.display()
        );
    }
    let map = LatLong::new(
        [width as usize, height as usize],
        pixels,
        PI,
        Mat3::from(to_world.matrix3),
    );
    Ok((map, rejected))
}
