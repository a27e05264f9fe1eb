//! From the numbers in a file to linear ones, before anything is interpolated.

use super::BitmapSettings;
use crate::image::PixelType;
use crate::image::curve::srgb_to_linear;

/// The curve that the numbers of a file follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Curve {
    /// Linear already.
    Linear,
    /// The sRGB curve.
    Srgb,
    /// A power.
    Gamma(f32),
}

impl Curve {
    /// The curve of a file's numbers: integers are sRGB and floats linear, unless the scene knows
    /// better. A gamma of -1 is Mitsuba 0.x's name for sRGB. Alpha (`linear_channel`) never has a
    /// curve.
    pub fn of(settings: &BitmapSettings, stored: PixelType, linear_channel: bool) -> Self {
        if settings.raw || linear_channel {
            return Self::Linear;
        }
        match (settings.gamma, stored) {
            (Some(g), _) if g < 0.0 => Self::Srgb,
            (Some(g), _) if g > 0.0 && g.is_finite() && g != 1.0 => Self::Gamma(g),
            (Some(1.0), _) => Self::Linear,
            (_, PixelType::U8 | PixelType::U16) => Self::Srgb,
            _ => Self::Linear,
        }
    }

    /// The linear value of a stored one.
    #[inline]
    pub fn decode(self, x: f32) -> f32 {
        match self {
            Self::Linear => x,
            Self::Srgb => srgb_to_linear(x),
            Self::Gamma(g) => x.max(0.0).powf(g),
        }
    }

    /// The linear values of all 8-bit codes, ascending.
    pub fn table(self) -> Box<[f32; 256]> {
        let mut table = Box::new([0.0; 256]);
        for (code, value) in table.iter_mut().enumerate() {
            *value = self.decode(code as f32 / 255.0);
        }
        table
    }
}

/// What is done to numbers that no texture should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cleaner {
    /// Keep numbers below 0 (normal maps, bumps); a colour below 0 becomes 0.
    pub keep_negative: bool,
    /// The largest magnitude that the storage holds.
    pub half: bool,
}

impl Cleaner {
    /// The number to keep. Not a number and infinities become 0: a hole in an image must not become
    /// the brightest thing in a scene.
    #[inline]
    pub fn clean(self, x: f32) -> f32 {
        if !x.is_finite() || (x < 0.0 && !self.keep_negative) {
            return 0.0;
        }
        if self.half {
            return x.clamp(-65504.0, 65504.0);
        }
        x
    }
}
