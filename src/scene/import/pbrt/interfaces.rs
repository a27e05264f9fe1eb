//! Models with a surface that is smooth or of microfacets: metals, glass, coats.

use super::importer::{Importer, Role};
use super::named_spectra::copper;
use super::params::Params;
use crate::bsdf::Material;
use crate::bsdf::material::{
    Conductor, Dielectric, Distribution, Plastic, RoughConductor, RoughDielectric, RoughPlastic,
    Roughness, ThinDielectric, white,
};
use crate::math::{Rgb, luminance};
use crate::texture::{Computed, Texture};
use std::sync::Arc;

/// Facets narrower than this count as smooth, as in pbrt.
const SMOOTH: f32 = 1e-3;
/// A reflectance of 1 would ask for an infinite index.
const MOST_REFLECTING: f32 = 0.9999;
/// Cosine at which light crosses a coat on average, for what the coat absorbs: between that of
/// light that came in from outside (0.75 to 1) and of diffuse light (0.67).
const MEAN_COSINE: f32 = 0.85;

/// What a model is: whether light can pass through decides whether both sides are made alike.
pub(super) enum Made {
    Opaque(Material),
    Clear(Material),
    /// Nothing more is to be laid around it.
    Whole(Material),
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

    /// A metal under a medium of index `outside`. `part` is what its names begin with.
    pub fn conductor(
        &mut self,
        p: &Params<'_, 's>,
        part: &'static str,
        outside: f32,
    ) -> Result<Material, String> {
        let [eta_name, k_name] = match part {
            "conductor" => ["conductor.eta", "conductor.k"],
            _ => ["eta", "k"],
        };
        let given = [eta_name, k_name].map(|name| self.texture_given(p, name, Role::Unbounded));
        let reflectance = self.texture_given(p, "reflectance", Role::Reflectance);
        let copper = copper();
        let (eta, k, factor) = match (reflectance, given) {
            (Some(_), [Some(_), _] | [_, Some(_)]) => {
                return Err(format!(
                    "give \"reflectance\", or \"{eta_name}\" and \"{k_name}\", not both"
                ));
            }
            (Some(reflectance), _) => self.of_reflectance(p, reflectance),
            (None, [eta, k]) => (
                eta.unwrap_or(Texture::Constant(copper.0)),
                k.unwrap_or(Texture::Constant(copper.1)),
                white(),
            ),
        };
        let beneath = |texture: Texture| texture.scaled(Rgb::splat(1.0 / outside));
        Ok(metal(
            beneath(eta),
            beneath(k),
            factor,
            self.facets(p, part, 0.0),
        ))
    }

    /// Index and factor of a metal of that reflectance at normal incidence: eta is 1 and
    /// k = 2 sqrt(r / (1 - r)).
    fn of_reflectance(&mut self, p: &Params, reflectance: Texture) -> (Texture, Texture, Texture) {
        if let Some(r) = reflectance.constant() {
            let r = r.clamp(Rgb::ZERO, Rgb::splat(MOST_REFLECTING));
            let k = (r / (Rgb::ONE - r)).map(f32::sqrt) * 2.0;
            return (white(), Texture::Constant(k), white());
        }
        self.warn_at(
            p.place_of("reflectance"),
            "the reflectance of this metal is an image: it does not grow towards grazing angles",
        );
        let mirror = [Rgb::ZERO, Rgb::ONE].map(Texture::Constant);
        let [eta, k] = mirror;
        (eta, k, reflectance)
    }

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

    /// A metal under a dielectric coat.
    pub fn coated_conductor(&mut self, p: &Params<'_, 's>) -> Result<Material, String> {
        let eta = self.index(p, "interface.eta", 1.5);
        let thickness = self.thickness(p);
        let metal = self.conductor(p, "conductor", eta)?;
        let inner = self.materials.push(metal);
        // pbrt's coat has sigma_t = 1 per unit of thickness.
        let (sigma_a, specular_reflectance) = (white(), white());
        Ok(match self.facets(p, "interface", 0.0) {
            None => Material::Coating {
                eta,
                thickness,
                sigma_a,
                specular_reflectance,
                inner,
            },
            Some(roughness) => {
                self.warn_of_anisotropy(p, &roughness);
                Material::RoughCoating {
                    eta,
                    roughness,
                    thickness,
                    sigma_a,
                    specular_reflectance,
                    inner,
                }
            }
        })
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
