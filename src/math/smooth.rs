//! Smoothing of images.

use rayon::prelude::*;

/// An image, row by row, smoothed by the same kernel along both axes. Beyond an edge there is
/// nothing to count: the weights of what is there are made to sum to one.
pub fn smooth(image: &[f32], [width, height]: [usize; 2], kernel: &[f32]) -> Vec<f32> {
    let mut across = vec![0.0; image.len()];
    let rows = across.par_chunks_mut(width).zip(image.par_chunks(width));
    rows.for_each(|(to, from)| {
        for (x, to) in to.iter_mut().enumerate() {
            let near = near(x, width, kernel);
            let (sum, weights) = near.fold((0.0, 0.0), |(sum, weights), (at, weight)| {
                (sum + weight * from[at], weights + weight)
            });
            *to = sum / weights;
        }
    });
    let mut smoothed = vec![0.0; image.len()];
    let rows = smoothed.par_chunks_mut(width).enumerate();
    rows.for_each(|(y, to)| {
        let mut weights = 0.0;
        for (at, weight) in near(y, height, kernel) {
            let from = &across[at * width..][..width];
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to += weight * from);
            weights += weight;
        }
        to.iter_mut().for_each(|to| *to /= weights);
    });
    smoothed
}

/// The places of a line of `length` under a kernel that is centred on `at`, with its weights.
fn near(at: usize, length: usize, kernel: &[f32]) -> impl Iterator<Item = (usize, f32)> {
    let reach = kernel.len() / 2;
    let places = kernel.iter().enumerate();
    places.filter_map(move |(k, weight)| {
        let place = (at + k).checked_sub(reach).filter(|p| *p < length)?;
        Some((place, *weight))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_speck_is_spread_and_its_sum_kept_away_from_edges() {
        let kernel = [1.0, 2.0, 3.0, 2.0, 1.0];
        let mut image = vec![0.0; 11 * 9];
        image[4 * 11 + 5] = 81.0;
        let smoothed = smooth(&image, [11, 9], &kernel);
        assert!((smoothed.iter().sum::<f32>() - 81.0).abs() < 1e-3);
        assert_eq!(smoothed[4 * 11 + 5], 9.0);
        assert_eq!(smoothed[2 * 11 + 3], 1.0);
        let even = smooth(&[5.0; 99], [11, 9], &kernel);
        assert!(even.iter().all(|x| (x - 5.0).abs() < 1e-5));
    }
}
