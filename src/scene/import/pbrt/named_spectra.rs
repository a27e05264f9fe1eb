//! Spectra that pbrt has names for, as the channels that show what they show there.
//!
//! `tests/vectors/pbrt_spectra.py` computes what pbrt's curves come to; the tests hold these figures
//! to it.

use crate::math::Rgb;

/// Wavelength at which indices of refraction of glass are listed: the helium d line, nm.
pub(super) const D_LINE: f64 = 587.6;

/// Glasses: refractive index at the d line (catalogue of Schott). pbrt's `glass-F5`, `glass-F10` and
/// `glass-F11` are the flint glasses SF5, SF10 and SF11.
pub(super) const GLASSES: &[(&str, f64)] = &[
    ("glass-BK7", 1.5168),
    ("glass-BAF10", 1.6700),
    ("glass-FK51A", 1.4866),
    ("glass-LASF9", 1.8503),
    ("glass-F5", 1.6727),
    ("glass-SF5", 1.6727),
    ("glass-F10", 1.7283),
    ("glass-SF10", 1.7283),
    ("glass-F11", 1.7847),
    ("glass-SF11", 1.7847),
];

/// Standard illuminants: chromaticities (CIE 15:2004; ACES: S-2008-001). D50 is that of pbrt's own
/// table, which is bluer than the standard's (0.34567, 0.35850).
pub(super) const ILLUMINANTS: &[(&str, [f64; 2])] = &[
    ("stdillum-A", [0.447_57, 0.407_45]),
    ("stdillum-D50", [0.336_81, 0.357_98]),
    ("stdillum-D65", [0.312_72, 0.329_03]),
    ("stdillum-F1", [0.3131, 0.337_27]),
    ("stdillum-F2", [0.372_08, 0.375_29]),
    ("stdillum-F3", [0.4091, 0.3943]),
    ("stdillum-F4", [0.440_18, 0.403_29]),
    ("stdillum-F5", [0.313_79, 0.345_31]),
    ("stdillum-F6", [0.3779, 0.388_35]),
    ("stdillum-F7", [0.312_92, 0.329_33]),
    ("stdillum-F8", [0.345_88, 0.358_75]),
    ("stdillum-F9", [0.374_17, 0.372_81]),
    ("stdillum-F10", [0.346_09, 0.358_95]),
    ("stdillum-F11", [0.380_52, 0.377_13]),
    ("stdillum-F12", [0.436_95, 0.404_41]),
    ("illum-acesD60", [0.321_68, 0.337_67]),
];

/// Name, eta, k. Chosen for each channel so that the reflectance at normal incidence and its mean
/// over a hemisphere are those of the curves under D65. Averages of eta and k are off by up to 6 %
/// in that, as it is not linear in them. Gold is redder than any sRGB: its red reflects 99 %, where
/// the curve asks for 102 %.
#[rustfmt::skip]
const METALS: &[(&str, [f32; 3], [f32; 3])] = &[
    ("Ag", [0.1283, 0.1268, 0.151], [4.093, 3.375, 2.411]),
    ("Al", [1.468, 0.9308, 0.5944], [7.851, 6.611, 5.382]),
    ("Au", [0.133, 0.3996, 1.583], [7.137, 2.321, 1.724]),
    ("Cu", [0.2243, 0.9777, 1.214], [4.308, 2.623, 2.369]),
    ("CuZn", [0.5505, 0.5258, 1.132], [4.687, 2.675, 1.816]),
    ("MgO", [1.734, 1.741, 1.754], [0.0, 0.0, 0.0]),
    ("TiO2", [2.86, 2.957, 3.186], [0.0, 0.0, 0.0]),
];

/// Eta and k of copper, which metals are made of by default.
pub(super) fn copper() -> (Rgb, Rgb) {
    optical_constants("Cu").unwrap_or((Rgb::ZERO, Rgb::ONE))
}

/// Eta and k of a metal by its symbol.
fn optical_constants(symbol: &str) -> Option<(Rgb, Rgb)> {
    let found = METALS.iter().find(|(known, ..)| *known == symbol);
    found.map(|(_, eta, k)| (Rgb::from_array(*eta), Rgb::from_array(*k)))
}

/// Eta or k of a metal, such as `metal-Au-eta`.
pub(super) fn metal(name: &str) -> Option<Rgb> {
    let name = name.strip_prefix("metal-")?;
    let (symbol, part) = name.rsplit_once('-')?;
    let (eta, k) = optical_constants(symbol)?;
    match part {
        "eta" => Some(eta),
        "k" => Some(k),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::material::{Conductor, white};
    use crate::bsdf::{Materials, Transport};
    use crate::math::{Vec2, Vec3};
    use crate::texture::{SurfacePoint, Texture};

    /// Lines of what pbrt's curves come to: kind, name, numbers.
    fn reference(kind: &str) -> Vec<(&'static str, Vec<f64>)> {
        let text = include_str!("../../../../tests/vectors/pbrt_spectra.txt");
        let lines = text.lines().map(|line| line.split(' ').collect::<Vec<_>>());
        let lines = lines.filter(|words| words[0] == kind);
        lines
            .map(|words| {
                let numbers = words[2..].iter().map(|n| n.parse().expect("a number"));
                (words[1], numbers.collect())
            })
            .collect()
    }

    /// What a mirror of these constants reflects at a cosine.
    fn reflectance(cos: f32, eta: Rgb, k: Rgb) -> Rgb {
        let mut materials = Materials::default();
        let id = materials.push(Conductor {
            eta: Texture::Constant(eta),
            k: Texture::Constant(k),
            specular_reflectance: white(),
        });
        let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
        let bsdf = materials.resolve(id, &SurfacePoint::at_uv(Vec2::ZERO), wo);
        let sample = bsdf.sample(wo, 0.5, Vec2::splat(0.5), Transport::Radiance);
        sample.expect("a reflection").weight
    }

    #[test]
    fn metals_reflect_as_pbrts_curves_do_to_a_percent() {
        const STEPS: u16 = 256;
        let metals = reference("metal");
        assert_eq!(metals.len(), METALS.len());
        for (name, expected) in metals {
            let (eta, k) = optical_constants(name).expect(name);
            let normal = reflectance(1.0, eta, k);
            // The squares of cosines are uniform under the cosine.
            let cosines = (0..STEPS).map(|i| ((f32::from(i) + 0.5) / f32::from(STEPS)).sqrt());
            let mean = cosines.map(|cos| reflectance(cos, eta, k)).sum::<Rgb>();
            let mean = mean / f32::from(STEPS);
            let found = normal.to_array().into_iter().chain(mean.to_array());
            for (i, (found, expected)) in found.zip(expected).enumerate() {
                // Nothing reflects more than all light.
                let off = f64::from(found) / expected.min(0.99) - 1.0;
                assert!(
                    off.abs() < 0.01,
                    "{name}, number {i}: {found} for {expected}"
                );
            }
        }
    }

    #[test]
    fn glasses_and_illuminants_are_those_of_pbrts_curves() {
        for (name, numbers) in reference("glass") {
            let name = format!("glass-{name}");
            let (_, index) = GLASSES.iter().find(|g| g.0 == name).expect(&name);
            assert!(
                (index - numbers[0]).abs() < 1e-4,
                "{name}: {index} for {numbers:?}"
            );
        }
        let illuminants = reference("illuminant");
        assert_eq!(illuminants.len(), ILLUMINANTS.len());
        for (name, numbers) in illuminants {
            let (_, [x, y]) = ILLUMINANTS.iter().find(|i| i.0 == name).expect(name);
            let off = (x - numbers[0]).abs().max((y - numbers[1]).abs());
            assert!(off < 5e-5, "{name}: {x} {y} for {numbers:?}");
        }
    }
}
