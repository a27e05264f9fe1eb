//! How far an image is from a reference.
//!
//! A [`Pair`] is an image and its reference, of one size and with finite numbers; each metric is a
//! function of it. [`errors`] has the plain ones (L1, RMSE, relMSE, PSNR), [`ssim`] structural
//! similarity, [`flip`] the difference that an eye sees when the two alternate, [`fireflies`]
//! specks that the reference does not have, [`ztest`] whether the difference is what the noise
//! explains.
//!
//! Most numbers are of linear light. [`Pair::shown`] is the same pair as a screen shows it, for
//! metrics that know values from 0 to 1.

pub mod blocks;
pub mod errors;
pub mod fireflies;
pub mod flip;
pub mod ssim;
#[cfg(test)]
mod tests;
pub mod views;
pub mod ztest;

use super::{Image, curve::linear_to_srgb};
use crate::math::Rgb;

/// An image and its reference: as many pixels each, at least one, all finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Pair {
    width: usize,
    image: Vec<Rgb>,
    reference: Vec<Rgb>,
    not_finite: usize,
    reference_not_finite: usize,
}

/// The two images of a would-be pair have different sizes, or none.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the image has {} x {} pixels, the reference {} x {}",
    image[0], image[1], reference[0], reference[1]
)]
pub struct SizesDiffer {
    /// Width and height of the image.
    pub image: [u32; 2],
    /// Width and height of the reference.
    pub reference: [u32; 2],
}

impl Pair {
    /// Pairs the colours of two images.
    ///
    /// A pixel with a NaN or an infinity is taken as black, as most viewers show it: it counts as
    /// an error and does not turn every number into NaN. Where the reference has one, nothing is
    /// known: both are taken as black there.
    ///
    /// # Errors
    /// When the sizes differ or there is no pixel.
    pub fn new(image: &Image, reference: &Image) -> Result<Self, SizesDiffer> {
        let [a, b] = [image, reference].map(|i| [i.width, i.height]);
        let mut pair = Self {
            width: image.width as usize,
            image: image.rgb(),
            reference: reference.rgb(),
            not_finite: 0,
            reference_not_finite: 0,
        };
        let pixels = a[0] as usize * a[1] as usize;
        if a != b || pixels == 0 || pair.image.len() != pixels || pair.reference.len() != pixels {
            return Err(SizesDiffer {
                image: a,
                reference: b,
            });
        }
        for (x, r) in pair.image.iter_mut().zip(&mut pair.reference) {
            pair.not_finite += usize::from(!x.is_finite());
            pair.reference_not_finite += usize::from(!r.is_finite());
            if !r.is_finite() {
                *r = Rgb::ZERO;
                *x = Rgb::ZERO;
            }
            if !x.is_finite() {
                *x = Rgb::ZERO;
            }
        }
        Ok(pair)
    }

    /// The pair as a screen shows it: times 2 to the power of `exposure`, cut to 0..1, with the
    /// sRGB curve.
    pub fn shown(&self, exposure: f32) -> Self {
        let gain = exposure.exp2();
        let show = |list: &[Rgb]| {
            let shown = |c: &Rgb| (*c * gain).clamp(Rgb::ZERO, Rgb::ONE).map(linear_to_srgb);
            list.iter().map(shown).collect()
        };
        Self {
            image: show(&self.image),
            reference: show(&self.reference),
            ..*self
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.image.len() / self.width
    }

    /// The image's pixels, rows from the top.
    pub fn image(&self) -> &[Rgb] {
        &self.image
    }

    /// The reference's pixels.
    pub fn reference(&self) -> &[Rgb] {
        &self.reference
    }

    /// Pixels of the image that had a NaN or an infinity.
    pub fn not_finite(&self) -> usize {
        self.not_finite
    }

    /// Pixels of the reference that had a NaN or an infinity.
    pub fn reference_not_finite(&self) -> usize {
        self.reference_not_finite
    }

    /// Image and reference, number by number in `f64`.
    fn numbers(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let pixels = self.image.iter().zip(&self.reference);
        pixels.flat_map(|(x, r)| (0..3).map(|c| (f64::from(x[c]), f64::from(r[c]))))
    }
}
