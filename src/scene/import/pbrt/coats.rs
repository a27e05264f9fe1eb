//! Bases under a dielectric coat: diffuse ones and metals.

use super::importer::{Importer, Role};
use super::interfaces::{Constants, metal, roughness};
use super::params::Params;
use crate::bsdf::Material;
use crate::bsdf::material::{Plastic, RoughPlastic, Roughness, white};
use crate::math::{Rgb, luminance};
use crate::texture::Texture;

/// Cosine at which light crosses a coat on average, for what the coat absorbs: between that of
/// light that came in from outside (0.75 to 1) and of diffuse light (0.67).
const MEAN_COSINE: f32 = 0.85;

impl<'s> Importer<'s> {
    /// A diffuse base under a dielectric coat. pbrt follows a random walk between the two; here
    /// their sum has a closed form with the same bounces, in which light that returned from the
    /// coat is diffuse. What the coat absorbs (pbrt's sigma_t is 1 per unit, thickness 0.01) dims
    /// the base.
    pub fn coated_diffuse(&mut self, p: &Params<'_, 's>) -> Material {
        let eta = self.index(p, "eta", 1.5);
        let thickness = self.thickness(p);
        let base = self.texture(p, "reflectance", Role::Reflectance, 0.5);
        let passes = (-2.0 * thickness / MEAN_COSINE).exp();
        self.plastic(p, eta, base.scaled(Rgb::splat(passes)), white(), 0.0)
    }

    /// A coat over a diffuse base, smooth or rough.
    pub fn plastic(
        &mut self,
        p: &Params<'_, 's>,
        eta: f32,
        diffuse_reflectance: Texture,
        specular_reflectance: Texture,
        default: f32,
    ) -> Material {
        match self.facets(p, "", default) {
            None => Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                nonlinear: true,
            }
            .into(),
            Some(roughness) => {
                self.warn_of_anisotropy(p, &roughness);
                RoughPlastic {
                    eta,
                    roughness,
                    diffuse_reflectance,
                    specular_reflectance,
                    nonlinear: true,
                }
                .into()
            }
        }
    }

    fn warn_of_anisotropy(&mut self, p: &Params, roughness: &Roughness) {
        let (u, v) = (roughness.alpha_u.constant(), roughness.alpha_v.constant());
        if u != v {
            self.warn_at(
                p.at(),
                "the coat is as rough along v as along u: anisotropic coats are left out",
            );
        }
    }

    /// The optical thickness of a coat, and what of its inside is left out.
    fn thickness(&mut self, p: &Params<'_, 's>) -> f32 {
        // How many samples the random walk takes, and how long it may get.
        p.ignore(&["maxdepth", "nsamples"]);
        let what = "the coat absorbs, but does not scatter inside";
        let scatters = self.texture_given(p, "albedo", Role::Reflectance);
        if scatters.is_some_and(|albedo| albedo.mean() != Rgb::ZERO) {
            self.left_out(p, &["albedo", "g"], what);
        } else {
            p.ignore(&["g"]);
        }
        let thickness = self.mean_given(p, "thickness", Role::Number);
        thickness.map_or(0.01, luminance).max(0.0)
    }

    /// A metal under a dielectric coat, the nearest of ours to pbrt's random walk between the two.
    ///
    /// Ours is Mitsuba's coating, in which light passes the coat, meets the metal once and passes
    /// the coat again, without being turned by a rough one. Two constants make up for the rest;
    /// they are fitted to the walk for roughnesses of both from 0 to 0.5, over copper, by the light
    /// that is reflected in all: facets of the metal are wider under a rough coat, and bounces
    /// below the coat add what [`caught`] says.
    pub fn coated_conductor(&mut self, p: &Params<'_, 's>) -> Result<Material, String> {
        self.warn_at(
            p.at(),
            "\"coatedconductor\" is rendered without bounces between coat and metal: its light is \
             within 18 % of pbrt's",
        );
        let index = self.index(p, "interface.eta", 1.5);
        let thickness = self.thickness(p);
        let Constants { eta, k, factor } = self.constants(p, ["conductor.eta", "conductor.k"])?;
        let [eta, k] = [eta, k].map(|texture| texture.scaled(Rgb::splat(1.0 / index)));
        let coat = self.facets(p, "interface", 0.0);
        let own = self.facets(p, "conductor", 0.0);
        let facets = self.widened(p, own, coat.as_ref());
        let factor = match [&eta, &k, &factor].map(Texture::constant) {
            [Some(eta), Some(k), Some(white)] => {
                let width = facets.as_ref().map_or(0.0, |f| luminance(f.alpha_u.mean()));
                Texture::Constant(white * caught(eta, k, width))
            }
            _ => factor,
        };
        let inner = self.materials.push(metal(eta, k, factor, facets));
        // pbrt's coat has sigma_t = 1 per unit of thickness.
        let (sigma_a, specular_reflectance) = (white(), white());
        Ok(match coat {
            None => Material::Coating {
                eta: index,
                thickness,
                sigma_a,
                specular_reflectance,
                inner,
            },
            Some(roughness) => {
                self.warn_of_anisotropy(p, &roughness);
                Material::RoughCoating {
                    eta: index,
                    roughness,
                    thickness,
                    sigma_a,
                    specular_reflectance,
                    inner,
                }
            }
        })
    }

    /// Facets of a metal with what a coat adds to their widths, as variances add.
    fn widened(
        &mut self,
        p: &Params,
        own: Option<Roughness>,
        coat: Option<&Roughness>,
    ) -> Option<Roughness> {
        let Some(coat) = coat else {
            return own;
        };
        let coat = (luminance(coat.alpha_u.mean()) * luminance(coat.alpha_v.mean())).sqrt();
        let added = (WIDENING * coat).powi(2);
        let alphas = own.map(|own| [own.alpha_u, own.alpha_v]);
        let alphas = alphas.unwrap_or([Rgb::ZERO, Rgb::ZERO].map(Texture::Constant));
        if alphas.iter().any(|alpha| alpha.constant().is_none()) {
            self.warn_at(
                p.at(),
                "the metal's textured roughness is left as it is below a rough coat, which would \
                 widen its highlights",
            );
            return roughness(alphas);
        }
        roughness(alphas.map(|alpha| {
            let alpha = luminance(alpha.mean());
            Texture::Constant(Rgb::splat((alpha * alpha + added).sqrt()))
        }))
    }
}

/// How much the facets of a metal are widened by those of its coat.
const WIDENING: f32 = 0.65;

/// What the light that a coat sends back to its metal adds, as a factor: `1 / (1 - f R)` with the
/// metal's reflectance R at normal incidence and the part f that the coat sends back, more of it
/// the wider the metal scatters. Facets that scatter as widely lose more than that by themselves, so
/// that no more than all light is reflected.
fn caught(eta: Rgb, k: Rgb, width: f32) -> Rgb {
    let squares = (eta - 1.0) * (eta - 1.0) + k * k;
    let reflectance = squares / ((eta + 1.0) * (eta + 1.0) + k * k);
    let part = (0.8 * width).min(0.3);
    Rgb::ONE / (Rgb::ONE - reflectance * part)
}
