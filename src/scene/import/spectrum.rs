//! Spectra in scene files, turned into linear sRGB.
//!
//! The renderer works in three channels; scenes may give reflectances and light as curves over the
//! wavelength. A curve is integrated against the CIE 1931 observer (`spectrum_tables`) to XYZ and
//! then to linear sRGB. What the integral is normalised by depends on what the curve is:
//!
//! * A **reflectance** (or an index of refraction) is seen under daylight: D65 weighs the integral,
//!   so that a curve that is 1 everywhere is white, (1, 1, 1).
//! * An **emission** is seen as it is: a curve that is 1 everywhere has luminance 1 and the
//!   slightly red colour of equal energy, about (1.205, 0.948, 0.909).
//!
//! These are the conventions of Mitsuba 3's RGB mode, with which the tests compare.

use super::spectrum_tables as tables;
use crate::math::{DVec3, Rgb};

/// What a curve stands for, which decides how it is normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weighting {
    /// A factor on light, or an index of refraction: seen under D65.
    Reflectance,
    /// Light itself.
    Emission,
}

/// Samples of the observer's curves taken for one integral: the table's spacing in ten parts, fine
/// enough for curves that are themselves given every nanometre.
const STEPS_PER_ENTRY: usize = 10;

/// XYZ (D65 white) to linear sRGB, ITU-R BT.709 primaries.
pub(super) fn xyz_to_rgb(xyz: DVec3) -> Rgb {
    let row = |a: f64, b: f64, c: f64| (a * xyz.x + b * xyz.y + c * xyz.z) as f32;
    Rgb::new(
        row(3.240_479, -1.537_150, -0.498_535),
        row(-0.969_256, 1.875_991, 0.041_556),
        row(0.055_648, -0.204_043, 1.057_311),
    )
}

/// Integrates `curve` (a function of the wavelength in nm) to linear sRGB. Colours outside the
/// gamut come out with negative channels.
///
/// ```
/// use twintree::scene::import::spectrum::{Weighting, integrate};
/// let white = integrate(Weighting::Reflectance, |_| 1.0);
/// assert!((white - 1.0).abs().max_element() < 2e-3);
/// ```
pub fn integrate(weighting: Weighting, curve: impl Fn(f64) -> f64) -> Rgb {
    let intervals = (tables::OBSERVER.len() - 1) * STEPS_PER_ENTRY;
    let (mut xyz, mut norm) = (DVec3::ZERO, 0.0);
    for i in 0..=intervals {
        let (entry, within) = (i / STEPS_PER_ENTRY, i % STEPS_PER_ENTRY);
        let t = within as f64 / STEPS_PER_ENTRY as f64;
        let next = (entry + 1).min(tables::OBSERVER.len() - 1);
        let observer = DVec3::from_array(tables::OBSERVER[entry])
            .lerp(DVec3::from_array(tables::OBSERVER[next]), t);
        let light = match weighting {
            Weighting::Reflectance => tables::D65[entry] * (1.0 - t) + tables::D65[next] * t,
            Weighting::Emission => 1.0,
        };
        let wavelength = tables::FIRST_NM + (entry as f64 + t) * tables::STEP_NM;
        xyz += observer * (light * curve(wavelength));
        norm += observer.y * light;
    }
    xyz_to_rgb(xyz / norm)
}

/// Linear sRGB of a curve given by samples (wavelength in nm, value) of increasing wavelength,
/// linear in between and 0 outside. Channels below 0 (out of gamut) are cut off.
pub fn sampled(weighting: Weighting, samples: &[(f64, f64)]) -> Rgb {
    integrate(weighting, |w| interpolate(samples, w)).max(Rgb::ZERO)
}

/// Linear sRGB of light of spectral power `value` at all wavelengths.
pub fn equal_energy(value: f64) -> Rgb {
    integrate(Weighting::Emission, |_| value)
}

/// Linear sRGB of a black body at `kelvin`, as Planck's law gives it, in W m^-2 sr^-1 nm^-1.
pub fn black_body(kelvin: f64) -> Rgb {
    // 2 h c^2 and h c / k_B in SI units (CODATA 2018, exact).
    const FIRST_RADIATION: f64 = 1.191_042_972e-16;
    const SECOND_RADIATION: f64 = 1.438_776_877e-2;
    let planck = |nm: f64| {
        let metres = nm * 1e-9;
        1e-9 * FIRST_RADIATION / (metres.powi(5) * (SECOND_RADIATION / (metres * kelvin)).exp_m1())
    };
    integrate(Weighting::Emission, planck).max(Rgb::ZERO)
}

/// The curve through `samples` at `wavelength`; 0 outside.
pub(super) fn interpolate(samples: &[(f64, f64)], wavelength: f64) -> f64 {
    let above = samples.partition_point(|s| s.0 <= wavelength);
    let Some(&(w0, v0)) = above.checked_sub(1).and_then(|i| samples.get(i)) else {
        return 0.0;
    };
    match samples.get(above) {
        Some(&(w1, v1)) => v0 + (v1 - v0) * (wavelength - w0) / (w1 - w0),
        None if wavelength == w0 => v0,
        None => 0.0,
    }
}

/// Linear value of an sRGB-encoded one (IEC 61966-2-1); negative values keep their sign.
pub fn srgb_to_linear(v: f64) -> f64 {
    let a = v.abs();
    let linear = if a <= 0.04045 {
        a / 12.92
    } else {
        ((a + 0.055) / 1.055).powf(2.4)
    };
    linear.copysign(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Rgb, b: [f32; 3], relative: f32) {
        let b = Rgb::from_array(b);
        let error = ((a - b) / b.max(Rgb::splat(1e-3))).abs().max_element();
        assert!(error < relative, "{a} against {b}: {error}");
    }

    const RISING: [(f64, f64); 7] = [
        (400.0, 0.04),
        (450.0, 0.1),
        (500.0, 0.3),
        (550.0, 0.5),
        (600.0, 0.7),
        (650.0, 0.9),
        (700.0, 0.95),
    ];

    /// Figures read from Mitsuba 3.9.1 (`scalar_rgb`, `mi.traverse`).
    #[test]
    fn agrees_with_mitsuba_3() {
        let reflectance = sampled(Weighting::Reflectance, &RISING);
        close(reflectance, [0.864562, 0.469507, 0.084099], 2e-3);
        let emission = sampled(Weighting::Emission, &RISING);
        close(emission, [1.006704, 0.448400, 0.067511], 2e-3);
        close(equal_energy(0.3), [0.361438, 0.284487, 0.272675], 1e-3);
        let flat = [(400.0, 0.5), (700.0, 0.5)];
        let seen = sampled(Weighting::Reflectance, &flat);
        close(seen, [0.497671, 0.499878, 0.497455], 2e-3);
    }

    #[test]
    fn luminance_of_equal_energy_is_its_value() {
        let y = crate::math::luminance(equal_energy(2.5));
        assert!((y - 2.5).abs() < 2e-3, "{y}");
    }

    #[test]
    fn samples_are_linear_in_between_and_zero_outside() {
        assert_eq!(interpolate(&RISING, 425.0), 0.07);
        assert_eq!(interpolate(&RISING, 700.0), 0.95);
        assert_eq!(interpolate(&RISING, 399.9), 0.0);
        assert_eq!(interpolate(&RISING, 700.1), 0.0);
        assert_eq!(interpolate(&[], 500.0), 0.0);
    }

    /// Chromaticities (x, y) of black bodies: illuminant A is one of 2856 K (CIE 15:2004), the
    /// other is Planck's locus at 6500 K.
    #[test]
    fn black_bodies_have_their_colour() {
        for (kelvin, x, y) in [(2856.0, 0.44758, 0.40745), (6500.0, 0.31352, 0.32363)] {
            let seen = black_body(kelvin);
            let expected = xyz_to_rgb(DVec3::new(x / y, 1.0, (1.0 - x - y) / y));
            close(seen / seen.y, (expected / expected.y).to_array(), 3e-3);
        }
    }

    #[test]
    fn srgb_curve_has_its_known_values() {
        assert!((srgb_to_linear(0.5) - 0.214_041).abs() < 1e-6);
        assert!((srgb_to_linear(0.04045) - 0.003_130_8).abs() < 1e-7);
        assert_eq!(srgb_to_linear(1.0), 1.0);
    }
}
