//! Fireflies: specks that the reference does not have.
//!
//! A pixel counts when its luminance is more than four times the largest of the reference's in the
//! 3 x 3 pixels around it. The neighbours allow for edges that filters place differently, and a
//! hundredth of the reference's mean is added so that the grain of a dark corner does not count.

use super::Pair;
use crate::math::luminance;

/// So many times brighter than its surroundings should be.
const FACTOR: f32 = 4.0;
/// Share of the reference's mean that counts as dark.
const DARK: f64 = 0.01;

/// How many pixels of the image are fireflies.
pub fn count(pair: &Pair) -> usize {
    let (width, height) = (pair.width(), pair.height());
    let reference: Vec<f32> = pair.reference.iter().map(|c| luminance(*c)).collect();
    let mean = reference.iter().map(|l| f64::from(*l)).sum::<f64>() / reference.len() as f64;
    let dark = (DARK * mean) as f32;
    let around = |x: usize, y: usize| {
        let columns = x.saturating_sub(1)..(x + 2).min(width);
        (y.saturating_sub(1)..(y + 2).min(height))
            .flat_map(|y| &reference[y * width..][columns.clone()])
            .fold(0.0, |most: f32, l| most.max(*l))
    };
    (0..height)
        .flat_map(|y| (0..width).map(move |x| (x, y)))
        .filter(|&(x, y)| {
            let l = luminance(pair.image[y * width + x]);
            // The search of the neighbours only for the few that may pass.
            let suspect = l > FACTOR * (reference[y * width + x] + dark);
            suspect && l > FACTOR * (around(x, y) + dark)
        })
        .count()
}
