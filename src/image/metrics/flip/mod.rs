//! FLIP: the difference that an eye sees when two images alternate on a screen, 0 to 1 a pixel.
//!
//! Andersson et al. 2020, *FLIP: A Difference Evaluator for Alternating Images*, and for high
//! dynamic range Andersson et al. 2021, *Visualizing Errors in Rendered High Dynamic Range Images*.
//!
//! ```text
//!  linear RGB --> YCxCz --blur by what the eye resolves--> Lab --distance--> colour error  Ec
//!                   |                                                                       |
//!                   +--> Y --edges and points--> stronger or weaker? ------> feature error Ef
//!                                                              FLIP = Ec ^ (1 - Ef) <-------+
//! ```
//!
//! The screen is the authors' default: 0.7 m wide, 3840 pixels, seen from 0.7 m. High dynamic range
//! is shown at several exposures, and the largest difference counts. The numbers are those of the
//! authors' program (the tests compare).

mod color;
mod exposure;
mod features;
mod filter;

use super::Pair;
use crate::image::curve::srgb_to_linear;
use crate::math::Rgb;
use color::Distance;
use rayon::prelude::*;

pub use exposure::Exposures;

/// Pixels in a degree of the field of view: 3840 pixels of 0.7 m seen from 0.7 m.
const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

/// FLIP of a pair as shown (sRGB values in 0..1, [`Pair::shown`]): the error of each pixel.
pub fn ldr(pair: &Pair) -> Vec<f32> {
    let linear = |list: &[Rgb]| -> Vec<Rgb> {
        let value = |x: f32| srgb_to_linear(x.clamp(0.0, 1.0));
        list.iter().map(|c| c.map(value)).collect()
    };
    between(
        pair.width(),
        &linear(&pair.reference),
        &linear(&pair.image),
        &Distance::new(),
    )
}

/// FLIP of a pair of linear light: the largest error of each pixel over the exposures that the
/// reference asks for ([`Exposures::of`]).
pub fn hdr(pair: &Pair) -> Vec<f32> {
    let distance = Distance::new();
    let mut worst = vec![0.0f32; pair.image.len()];
    for exposure in Exposures::of(&pair.reference).list() {
        let [reference, image] =
            [&pair.reference, &pair.image].map(|list| exposure::tone_mapped(list, exposure));
        let map = between(pair.width(), &reference, &image, &distance);
        for (worst, error) in worst.iter_mut().zip(map) {
            *worst = worst.max(error);
        }
    }
    worst
}

/// The mean of an error map: the number that stands for it.
pub fn mean(map: &[f32]) -> f64 {
    map.iter().map(|x| f64::from(*x)).sum::<f64>() / map.len() as f64
}

/// The errors between two images of linear light in 0..1.
fn between(width: usize, reference: &[Rgb], image: &[Rgb], distance: &Distance) -> Vec<f32> {
    let seen = [reference, image].map(|list| Seen::of(width, list));
    let [a, b] = &seen;
    (0..reference.len())
        .into_par_iter()
        .map(|i| {
            let color = distance.between(a.colors[i], b.colors[i]);
            let feature = features::difference(a.features[i], b.features[i]);
            color.powf(1.0 - feature)
        })
        .collect()
}

/// An image as the eye has it.
struct Seen {
    /// Hunt-adjusted Lab of what the eye resolves.
    colors: Vec<Rgb>,
    /// Strength of edges and points.
    features: Vec<[f32; 2]>,
}

impl Seen {
    fn of(width: usize, linear: &[Rgb]) -> Self {
        let opponent: Vec<Rgb> = linear.par_iter().map(|c| color::to_ycxcz(*c)).collect();
        let colors = filter::resolved(width, &opponent)
            .into_par_iter()
            .map(color::to_perceived)
            .collect();
        Self {
            colors,
            features: features::of(width, &opponent),
        }
    }
}
