//! Models with a surface that is smooth or of microfacets: metals and glass. Coats are in
//! [`super::coats`].

use super::importer::{Importer, Role};
use super::named_spectra::copper;
use super::params::Params;
use crate::bsdf::Material;
use crate::bsdf::material::{
    Conductor, Dielectric, Distribution, RoughConductor, RoughDielectric, Roughness,
    ThinDielectric, white,
};
use crate::math::{Rgb, luminance};
use crate::texture::{Computed, Texture};
use std::sync::Arc;

/// Facets narrower than this count as smooth, as in pbrt.
const SMOOTH: f32 = 1e-3;
/// A reflectance of 1 would ask for an infinite index.
const MOST_REFLECTING: f32 = 0.9999;
/// What a model is: whether light can pass through decides whether both sides are made alike.
pub(super) enum Made {
    Opaque(Material),
    Clear(Material),
    /// Nothing more is to be laid around it.
    Whole(Material),
}

/// Index and absorption of a metal, and a factor on what it reflects.
pub(super) struct Constants {
    pub eta: Texture,
    pub k: Texture,
    pub factor: Texture,
}

/// The names of what says how rough a surface is.
struct Names {
    both: &'static str,
    u: &'static str,
    v: &'static str,
}

fn names(part: &str) -> Names {
    let of = |both, u, v| Names { both, u, v };
    match part {
        "interface" => of(
            "interface.roughness",
            "interface.uroughness",
            "interface.vroughness",
        ),
        "conductor" => of(
            "conductor.roughness",
            "conductor.uroughness",
            "conductor.vroughness",
        ),
        _ => of("roughness", "uroughness", "vroughness"),
    }
}

impl<'s> Importer<'s> {
    /// Widths of microfacets along u and v; `None` where the surface is smooth.
    pub fn facets(&mut self, p: &Params<'_, 's>, part: &str, default: f32) -> Option<Roughness> {
        let names = names(part);
        let both = self.texture(p, names.both, Role::Number, default);
        let u = self.texture_given(p, names.u, Role::Number);
        let v = self.texture_given(p, names.v, Role::Number);
        let alphas = [u, v].map(|given| given.unwrap_or_else(|| both.clone()));
        let alphas = match p.boolean("remaproughness", true) {
            true => alphas.map(square_root),
            false => alphas,
        };
        roughness(alphas)
    }

    pub fn dielectric(&mut self, p: &Params<'_, 's>) -> Material {
        let eta = self.index(p, "eta", 1.5);
        let (reflectance, transmittance) = (white(), white());
        match self.facets(p, "", 0.0) {
            None => Dielectric {
                eta,
                specular_reflectance: reflectance,
                specular_transmittance: transmittance,
            }
            .into(),
            Some(roughness) => RoughDielectric {
                eta,
                roughness,
                specular_reflectance: reflectance,
                specular_transmittance: transmittance,
            }
            .into(),
        }
    }

    pub fn thin_dielectric(&mut self, p: &Params<'_, 's>) -> Material {
        ThinDielectric {
            eta: self.index(p, "eta", 1.5),
            specular_reflectance: white(),
            specular_transmittance: white(),
        }
        .into()
    }

    /// A metal.
    pub fn conductor(&mut self, p: &Params<'_, 's>) -> Result<Material, String> {
        let Constants { eta, k, factor } = self.constants(p, ["eta", "k"])?;
        Ok(metal(eta, k, factor, self.facets(p, "", 0.0)))
    }

    /// What a metal is made of, by the names of its index and absorption.
    pub fn constants(
        &mut self,
        p: &Params<'_, 's>,
        [eta_name, k_name]: [&'static str; 2],
    ) -> Result<Constants, String> {
        let given = [eta_name, k_name].map(|name| self.texture_given(p, name, Role::Unbounded));
        let reflectance = self.texture_given(p, "reflectance", Role::Reflectance);
        let copper = copper();
        match (reflectance, given) {
            (Some(_), [Some(_), _] | [_, Some(_)]) => Err(format!(
                "give \"reflectance\", or \"{eta_name}\" and \"{k_name}\", not both"
            )),
            (Some(reflectance), _) => Ok(self.of_reflectance(p, reflectance)),
            (None, [eta, k]) => Ok(Constants {
                eta: eta.unwrap_or(Texture::Constant(copper.0)),
                k: k.unwrap_or(Texture::Constant(copper.1)),
                factor: white(),
            }),
        }
    }

    /// Index and factor of a metal of that reflectance at normal incidence: eta is 1 and
    /// k = 2 sqrt(r / (1 - r)).
    fn of_reflectance(&mut self, p: &Params, reflectance: Texture) -> Constants {
        if let Some(r) = reflectance.constant() {
            let r = r.clamp(Rgb::ZERO, Rgb::splat(MOST_REFLECTING));
            let k = (r / (Rgb::ONE - r)).map(f32::sqrt) * 2.0;
            return Constants {
                eta: white(),
                k: Texture::Constant(k),
                factor: white(),
            };
        }
        self.warn_at(
            p.place_of("reflectance"),
            "the reflectance of this metal is an image: it does not grow towards grazing angles",
        );
        let [eta, k] = [Rgb::ZERO, Rgb::ONE].map(Texture::Constant);
        Constants {
            eta,
            k,
            factor: reflectance,
        }
    }
}

/// Microfacets of these widths; `None` for a smooth surface.
pub(super) fn roughness([alpha_u, alpha_v]: [Texture; 2]) -> Option<Roughness> {
    let constant = [&alpha_u, &alpha_v].map(|t| t.constant().map(luminance));
    if let [Some(u), Some(v)] = constant {
        if u.max(v) < SMOOTH {
            return None;
        }
    }
    let least = Rgb::splat(1e-4);
    let [alpha_u, alpha_v] = [alpha_u, alpha_v].map(|texture| match texture {
        Texture::Constant(c) => Texture::Constant(c.max(least)),
        varying => varying,
    });
    Some(Roughness {
        distribution: Distribution::Ggx,
        alpha_u,
        alpha_v,
    })
}

/// A metal, smooth or rough.
pub(super) fn metal(
    eta: Texture,
    k: Texture,
    factor: Texture,
    facets: Option<Roughness>,
) -> Material {
    match facets {
        None => Conductor {
            eta,
            k,
            specular_reflectance: factor,
        }
        .into(),
        Some(roughness) => RoughConductor {
            eta,
            k,
            roughness,
            specular_reflectance: factor,
        }
        .into(),
    }
}

fn square_root(texture: Texture) -> Texture {
    let root = Computed::SquareRoot(texture);
    let constant = root.constant();
    constant.map_or_else(|| Texture::Computed(Arc::new(root)), Texture::Constant)
}
