//! Smoothing of images.

/// An image, row by row, smoothed by the same kernel along both axes. Beyond an edge there is nothing to
/// count: the weights of what is there are made to sum to one.
pub fn smooth(image: &[f32], [width, height]: [usize; 2], kernel: &[f32]) -> Vec<f32> {
    let across = along(image, [width, height], [width, 1], kernel);
    along(&across, [height, width], [1, width], kernel)
}

/// Smoothed along one axis: numbers of a line and lines, and the distances between lines and between numbers.
fn along(
    image: &[f32],
    [length, lines]: [usize; 2],
    [line, step]: [usize; 2],
    kernel: &[f32],
) -> Vec<f32> {
    let mut smoothed = vec![0.0; image.len()];
    let reach = kernel.len() / 2;
    for l in 0..lines {
        for i in 0..length {
            let (mut sum, mut weights) = (0.0, 0.0);
            for (k, weight) in kernel.iter().enumerate() {
                let Some(j) = (i + k).checked_sub(reach).filter(|j| *j < length) else {
                    continue;
                };
                sum += weight * image[l * line + j * step];
                weights += weight;
            }
            smoothed[l * line + i * step] = sum / weights;
        }
    }
    smoothed
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
