//! Whether means over blocks of two images differ by more than their noise.
//!
//! Where paths are shared among pixels, the errors of neighbours go together, and the mean over a
//! block is less sure than its pixels' variances say. An image with the layer `noise` (see
//! [`crate::film::layers`]) tells by how much: that layer is as noisy as the image, at every scale,
//! so the squares of its means over blocks, relative to what independent pixels would have, average
//! to the factor that is missing.

use super::Pair;
use crate::image::Image;
use crate::image::denoise::NOISY;
use crate::math::Rgb;

/// What an image knows of its own noise, a number for each pixel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KnownNoise {
    /// Variance of the pixels' means.
    pub variance: Vec<Rgb>,
    /// Noise like that of the image; none: that of neighbours is taken as independent.
    pub noise: Option<Vec<Rgb>>,
}

impl KnownNoise {
    /// That of an image that has the layer `variance`; `None` also for one that was denoised: the
    /// layer is about its noisy picture.
    pub fn of(image: &Image) -> Option<Self> {
        if image.channel(NOISY[0]).is_some() {
            return None;
        }
        Some(Self {
            variance: layer(image, ["variance.R", "variance.G", "variance.B"])?,
            noise: layer(image, ["noise.R", "noise.G", "noise.B"]),
        })
    }

    /// Variance of the means over blocks of `side` pixels over that of independent pixels.
    pub fn linked(&self, width: usize, side: usize) -> f64 {
        let Some(noise) = self.noise.as_ref().filter(|_| side > 1) else {
            return 1.0;
        };
        // The same blocks that are tested: paths are shared within tiles, which blocks may divide.
        let [independent, noise] =
            [&self.variance, noise].map(|pixels| Blocks::new(width, pixels, side));
        let mut ratios = (0.0, 0u64);
        for (mean, variance) in noise.means().zip(independent.means()) {
            for c in 0..3 {
                let ratio = mean[c] * mean[c] / (variance[c] / (side * side) as f64);
                if ratio.is_finite() {
                    ratios = (ratios.0 + ratio, ratios.1 + 1);
                }
            }
        }
        if ratios.1 > 0 {
            ratios.0 / ratios.1 as f64
        } else {
            1.0
        }
    }
}

fn layer(image: &Image, names: [&str; 3]) -> Option<Vec<Rgb>> {
    let [r, g, b] = names.map(|name| image.channel(name));
    let (r, g, b) = (r?, g?, b?);
    let pixels = image.pixels.chunks_exact(image.channels.len());
    Some(pixels.map(|p| Rgb::new(p[r], p[g], p[b])).collect())
}

/// Variance of the rounding of a picture's numbers, relative to their squares.
pub(super) fn rounding_of(pixels: &[Rgb]) -> f64 {
    let is_half = |x: f32| half::f16::from_f32(x).to_f32() == x;
    let halves = pixels.iter().all(|p| p.to_array().into_iter().all(is_half));
    if halves { 2f64.powi(-22) / 3.0 } else { 0.0 }
}

/// An image in whole blocks; what is left over at its edges is left out.
struct Blocks<'i> {
    pixels: &'i [Rgb],
    width: usize,
    side: usize,
}

impl<'i> Blocks<'i> {
    fn new(width: usize, pixels: &'i [Rgb], side: usize) -> Self {
        Self {
            pixels,
            width,
            side,
        }
    }

    /// The mean of each block, row by row.
    fn means(&self) -> impl Iterator<Item = [f64; 3]> + use<'i> {
        let Self {
            pixels,
            width,
            side,
        } = *self;
        let (across, down) = (width / side, pixels.len() / width / side);
        let number = (side * side) as f64;
        (0..across * down).map(move |block| {
            let first = (block / across * width + block % across) * side;
            let mut sum = [0.0; 3];
            for y in 0..side {
                for pixel in &pixels[first + y * width..][..side] {
                    (0..3).for_each(|c| sum[c] += f64::from(pixel[c]));
                }
            }
            sum.map(|s| s / number)
        })
    }
}

impl Pair {
    /// The pair of the means over whole blocks of `side` pixels: what is left of an error at a
    /// coarser scale. `None` where there is no whole block.
    pub fn blocks(&self, side: usize) -> Option<Self> {
        let (across, down) = (self.width() / side, self.height() / side);
        let means = |pixels| {
            let means = Blocks::new(self.width(), pixels, side).means();
            means.map(|m| Rgb::from(m.map(|x| x as f32))).collect()
        };
        (across * down > 0).then(|| Self {
            width: across,
            image: means(&self.image),
            reference: means(&self.reference),
            ..*self
        })
    }
}

/// Standard deviation of z of the means over blocks of `side` pixels: 1 where the noise explains
/// the differences. `None` where there is no whole block, or no variance.
pub fn deviation(pair: &Pair, known: [&KnownNoise; 2], side: usize) -> Option<f64> {
    let width = pair.width();
    let pictures = [pair.image(), pair.reference()];
    let means = pictures.map(|p| Blocks::new(width, p, side).means());
    let [images, references] = means;
    let variances = known.map(|k| Blocks::new(width, &k.variance, side).means());
    let [of_images, of_references] = variances;
    let linked = known.map(|k| k.linked(width, side));
    let rounding = pictures.map(rounding_of);
    let number = (side * side) as f64;
    let mut squares = (0.0, 0u64);
    for (((x, r), vx), vr) in images.zip(references).zip(of_images).zip(of_references) {
        for c in 0..3 {
            let rounded = rounding[0] * x[c] * x[c] + rounding[1] * r[c] * r[c];
            let variance = (linked[0] * vx[c] + linked[1] * vr[c] + rounded) / number;
            let square = (x[c] - r[c]).powi(2) / variance;
            if square.is_finite() {
                squares = (squares.0 + square, squares.1 + 1);
            }
        }
    }
    (squares.1 > 0).then(|| (squares.0 / squares.1 as f64).sqrt())
}
