//! Materials that light enters: skin, marble, hair.

use super::importer::{Importer, Role};
use super::params::Params;
use crate::bsdf::{Material, MaterialId};
use crate::math::{Rgb, luminance};
use crate::medium::{Homogeneous, Medium, PhaseLobe};
use crate::texture::Texture;

/// Stands for the material that is being made, before it has a number.
pub(super) const PENDING: MaterialId = MaterialId::MAX;

impl<'s> Importer<'s> {
    /// A dielectric with a scattering medium inside: what pbrt approximates by a diffusion profile
    /// is followed path by path.
    pub fn subsurface(&mut self, p: &Params<'_, 's>) -> Result<Material, String> {
        self.warn_at(
            p.at(),
            "\"subsurface\" is rendered as glass around a scattering medium; shapes of it must be \
             closed",
        );
        let scale = p.float("scale", 1.0) as f32;
        let g = p.float_in("g", 0.0, -1.0..=1.0) as f32;
        let given = ["sigma_a", "sigma_s", "reflectance", "mfp"];
        let [sigma_a, sigma_s, reflectance, mfp] = given.map(|name| {
            let role = match name {
                "reflectance" => Role::Reflectance,
                _ => Role::Unbounded,
            };
            self.mean_given(p, name, role)
        });
        let (sigma_a, sigma_s) = match (p.text("name"), sigma_a, sigma_s, reflectance) {
            (Some(name), ..) => super::presets::coefficients(name)?,
            (None, Some(a), Some(s), _) => (a, s),
            (None, Some(_), None, _) | (None, None, Some(_), _) => {
                return Err("\"sigma_a\" and \"sigma_s\" go together".into());
            }
            (None, None, None, Some(r)) => by_reflectance(r, mfp.unwrap_or(Rgb::ONE)),
            (None, None, None, None) => {
                (Rgb::new(0.0011, 0.0024, 0.014), Rgb::new(2.55, 3.21, 3.77))
            }
        };
        let medium = self.media.push(Medium {
            name: "subsurface".into(),
            extinction: homogeneous(sigma_a * scale, sigma_s * scale).into(),
            phase: PhaseLobe::henyey_greenstein(g).into(),
        });
        self.subsurface_of.insert(PENDING, medium);
        if !p.has("eta") {
            let mut glass = self.dielectric(p);
            set_eta(&mut glass, 1.33);
            return Ok(glass);
        }
        Ok(self.dielectric(p))
    }

    /// The nearest of ours to hair: a coat over a diffuse base of its colour.
    pub fn hair(&mut self, p: &Params<'_, 's>) -> Material {
        self.warn_at(
            p.at(),
            "\"hair\" is rendered as a rough coat over its colour: it has no transmission and no \
             highlight of its own",
        );
        let eta = self.index(p, "eta", 1.55);
        let smooth = self.texture(p, "beta_n", Role::Number, 0.3);
        p.ignore(&["beta_m", "alpha"]);
        let color = ["reflectance", "color"]
            .into_iter()
            .find(|name| p.has(name));
        let color = match color {
            Some(name) => self.texture(p, name, Role::Reflectance, 0.5),
            None => {
                let of = |importer: &mut Self, name| {
                    let given = importer.mean_given(p, name, Role::Number);
                    given.map(luminance)
                };
                let absorbed = self.mean_given(p, "sigma_a", Role::Unbounded);
                let (eu, pheo) = (of(self, "eumelanin"), of(self, "pheomelanin"));
                let sigma_a = absorbed.unwrap_or_else(|| pigment(eu, pheo));
                Texture::Constant(hair_color(sigma_a, luminance(smooth.mean())))
            }
        };
        self.plastic(p, eta, color, Texture::Constant(Rgb::ONE), 0.3)
    }
}

fn set_eta(material: &mut Material, value: f32) {
    match material {
        Material::Dielectric(glass) => glass.eta = value,
        Material::RoughDielectric(glass) => glass.eta = value,
        _ => {}
    }
}

/// Extinction and albedo of absorption and scattering coefficients.
pub(super) fn homogeneous(sigma_a: Rgb, sigma_s: Rgb) -> Homogeneous {
    let extinction = (sigma_a + sigma_s).min(Rgb::MAX);
    let albedo = sigma_s / extinction.max(Rgb::splat(f32::MIN_POSITIVE));
    Homogeneous {
        extinction,
        albedo: albedo.clamp(Rgb::ZERO, Rgb::ONE),
    }
}

/// Coefficients of a medium with that diffuse reflectance and mean free path: the fit of Chiang,
/// Kutz and Burley ("Practical and Controllable Subsurface Scattering for Production Path Tracing",
/// 2016).
fn by_reflectance(r: Rgb, mfp: Rgb) -> (Rgb, Rgb) {
    let albedo = r.map(|a| 1.0 - (-5.094_06 * a + 2.611_88 * a * a - 4.318_05 * a * a * a).exp());
    let extinction = Rgb::ONE / mfp.max(Rgb::splat(1e-6));
    ((Rgb::ONE - albedo) * extinction, albedo * extinction)
}

/// Absorption of hair by its pigments; 1.3 of eumelanin (brown) where nothing is said.
fn pigment(eumelanin: Option<f32>, pheomelanin: Option<f32>) -> Rgb {
    let (eu, pheo) = match (eumelanin, pheomelanin) {
        (None, None) => (1.3, 0.0),
        (eu, pheo) => (eu.unwrap_or(0.0), pheo.unwrap_or(0.0)),
    };
    Rgb::new(0.419, 0.697, 1.37) * eu + Rgb::new(0.187, 0.4, 1.05) * pheo
}

/// Colour of a mass of hair of that absorption and azimuthal roughness (Chiang et al., "A Practical
/// and Controllable Hair and Fur Model for Production Path Tracing", 2016).
fn hair_color(sigma_a: Rgb, b: f32) -> Rgb {
    const TERMS: [f32; 6] = [0.245, 5.574, -10.73, 2.532, -0.215, 5.969];
    let denominator = TERMS.iter().fold(0.0, |sum, term| sum * b + term);
    sigma_a.map(|sigma| (-sigma.max(0.0).sqrt() * denominator).exp())
}
