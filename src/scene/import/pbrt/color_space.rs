//! Colour spaces of a scene's RGB triples, and their way to linear sRGB.

use crate::math::{DVec3, Rgb};
use crate::scene::import::spectrum::xyz_to_rgb;
use glam::{DMat3, DVec2};

/// A colour space.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub(super) enum ColorSpace {
    #[default]
    Srgb,
    DciP3,
    Rec2020,
    Aces,
}

/// All of them by name.
pub(super) const COLOR_SPACES: &[(&str, ColorSpace)] = &[
    ("srgb", ColorSpace::Srgb),
    ("dci-p3", ColorSpace::DciP3),
    ("rec2020", ColorSpace::Rec2020),
    ("aces2065-1", ColorSpace::Aces),
];

/// Chromaticity of the standard illuminant D65.
const D65: DVec2 = DVec2::new(0.312_72, 0.329_03);

impl ColorSpace {
    /// Chromaticities of the primaries and of white. As in pbrt, DCI-P3 has the white D65
    /// ("Display P3"); ACES has D60.
    fn chromaticities(self) -> [DVec2; 4] {
        let xy = DVec2::new;
        match self {
            Self::Srgb => [xy(0.64, 0.33), xy(0.3, 0.6), xy(0.15, 0.06), D65],
            Self::DciP3 => [xy(0.68, 0.32), xy(0.265, 0.69), xy(0.15, 0.06), D65],
            Self::Rec2020 => [xy(0.708, 0.292), xy(0.17, 0.797), xy(0.131, 0.046), D65],
            Self::Aces => [
                xy(0.7347, 0.2653),
                xy(0.0, 1.0),
                xy(0.0001, -0.077),
                xy(0.321_68, 0.337_67),
            ],
        }
    }

    /// RGB of this space to XYZ: (1, 1, 1) is its white with luminance 1.
    fn to_xyz(self) -> DMat3 {
        let [r, g, b, white] = self.chromaticities().map(xyz);
        let primaries = DMat3::from_cols(r, g, b);
        let amounts = primaries.inverse() * white;
        primaries * DMat3::from_diagonal(amounts)
    }

    /// Light of this space in linear sRGB; what sRGB cannot show has channels below 0.
    pub fn light(self, rgb: Rgb) -> Rgb {
        match self {
            Self::Srgb => rgb,
            other => xyz_to_rgb(other.to_xyz() * rgb.as_dvec3()),
        }
    }

    /// A factor on light in linear sRGB: white stays white, whatever the space's own white is
    /// (the other colours follow in proportion, channel by channel).
    pub fn factor(self, rgb: Rgb) -> Rgb {
        match self {
            Self::Srgb => rgb,
            other => other.light(rgb) / other.light(Rgb::ONE),
        }
    }
}

/// XYZ of luminance 1 of a chromaticity.
fn xyz(c: DVec2) -> DVec3 {
    DVec3::new(c.x / c.y, 1.0, (1.0 - c.x - c.y) / c.y)
}

/// Linear sRGB of light of luminance 1 and that chromaticity.
pub(super) fn of_chromaticity(x: f64, y: f64) -> Rgb {
    xyz_to_rgb(xyz(DVec2::new(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::luminance;

    #[test]
    fn white_is_white_and_primaries_leave_the_gamut() {
        for (name, space) in COLOR_SPACES {
            let white = space.factor(Rgb::ONE);
            assert!((white - 1.0).abs().max_element() < 1e-5, "{name} {white}");
            let light = space.light(Rgb::ONE);
            assert!((luminance(light) - 1.0).abs() < 2e-3, "{name} {light}");
            let green = space.light(Rgb::Y);
            let outside = green.min_element() < -0.01;
            assert_eq!(outside, *space != ColorSpace::Srgb, "{name} {green}");
        }
        // Rec. ITU-R BT.2087: linear BT.2020 to BT.709.
        let red = ColorSpace::Rec2020.light(Rgb::X);
        let expected = Rgb::new(1.6605, -0.1246, -0.0182);
        assert!((red - expected).abs().max_element() < 2e-3, "{red}");
        // The white of ACES is a little warmer than that of sRGB.
        let white = ColorSpace::Aces.light(Rgb::ONE);
        assert!(white.x > 1.02 && white.z < 0.98, "{white}");
    }
}
