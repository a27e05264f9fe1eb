//! A transparent film on a surface, so thin that the light of its two sides interferes (Belcour and
//! Barla, "A Practical Extension to Microfacet Theory for the Modeling of Varying Iridescence",
//! 2017).
//!
//! The reflectance over wavelengths is a series of cosines of the optical path difference, and the
//! eye's sensitivities are near to Gaussians over wavenumbers: each cosine seen through a Gaussian is
//! known in closed form. As in the paper the series ends after two terms.

use super::fresnel::dielectric;
use super::lobes::principled_parts::schlick_weight;
use crate::math::{Rgb, Vec3};
use std::f32::consts::TAU;

/// The film at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct ThinFilm {
    /// How much of the surface has the film, 0 to 1.
    pub strength: f32,
    /// Its index of refraction.
    pub eta: f32,
    /// Its thickness, nanometres.
    pub thickness: f32,
}

/// The paper's fit of the CIE 1931 observer by Gaussians over wavenumbers (1/m): the component of
/// XYZ, the height over that of white, the middle and the variance.
const GAUSSIANS: [(usize, f32, f32, f32); 4] = [
    (0, 5.4856e-13 / 1.0685e-7, 1.681e6, 4.3278e9),
    (0, 9.747e-14 / 1.0685e-7, 2.2399e6, 4.5282e9),
    (1, 4.4201e-13 / 1.0685e-7, 1.7953e6, 9.3046e9),
    (2, 5.2481e-13 / 1.0685e-7, 2.2084e6, 6.6121e9),
];

/// XYZ to linear sRGB, by rows.
const RGB_OF_XYZ: [Vec3; 3] = [
    Vec3::new(3.2404542, -1.5371385, -0.4985314),
    Vec3::new(-0.969266, 1.8760108, 0.041556),
    Vec3::new(0.0556434, -0.2040259, 1.0572252),
];

/// The mean over the eye's sensitivities of the cosine of the phase at an optical path difference
/// of so many nanometres; 1 at 0 for the white of the light.
fn mean_cosine(path: f32) -> Rgb {
    let phase = TAU * path * 1e-9;
    let mut xyz = Vec3::ZERO;
    for (part, height, middle, variance) in GAUSSIANS {
        let width = (TAU * variance).sqrt();
        xyz[part] += height * width * (middle * phase).cos() * (-variance * phase * phase).exp();
    }
    let row = |i: usize| RGB_OF_XYZ[i].dot(xyz) / RGB_OF_XYZ[i].element_sum();
    Rgb::new(row(0), row(1), row(2))
}

impl ThinFilm {
    /// Reflectance of a facet that reflects `bare` at this angle without the film and `normal` at
    /// normal incidence.
    #[inline]
    pub fn over(&self, bare: Rgb, normal: Rgb, cos: f32) -> Rgb {
        bare.lerp(self.reflectance(normal, cos), self.strength)
    }

    /// Reflectance of the film on a base that reflects `normal` at normal incidence in air, seen
    /// from the cosine `cos`.
    pub fn reflectance(&self, normal: Rgb, cos: f32) -> Rgb {
        let cos = cos.clamp(0.0, 1.0);
        let outer = dielectric(cos, self.eta);
        let cos_inside = outer.cos_t.abs();
        let path = 2.0 * self.eta * self.thickness * cos_inside;
        let cosines = [mean_cosine(path), mean_cosine(2.0 * path)];
        // Light turns by half a wave where it is reflected at something denser.
        let turned_above = self.eta < 1.0;
        let channel = |i: usize| {
            let root = normal[i].clamp(0.0, 0.9999).sqrt();
            let eta = (1.0 + root) / (1.0 - root);
            let contrast = (eta - self.eta) / (eta + self.eta);
            let f0 = contrast * contrast;
            let inner = f0 + (1.0 - f0) * schlick_weight(cos_inside);
            // Reflection from inside of the film turns light where that from outside does not.
            let turns = turned_above == (eta < self.eta);
            let sign = if turns { -1.0 } else { 1.0 };
            series(outer.r, inner, [cosines[0][i] * sign, cosines[1][i]])
        };
        Rgb::new(channel(0), channel(1), channel(2)).clamp(Rgb::ZERO, Rgb::ONE)
    }
}

/// The sum of all ways through the film, from the reflectances of its sides and the means of the
/// cosines of once and twice the phase (the paper's equations 8 to 11).
fn series(outer: f32, inner: f32, cosines: [f32; 2]) -> f32 {
    let through = 1.0 - outer;
    let both = (outer * inner).clamp(0.0, 0.9999);
    let inside = through * through * inner / (1.0 - both);
    let around = both.sqrt();
    let first = (inside - through) * around;
    outer + inside + 2.0 * (first * cosines[0] + first * around * cosines[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film(eta: f32, thickness: f32) -> ThinFilm {
        ThinFilm {
            strength: 1.0,
            eta,
            thickness,
        }
    }

    /// The exact reflectance of a film on a dielectric at one wavelength, for light at normal
    /// incidence (Born and Wolf, 7.6): the sum of all ways, by amplitudes.
    fn airy(eta: [f32; 2], phase: f32) -> f32 {
        let r1 = (1.0 - eta[0]) / (1.0 + eta[0]);
        let r2 = (eta[0] - eta[1]) / (eta[0] + eta[1]);
        let (cross, sum) = (2.0 * r1 * r2 * phase.cos(), r1 * r1 + r2 * r2);
        (sum + cross) / (1.0 + r1 * r1 * r2 * r2 + cross)
    }

    #[test]
    fn films_reflect_what_the_sum_of_their_amplitudes_says() {
        for (eta, base) in [(1.33, 1.0), (1.33, 1.5), (1.6, 1.5), (1.4, 1.4)] {
            let root: f32 = (base - 1.0) / (base + 1.0);
            for thickness in [0.0, 90.0, 250.0, 700.0] {
                let film = film(eta, thickness);
                let got = film.reflectance(Rgb::splat(root * root), 1.0);
                // Seen through the same Gaussians, but wavenumber by wavenumber.
                let mut xyz = Vec3::ZERO;
                for (part, height, middle, variance) in GAUSSIANS {
                    // The fit's exponent, twice the usual one, is that of twice the variance.
                    let deviation = (2.0 * variance).sqrt();
                    for i in -400..=400 {
                        let x = i as f32 * 0.015;
                        let path = 2.0 * eta * thickness * 1e-9;
                        let phase = TAU * path * (middle + x * deviation);
                        let weight = (-0.5 * x * x).exp() * 0.015 * variance.sqrt();
                        xyz[part] += height * weight * airy([eta, base], phase);
                    }
                }
                for i in 0..3 {
                    let row = RGB_OF_XYZ[i];
                    let exact = (row.dot(xyz) / row.element_sum()).clamp(0.0, 1.0);
                    assert!(
                        (got[i] - exact).abs() < 2e-3,
                        "{eta} {base} {thickness} {i}: {got} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_film_of_air_changes_nothing() {
        let bare = Rgb::new(0.04, 0.3, 0.9);
        let seen = film(1.0, 400.0).reflectance(bare, 1.0);
        assert!((seen - bare).abs().max_element() < 2e-3, "{seen}");
    }

    #[test]
    fn reflectances_are_fractions() {
        for eta in [1.0, 1.3, 2.5] {
            for i in 0..60 {
                for cos in [0.0, 0.01, 0.4, 1.0] {
                    let film = film(eta, 20.0 * i as f32);
                    let r = film.reflectance(Rgb::new(0.0, 0.5, 1.0), cos);
                    assert!(r.min_element() >= 0.0 && r.max_element() <= 1.0, "{r}");
                }
            }
        }
    }
}
