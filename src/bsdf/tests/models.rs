//! The models under test, by name: the examples that stand beside each model, and materials around
//! them. Those of `tests/vectors/bsdf.py` Mitsuba can be asked about.

use crate::bsdf::material::{
    Dielectric, Diffuse, Distribution, InvalidNormals, Material, Measured, MetallicRoughness,
    Plastic, Principled, RoughConductor, RoughDielectric, Roughness, white,
};
use crate::bsdf::{MaterialId, Materials};
use crate::math::Rgb;
use crate::texture::Texture;
use std::path::Path;
use std::sync::LazyLock;

pub(in crate::bsdf) fn grey(v: f32) -> Texture {
    Texture::Constant(Rgb::splat(v))
}

pub(in crate::bsdf) fn rgb(r: f32, g: f32, b: f32) -> Texture {
    Texture::Constant(Rgb::new(r, g, b))
}

pub(in crate::bsdf) fn base() -> Texture {
    rgb(0.7, 0.4, 0.1)
}

pub(in crate::bsdf) fn facets(distribution: Distribution, u: f32, v: f32) -> Roughness {
    Roughness {
        distribution,
        alpha_u: grey(u),
        alpha_v: grey(v),
    }
}

pub(in crate::bsdf) fn beckmann(alpha: f32) -> Roughness {
    facets(Distribution::Beckmann, alpha, alpha)
}

pub(in crate::bsdf) fn ggx(alpha: f32) -> Roughness {
    facets(Distribution::Ggx, alpha, alpha)
}

pub(in crate::bsdf) fn gold(roughness: Roughness) -> RoughConductor {
    RoughConductor {
        eta: rgb(0.143, 0.375, 1.442),
        k: rgb(3.983, 2.386, 1.603),
        roughness,
        specular_reflectance: white(),
    }
}

pub(in crate::bsdf) fn glass(eta: f32, roughness: Roughness) -> RoughDielectric {
    RoughDielectric {
        eta,
        roughness,
        specular_reflectance: white(),
        specular_transmittance: white(),
    }
}

pub(in crate::bsdf) fn clear(eta: f32) -> Dielectric {
    Dielectric {
        eta,
        specular_reflectance: white(),
        specular_transmittance: white(),
    }
}

pub(in crate::bsdf) fn diffuse() -> Diffuse {
    Diffuse {
        reflectance: rgb(0.2, 0.5, 0.8),
    }
}

pub(in crate::bsdf) fn plastic(nonlinear: bool) -> Plastic {
    Plastic {
        eta: 1.49,
        diffuse_reflectance: base(),
        specular_reflectance: white(),
        nonlinear,
    }
}

/// The principled model with everything optional off.
pub(in crate::bsdf) fn principled(roughness: f32, eta: f32) -> Principled {
    let off = || grey(0.0);
    Principled {
        base_color: base(),
        roughness: grey(roughness),
        anisotropic: off(),
        metallic: off(),
        spec_trans: off(),
        eta,
        spec_tint: off(),
        sheen: off(),
        sheen_tint: off(),
        flatness: off(),
        clearcoat: off(),
        clearcoat_gloss: off(),
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
        diffuse_reflectance_sampling_rate: 1.0,
    }
}

pub(in crate::bsdf) fn metallic_roughness(roughness: f32, metallic: f32) -> MetallicRoughness {
    MetallicRoughness::plain(base(), grey(metallic), grey(roughness), 1.5)
}

/// A table that `tests/vectors/measured/measured.py` made.
pub(in crate::bsdf) fn tabulated(file: &str) -> Measured {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/measured");
    let brdf = crate::scene::import::measured::read(&folder.join(file));
    Measured {
        brdf: brdf.expect("a measured material"),
    }
}

fn coating(inner: MaterialId) -> Material {
    Material::Coating {
        eta: 1.5,
        thickness: 0.5,
        sigma_a: rgb(0.1, 0.4, 0.9),
        specular_reflectance: white(),
        inner,
    }
}

fn rough_coating(inner: MaterialId) -> Material {
    Material::RoughCoating {
        eta: 1.5,
        roughness: beckmann(0.2),
        thickness: 0.5,
        sigma_a: rgb(0.1, 0.4, 0.9),
        specular_reflectance: white(),
        inner,
    }
}

static EXAMPLES: LazyLock<Vec<(&str, Material)>> = LazyLock::new(Material::examples);

/// Adds the named model and everything inside it.
pub(super) fn add(materials: &mut Materials, name: &str) -> MaterialId {
    if let Some((_, material)) = EXAMPLES.iter().find(|(n, _)| *n == name) {
        return materials.push(material.clone());
    }
    let mut inner = |name: &str| add(materials, name);
    let material = match name {
        "blend" => Material::Blend {
            weight: grey(0.3),
            first: inner("diffuse"),
            second: inner("rough_conductor_ggx"),
        },
        "mixture" => Material::Mixture {
            parts: vec![
                (0.2, inner("diffuse")),
                (0.5, inner("rough_conductor_beckmann")),
                (0.2, inner("diffuse_transmitter")),
            ],
        },
        "normal_map" => Material::NormalMap {
            normals: rgb(0.65, 0.42, 0.9),
            invalid_normals: InvalidNormals::default(),
            inner: inner("rough_conductor_anisotropic"),
        },
        "two_sided" => {
            let side = inner("diffuse");
            Material::TwoSided {
                front: side,
                back: side,
            }
        }
        "two_sided_nest" => Material::TwoSided {
            front: inner("diffuse"),
            back: inner("normal_map"),
        },
        "coating" => coating(inner("rough_conductor_beckmann")),
        "coated_diffuse" => coating(inner("diffuse")),
        "rough_coating" => rough_coating(inner("rough_conductor_ggx")),
        "rough_coated_diffuse" => rough_coating(inner("diffuse")),
        "clear_coat" => Material::ClearCoat {
            weight: grey(0.8),
            roughness: grey(0.5),
            inner: inner("metallic_roughness"),
        },
        "clear_coat_over_glass" => Material::ClearCoat {
            weight: grey(1.0),
            roughness: grey(0.4),
            inner: inner("principled_glass"),
        },
        "sheen" => Material::Sheen {
            color: Texture::Constant(Rgb::new(0.9, 0.5, 0.2)),
            roughness: grey(0.4),
            inner: inner("metallic_roughness"),
        },
        "sheen_over_glass" => Material::Sheen {
            color: grey(1.0),
            roughness: grey(0.9),
            inner: inner("principled_glass"),
        },
        _ => panic!("no model of the name {name}"),
    };
    materials.push(material)
}

/// The examples that scatter to more than a few discrete directions, or the others.
fn examples(scattering: bool) -> impl Iterator<Item = &'static str> {
    let scatters = |m: &Material| m.model().is_some_and(|m| m.scatters());
    let chosen = EXAMPLES
        .iter()
        .filter(move |(_, m)| scatters(m) == scattering);
    chosen.map(|(name, _)| *name)
}

/// Everything with a smooth part.
pub(super) fn smooth() -> Vec<&'static str> {
    let around = [
        "blend",
        "mixture",
        "normal_map",
        "two_sided",
        "two_sided_nest",
        "coating",
        "coated_diffuse",
        "rough_coating",
        "rough_coated_diffuse",
        "clear_coat",
        "clear_coat_over_glass",
        "sheen",
        "sheen_over_glass",
    ];
    examples(true).chain(around).collect()
}

/// Everything, models of delta parts alone included.
pub(super) fn all() -> Vec<&'static str> {
    [smooth(), examples(false).collect()].concat()
}
