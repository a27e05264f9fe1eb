//! Whether two images differ by more than their noise.
//!
//! With the variances of both means known, z = (I - R) / sqrt(var I + var R) of every number
//! follows the standard normal distribution if both estimate the same: 99.9 % of them lie within
//! 3.29. Fewer say that one image is biased, or that a pixel's few samples do not know their own
//! variance yet (the rare bright path that was not found is missing in both): below some hundred
//! samples a pixel expect a little less than 0.999 where light is hard to find.

use super::Pair;
use super::blocks::{self, KnownNoise, rounding_of};
use crate::math::Rgb;

/// Half-width of the band that holds 99.9 % of the standard normal distribution.
pub const BAND: f64 = 3.290_526_731_491_926;

/// Sides of the blocks in pixels whose means are tested, too.
pub const SCALES: [usize; 3] = [1, 4, 16];

/// What the test says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ZTest {
    /// Share of the numbers (pixels times channels) within [`BAND`]; 0.999 is expected.
    pub inside: f64,
    /// z of the whole image's mean, for red, green and blue: a bias that no pixel shows adds up
    /// here. NaN without any variance.
    pub of_mean: [f64; 3],
    /// Standard deviation of z of pixels and of means over blocks, for the sides [`SCALES`]: 1 is
    /// expected. `None` where the image has no whole block.
    pub deviations: [Option<f64>; SCALES.len()],
}

/// Tests the pair by what the image and the reference know of their noise.
///
/// Pictures of 16-bit floats are rounded by up to 2^-11 of the value, which is 2^-22 / 3 of its
/// square as a variance: that is added where every number of a picture is such a float. Numbers
/// whose variances are not finite are left out. `None` if the variances are of another size, or all
/// left out.
pub fn ztest(pair: &Pair, known: [&KnownNoise; 2]) -> Option<ZTest> {
    let pixels = pair.image.len();
    let [variance, reference_variance] = known.map(|k| &k.variance[..]);
    if variance.len() != pixels || reference_variance.len() != pixels {
        return None;
    }
    let rounding = [&pair.image, &pair.reference].map(|list| rounding_of(list));
    let linked = known.map(|k| k.linked(pair.width(), SCALES[SCALES.len() - 1]));
    let (mut inside, mut count) = (0u64, 0u64);
    let mut sums = [(0.0, 0.0); 3];
    for i in 0..pixels {
        for (c, sum) in sums.iter_mut().enumerate() {
            let at = |list: &[Rgb]| f64::from(list[i][c]);
            let (x, r) = (at(&pair.image), at(&pair.reference));
            let sampled = [at(variance), at(reference_variance)];
            let apart = linked[0] * sampled[0] + linked[1] * sampled[1];
            let sampled = sampled[0] + sampled[1];
            let total = sampled + rounding[0] * x * x + rounding[1] * r * r;
            if !(total.is_finite() && total >= 0.0) {
                continue;
            }
            count += 1;
            inside += u64::from((x - r).abs() <= BAND * total.sqrt());
            *sum = (sum.0 + x - r, sum.1 + total - sampled + apart);
        }
    }
    (count > 0).then(|| ZTest {
        inside: inside as f64 / count as f64,
        of_mean: sums.map(|(difference, variance): (f64, f64)| difference / variance.sqrt()),
        deviations: SCALES.map(|side| blocks::deviation(pair, known, side)),
    })
}
