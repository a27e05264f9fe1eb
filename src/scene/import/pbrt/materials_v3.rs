//! Materials by v3's names, as the nearest of ours; how near is in the manual.

use super::importer::{Importer, Role};
use super::interfaces::{Made, metal, roughness};
use super::named_spectra::copper;
use super::params::Params;
use crate::bsdf::Material;
use crate::bsdf::material::{
    Conductor, Dielectric, Diffuse, Plastic, RoughDielectric, RoughDiffuse, RoughPlastic,
    Roughness, white,
};
use crate::math::{Rgb, luminance};
use crate::texture::{Computed, Texture};
use std::f32::consts::SQRT_2;
use std::sync::Arc;

/// The kinds of materials of v3 that are read.
pub(super) const MATERIALS: &[&str] = &[
    "matte",
    "plastic",
    "metal",
    "mirror",
    "glass",
    "uber",
    "substrate",
    "translucent",
];

impl<'s> Importer<'s> {
    /// A model of v3; `None` if there is none of that name.
    pub fn model_v3(&mut self, p: &Params<'_, 's>, kind: &str) -> Result<Option<Made>, String> {
        Ok(Some(match kind {
            "matte" => Made::Opaque(self.matte(p)),
            "mirror" => {
                let factor = self.texture(p, "Kr", Role::Reflectance, 0.9);
                let [eta, k] = [Rgb::ZERO, Rgb::ONE].map(Texture::Constant);
                let specular_reflectance = factor;
                Made::Opaque(
                    Conductor {
                        eta,
                        k,
                        specular_reflectance,
                    }
                    .into(),
                )
            }
            "metal" => {
                let copper = copper();
                let eta = self.texture_given(p, "eta", Role::Unbounded);
                let k = self.texture_given(p, "k", Role::Unbounded);
                let facets = self.facets_v3(p, 0.01);
                let of =
                    |given: Option<Texture>, default| given.unwrap_or(Texture::Constant(default));
                Made::Opaque(metal(of(eta, copper.0), of(k, copper.1), white(), facets))
            }
            "glass" => Made::Clear(self.glass(p)),
            "plastic" => Made::Opaque(self.plastic_v3(p, kind, 0.25, 0.1)),
            "uber" => {
                self.left_out(
                    p,
                    &["Kr", "Kt", "opacity"],
                    "the nearest model has no such part",
                );
                Made::Opaque(self.plastic_v3(p, kind, 0.25, 0.1))
            }
            "substrate" => Made::Opaque(self.plastic_v3(p, kind, 0.5, 0.1)),
            "translucent" => Made::Clear(self.translucent(p)),
            _ => return Ok(None),
        }))
    }

    /// Oren and Nayar's model, for a standard deviation of slopes in degrees.
    fn matte(&mut self, p: &Params<'_, 's>) -> Material {
        let reflectance = self.texture(p, "Kd", Role::Reflectance, 0.5);
        let sigma = self.texture(p, "sigma", Role::Number, 0.0);
        if sigma.constant() == Some(Rgb::ZERO) {
            return Diffuse { reflectance }.into();
        }
        // Ours divides by the square root of 2 what it takes for a slope.
        let alpha = sigma.scaled(Rgb::splat(SQRT_2.to_radians()));
        RoughDiffuse {
            reflectance,
            alpha,
            fast_approx: true,
        }
        .into()
    }

    fn glass(&mut self, p: &Params<'_, 's>) -> Material {
        let specular_reflectance = self.texture(p, "Kr", Role::Reflectance, 1.0);
        let specular_transmittance = self.texture(p, "Kt", Role::Reflectance, 1.0);
        let name = if p.has("index") { "index" } else { "eta" };
        let eta = self.index(p, name, 1.5);
        match self.facets_v3(p, 0.0) {
            None => Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            }
            .into(),
            Some(roughness) => RoughDielectric {
                eta,
                roughness,
                specular_reflectance,
                specular_transmittance,
            }
            .into(),
        }
    }

    /// A diffuse base and a glossy coat; v3 adds the two without bounces between them.
    fn plastic_v3(&mut self, p: &Params<'_, 's>, kind: &str, default: f32, rough: f32) -> Material {
        self.warn_at(
            p.at(),
            &format!(
                "\"{kind}\" is rendered as a coat over a diffuse base: the base is brighter at \
             grazing angles than in pbrt"
            ),
        );
        let diffuse_reflectance = self.texture(p, "Kd", Role::Reflectance, default);
        let specular_reflectance = self.texture(p, "Ks", Role::Reflectance, default);
        let name = if p.has("index") { "index" } else { "eta" };
        let eta = self.index(p, name, 1.5);
        match self.facets_v3(p, rough) {
            None => Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear: false,
            }
            .into(),
            Some(roughness) => RoughPlastic {
                eta,
                roughness,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear: false,
            }
            .into(),
        }
    }

    /// The diffuse part of v3's translucent.
    fn translucent(&mut self, p: &Params<'_, 's>) -> Material {
        let message = "\"translucent\" is rendered without its glossy part";
        self.warn_at(p.at(), message);
        p.ignore(&["Ks", "roughness", "remaproughness"]);
        let base = self.texture(p, "Kd", Role::Reflectance, 0.25);
        let mut part = |name| {
            let share = self.texture(p, name, Role::Reflectance, 0.5);
            base.clone().times(share).scaled(Rgb::splat(2.0))
        };
        let (reflectance, transmittance) = (part("reflect"), part("transmit"));
        self.reflects_and_transmits(reflectance, transmittance)
    }

    /// Microfacets by v3's curve from roughness to their width.
    fn facets_v3(&mut self, p: &Params<'_, 's>, default: f32) -> Option<Roughness> {
        let both = self.texture(p, "roughness", Role::Number, default);
        let u = self.texture_given(p, "uroughness", Role::Number);
        let v = self.texture_given(p, "vroughness", Role::Number);
        let mut alphas = [u, v].map(|given| given.unwrap_or_else(|| both.clone()));
        // v3 asks for smooth glass by a roughness of 0, before the curve.
        if alphas.iter().all(|a| a.constant() == Some(Rgb::ZERO)) {
            p.ignore(&["remaproughness"]);
            return None;
        }
        if p.boolean("remaproughness", true) {
            alphas = alphas.map(|alpha| match alpha.constant() {
                Some(rough) => Texture::Constant(Rgb::splat(remapped(luminance(rough)))),
                None => {
                    self.warn_at(
                        p.at(),
                        "the textured roughness is turned into a width by its square root",
                    );
                    Texture::Computed(Arc::new(Computed::SquareRoot(alpha)))
                }
            });
        }
        roughness(alphas)
    }
}

/// v3's curve: a polynomial in the logarithm of the roughness (its manual, "RoughnessToAlpha").
fn remapped(roughness: f32) -> f32 {
    const TERMS: [f32; 5] = [0.000_640_711, 0.017_120_1, 0.1734, 0.819_955, 1.621_42];
    let x = roughness.max(1e-3).ln();
    TERMS.iter().fold(0.0, |sum, term| sum * x + term)
}
