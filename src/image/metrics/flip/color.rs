//! FLIP's colour spaces and its distance between colours (sections 4.1.1 to 4.1.3 of the paper).

use crate::math::Rgb;
use glam::Mat3;

/// Linear sRGB to CIE XYZ, from the primaries and the white of the standard as the authors round
/// them.
const TO_XYZ: Mat3 = Mat3::from_cols_array(&[
    10_135_552.0 / 24_577_794.0,
    2_613_072.0 / 12_288_897.0,
    1_425_312.0 / 73_733_382.0,
    8_788_810.0 / 24_577_794.0,
    8_788_810.0 / 12_288_897.0,
    8_788_810.0 / 73_733_382.0,
    4_435_075.0 / 24_577_794.0,
    887_015.0 / 12_288_897.0,
    70_074_185.0 / 73_733_382.0,
]);

/// XYZ relative to white.
fn to_relative_xyz(linear: Rgb) -> Rgb {
    TO_XYZ * linear / (TO_XYZ * Rgb::ONE)
}

/// Linear sRGB to YCxCz, a linear cousin of Lab: blurring is right in it.
pub fn to_ycxcz(linear: Rgb) -> Rgb {
    let p = to_relative_xyz(linear);
    Rgb::new(116.0 * p.y - 16.0, 500.0 * (p.x - p.y), 200.0 * (p.y - p.z))
}

fn from_ycxcz(c: Rgb) -> Rgb {
    let y = (c.x + 16.0) / 116.0;
    let relative = Rgb::new(y + c.y / 500.0, y, y - c.z / 200.0);
    TO_XYZ.inverse() * (relative * (TO_XYZ * Rgb::ONE))
}

/// YCxCz to Lab with the Hunt effect (colour fades in the dark). Blurring can leave the cube of
/// what a screen shows: cut back into it first.
pub fn to_perceived(opponent: Rgb) -> Rgb {
    hunt_lab(from_ycxcz(opponent).clamp(Rgb::ZERO, Rgb::ONE))
}

fn hunt_lab(linear: Rgb) -> Rgb {
    const DELTA: f32 = 6.0 / 29.0;
    let f = |x: f32| {
        if x > DELTA * DELTA * DELTA {
            x.cbrt()
        } else {
            x / (3.0 * DELTA * DELTA) + 4.0 / 29.0
        }
    };
    let p = to_relative_xyz(linear).map(f);
    let lightness = 116.0 * p.y - 16.0;
    let hunt = 0.01 * lightness;
    Rgb::new(
        lightness,
        hunt * 500.0 * (p.x - p.y),
        hunt * 200.0 * (p.y - p.z),
    )
}

/// The HyAB distance (Abasi et al. 2020): lightness and chroma apart, for colours far from each
/// other.
fn hyab(a: Rgb, b: Rgb) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// Compresses large distances: exponent q_c.
const EXPONENT: f32 = 0.7;
/// Distances below this share of the largest take most of the range: p_c.
const KNEE: f32 = 0.4;
/// The range that they take: p_t.
const RANGE: f32 = 0.95;

/// The distance of two perceived colours, mapped to 0..1.
pub struct Distance {
    largest: f32,
}

impl Distance {
    /// The largest distance there is lies between the screen's green and its blue.
    pub fn new() -> Self {
        Self {
            largest: hyab(hunt_lab(Rgb::Y), hunt_lab(Rgb::Z)).powf(EXPONENT),
        }
    }

    /// Distance of two perceived colours.
    pub fn between(&self, a: Rgb, b: Rgb) -> f32 {
        let distance = hyab(a, b).powf(EXPONENT);
        let knee = KNEE * self.largest;
        if distance < knee {
            return RANGE / knee * distance;
        }
        RANGE + (distance - knee) / (self.largest - knee) * (1.0 - RANGE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ycxcz_goes_there_and_back() {
        for c in [Rgb::ONE, Rgb::new(0.2, 0.7, 0.01), Rgb::ZERO, Rgb::Z] {
            assert!((from_ycxcz(to_ycxcz(c)) - c).length() < 2e-6, "{c}");
        }
    }

    #[test]
    fn green_and_blue_are_one_apart() {
        let d = Distance::new();
        let apart = d.between(hunt_lab(Rgb::Y), hunt_lab(Rgb::Z));
        assert!((apart - 1.0).abs() < 1e-6, "{apart}");
        assert_eq!(d.between(Rgb::ONE, Rgb::ONE), 0.0);
    }
}
