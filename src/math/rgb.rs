//! Linear sRGB colours and the scalars drawn from them.

use glam::Vec3;

/// A linear sRGB triple: radiance (W m^-2 sr^-1), reflectance (0 to 1) or a weight, as the context
/// says.
pub type Rgb = Vec3;

/// Luminance of a linear sRGB colour (Rec. 709 primaries), in the colour's own unit.
///
/// ```
/// use twintree::math::{Rgb, luminance};
/// assert!((luminance(Rgb::ONE) - 1.0).abs() < 1e-6);
/// ```
#[inline]
pub fn luminance(c: Rgb) -> f32 {
    0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z
}

/// A weight for choosing by colour: luminance plus a trace of the largest channel, so that a
/// saturated blue or a colour outside the gamut is never given the weight 0.
#[inline]
pub fn selection_weight(c: Rgb) -> f32 {
    luminance(c).max(0.0) + 1e-6 * c.max_element().max(0.0)
}

/// A colour that light can have: channels that are negative, infinite or not numbers are 0.
pub fn sanitized(c: Rgb) -> Rgb {
    let keep = |x: f32| if x.is_finite() && x > 0.0 { x } else { 0.0 };
    Rgb::new(keep(c.x), keep(c.y), keep(c.z))
}
