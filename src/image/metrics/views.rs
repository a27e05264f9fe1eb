//! Errors as pictures.

use super::Pair;
use crate::image::curve::srgb_to_linear;
use crate::math::{Rgb, luminance};

/// Where the image is too bright (red) and too dark (blue): the difference of the luminances over
/// sqrt(R^2 + 0.01), whose square is what relMSE adds up. Full colour is a difference of 1 and
/// more.
pub fn difference(pair: &Pair) -> Vec<Rgb> {
    let pixels = pair.image.iter().zip(&pair.reference);
    pixels
        .map(|(x, r)| {
            let (x, r) = (luminance(*x), luminance(*r));
            let d = (x - r) / r.hypot(0.1);
            let strength = d.abs().min(1.0);
            if d > 0.0 {
                Rgb::new(1.0, 0.15, 0.02) * strength
            } else {
                Rgb::new(0.02, 0.2, 1.0) * strength
            }
        })
        .collect()
}

/// FLIP's errors in the colours of its authors, from black over purple and orange to pale yellow
/// ("magma"), as linear light.
pub fn heat(map: &[f32]) -> Vec<Rgb> {
    map.iter()
        .map(|error| {
            let color = colorous::MAGMA.eval_continuous(f64::from(error.clamp(0.0, 1.0)));
            Rgb::from_array(
                color
                    .as_array()
                    .map(|c| srgb_to_linear(f32::from(c) / 255.0)),
            )
        })
        .collect()
}
