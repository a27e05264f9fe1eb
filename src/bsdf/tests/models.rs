//! The models under test, by name: those of `tests/vectors/bsdf.py`, which Mitsuba can be asked
//! about, and those that only exist here and in Mitsuba 0.6.

use crate::bsdf::material::{
    Distribution, Material, MetallicRoughness, Principled, PrincipledThin, Roughness, Turning,
    WardVariant, white,
};
use crate::bsdf::{MaterialId, Materials};
use crate::math::Rgb;
use crate::texture::Texture;

pub(super) fn grey(v: f32) -> Texture {
    Texture::Constant(Rgb::splat(v))
}

pub(super) fn rgb(r: f32, g: f32, b: f32) -> Texture {
    Texture::Constant(Rgb::new(r, g, b))
}

fn base() -> Texture {
    rgb(0.7, 0.4, 0.1)
}

pub(super) fn facets(distribution: Distribution, u: f32, v: f32) -> Roughness {
    Roughness {
        distribution,
        alpha_u: grey(u),
        alpha_v: grey(v),
    }
}

pub(super) fn beckmann(alpha: f32) -> Roughness {
    facets(Distribution::Beckmann, alpha, alpha)
}

pub(super) fn ggx(alpha: f32) -> Roughness {
    facets(Distribution::Ggx, alpha, alpha)
}

pub(super) fn gold(roughness: Roughness) -> Material {
    Material::RoughConductor {
        eta: rgb(0.143, 0.375, 1.442),
        k: rgb(3.983, 2.386, 1.603),
        roughness,
        specular_reflectance: white(),
    }
}

pub(super) fn glass(eta: f32, roughness: Roughness) -> Material {
    Material::RoughDielectric {
        eta,
        roughness,
        specular_reflectance: white(),
        specular_transmittance: white(),
    }
}

pub(super) fn clear(eta: f32) -> Material {
    Material::Dielectric {
        eta,
        specular_reflectance: white(),
        specular_transmittance: white(),
    }
}

pub(super) fn diffuse() -> Material {
    Material::Diffuse {
        reflectance: rgb(0.2, 0.5, 0.8),
    }
}

pub(super) fn plastic(nonlinear: bool) -> Material {
    Material::Plastic {
        eta: 1.49,
        diffuse_reflectance: base(),
        specular_reflectance: white(),
        nonlinear,
    }
}

fn rough_plastic(eta: f32, roughness: Roughness, nonlinear: bool) -> Material {
    Material::RoughPlastic {
        eta,
        roughness,
        diffuse_reflectance: base(),
        specular_reflectance: white(),
        nonlinear,
    }
}

/// The principled model with everything optional off.
fn principled(roughness: f32, eta: f32) -> Principled {
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

fn principled_by(roughness: f32, eta: f32, change: impl FnOnce(&mut Principled)) -> Material {
    let mut p = principled(roughness, eta);
    change(&mut p);
    Material::Principled(Box::new(p))
}

pub(super) fn metallic_roughness(roughness: f32, metallic: f32) -> Material {
    Material::MetallicRoughness(Box::new(MetallicRoughness {
        base_color: base(),
        metallic: grey(metallic),
        roughness: grey(roughness),
        eta: 1.5,
    }))
}

fn sheet() -> Material {
    Material::PrincipledThin(Box::new(PrincipledThin {
        base_color: base(),
        roughness: grey(0.5),
        anisotropic: grey(0.4),
        spec_trans: grey(0.6),
        eta: grey(1.4),
        spec_tint: grey(0.3),
        sheen: grey(0.5),
        sheen_tint: grey(0.5),
        flatness: grey(0.4),
        diff_trans: grey(0.7),
    }))
}

fn ward(variant: WardVariant) -> Material {
    Material::Ward {
        variant,
        diffuse_reflectance: rgb(0.3, 0.2, 0.1),
        specular_reflectance: grey(0.4),
        alpha_u: grey(0.2),
        alpha_v: grey(0.35),
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

/// Models that stand by themselves.
fn single(name: &str) -> Option<Material> {
    use Distribution::{Beckmann, Ggx};
    Some(match name {
        "diffuse" => diffuse(),
        "rough_conductor_beckmann" => gold(beckmann(0.2)),
        "rough_conductor_ggx" => gold(ggx(0.3)),
        "rough_conductor_anisotropic" => gold(facets(Ggx, 0.15, 0.5)),
        "rough_conductor_beckmann_anisotropic" => gold(facets(Beckmann, 0.4, 0.1)),
        "rough_dielectric_beckmann" => glass(1.5, beckmann(0.25)),
        "rough_dielectric_ggx" => glass(1.33, facets(Ggx, 0.3, 0.6)),
        "plastic" => plastic(false),
        "plastic_nonlinear" => plastic(true),
        "rough_plastic_beckmann" => rough_plastic(1.49, beckmann(0.15), false),
        "rough_plastic_ggx" => rough_plastic(1.7, ggx(0.4), true),
        "principled_metal" => principled_by(0.4, 1.5, |p| {
            p.anisotropic = grey(0.6);
            p.metallic = grey(0.7);
            p.spec_tint = grey(0.4);
            p.clearcoat = grey(0.6);
            p.clearcoat_gloss = grey(0.3);
        }),
        "principled_cloth" => principled_by(0.7, 1.4, |p| {
            p.sheen = grey(0.8);
            p.sheen_tint = grey(0.5);
            p.flatness = grey(0.6);
        }),
        "principled_glass" => principled_by(0.5, 1.5, |p| {
            p.spec_trans = grey(0.8);
            p.metallic = grey(0.1);
            p.spec_tint = grey(0.3);
        }),
        "principled_thin" => sheet(),
        "metallic_roughness" => metallic_roughness(0.4, 0.3),
        "metallic_roughness_dielectric" => metallic_roughness(0.7, 0.0),
        _ => return mirror_like(name),
    })
}

/// Models with delta parts, and those of Mitsuba 0.6.
fn mirror_like(name: &str) -> Option<Material> {
    Some(match name {
        "dielectric" => clear(1.5),
        "thin_dielectric" => Material::ThinDielectric {
            eta: 1.5,
            specular_reflectance: white(),
            specular_transmittance: white(),
        },
        "conductor" => Material::Conductor {
            eta: rgb(0.143, 0.375, 1.442),
            k: rgb(3.983, 2.386, 1.603),
            specular_reflectance: white(),
        },
        "null" => Material::Null,
        "rough_diffuse" | "rough_diffuse_fast" => Material::RoughDiffuse {
            reflectance: rgb(0.2, 0.5, 0.8),
            alpha: grey(0.5),
            fast_approx: name == "rough_diffuse_fast",
        },
        "diffuse_transmitter" => Material::DiffuseTransmitter {
            transmittance: rgb(0.2, 0.5, 0.8),
        },
        "phong" => Material::Phong {
            diffuse_reflectance: rgb(0.3, 0.2, 0.1),
            specular_reflectance: grey(0.4),
            exponent: grey(20.0),
        },
        "ward" => ward(WardVariant::Ward),
        "ward_duer" => ward(WardVariant::WardDuer),
        "ward_balanced" => ward(WardVariant::Balanced),
        _ => return None,
    })
}

/// Adds the named model and everything inside it.
pub(super) fn add(materials: &mut Materials, name: &str) -> MaterialId {
    if let Some(material) = single(name) {
        return materials.push(material);
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
            turning: Turning::default(),
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
        _ => panic!("no model of the name {name}"),
    };
    materials.push(material)
}

/// Every model with a smooth part.
pub(super) const SMOOTH: [&str; 33] = [
    "diffuse",
    "rough_diffuse",
    "rough_diffuse_fast",
    "diffuse_transmitter",
    "rough_conductor_beckmann",
    "rough_conductor_ggx",
    "rough_conductor_anisotropic",
    "rough_conductor_beckmann_anisotropic",
    "rough_dielectric_beckmann",
    "rough_dielectric_ggx",
    "plastic",
    "plastic_nonlinear",
    "rough_plastic_beckmann",
    "rough_plastic_ggx",
    "phong",
    "ward",
    "ward_duer",
    "ward_balanced",
    "principled_metal",
    "principled_cloth",
    "principled_glass",
    "principled_thin",
    "metallic_roughness",
    "metallic_roughness_dielectric",
    "blend",
    "mixture",
    "normal_map",
    "two_sided",
    "two_sided_nest",
    "coating",
    "coated_diffuse",
    "rough_coating",
    "rough_coated_diffuse",
];

/// Models of delta parts alone.
pub(super) const DELTA: [&str; 4] = ["dielectric", "thin_dielectric", "conductor", "null"];
