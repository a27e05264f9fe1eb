//! Numbers at the ends of their ranges: random numbers, angles, indices, roughnesses and colours.
//! Every result is finite and not negative.

use super::models::{all, beckmann, clear, facets, ggx, glass, gold, grey, plastic};
use super::{of_material, resolved};
use crate::bsdf::material::{
    Dielectric, Diffuse, Distribution, InvalidNormals, Material, Phong, Plastic, RoughDielectric,
    RoughPlastic, white,
};
use crate::bsdf::{Bsdf, Transport};
use crate::math::{Rgb, Vec2, Vec3};

const RANDOM: [f32; 4] = [0.0, 2.328_306_4e-10, 0.5, 1.0 - f32::EPSILON * 0.5];

/// Directions at and around the horizon, the normal and the tangents.
fn corners() -> Vec<Vec3> {
    let mut list = Vec::new();
    for z in [0.0, 1e-20, 1e-8, 1e-4, 0.5, 1.0] {
        for phi in [0.0f32, 1.0, 3.0] {
            let r = (1.0f32 - z * z).max(0.0).sqrt();
            list.push(Vec3::new(r * phi.cos(), r * phi.sin(), z));
            list.push(Vec3::new(r * phi.cos(), r * phi.sin(), -z));
        }
    }
    list
}

/// Asks for everything at the corners of all ranges.
fn probe(what: &str, make: impl Fn(Vec3) -> Bsdf) {
    for wo in corners() {
        let bsdf = make(wo);
        for transport in [Transport::Radiance, Transport::Importance] {
            for wi in corners() {
                let (value, pdf) = bsdf.eval_pdf(wo, wi, transport);
                assert!(
                    value.is_finite() && value.min_element() >= 0.0,
                    "{what} {wo} {wi}: {value}"
                );
                assert!(pdf.is_finite() && pdf >= 0.0, "{what} {wo} {wi}: {pdf}");
            }
            for i in 0..64 {
                let u = Vec2::new(RANDOM[i % 4], RANDOM[i / 4 % 4]);
                let Some(s) = bsdf.sample(wo, RANDOM[i / 16], u, transport) else {
                    continue;
                };
                let fine = s.weight.is_finite() && s.weight.min_element() >= 0.0;
                assert!(
                    fine && s.weight.max_element() > 0.0,
                    "{what} {wo} {u}: {}",
                    s.weight
                );
                assert!(
                    s.pdf.is_finite() && s.pdf > 0.0,
                    "{what} {wo} {u}: {}",
                    s.pdf
                );
                assert!(
                    (s.wi.length() - 1.0).abs() < 1e-5,
                    "{what} {wo} {u}: {}",
                    s.wi
                );
                assert!(s.eta.is_finite() && s.eta > 0.0, "{what}");
                let (value, pdf) = bsdf.eval_pdf(wo, s.wi, transport);
                assert!(value.is_finite() && pdf.is_finite(), "{what} {wo} {u}");
            }
        }
        let color = bsdf.albedo();
        assert!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0);
        assert!((0.0..=1.0).contains(&bsdf.roughness()), "{what}");
    }
}

#[test]
fn every_model_is_finite_everywhere() {
    for name in all() {
        probe(name, |wo| resolved(name, wo));
    }
}

#[test]
fn extreme_indices_are_finite_and_lossless() {
    for eta in [1e-3, 0.999, 1.0, 1.0 + 1e-7, 1.001, 1.5, 1e3] {
        probe("clear", |wo| of_material(clear(eta), wo));
        probe("rough", |wo| of_material(glass(eta, ggx(0.2)), wo));
        probe("rough", |wo| of_material(glass(eta, beckmann(0.2)), wo));
        for cos in [1e-8f32, 1e-3, 0.3, 1.0] {
            let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
            let bsdf = of_material(clear(eta), wo);
            let sum: f32 = [0.0, RANDOM[3]]
                .iter()
                .filter_map(|&u| bsdf.sample(wo, u, Vec2::ZERO, Transport::Importance))
                .map(|s| s.weight.x * s.pdf)
                .sum();
            // Where one of both lobes has no energy, both numbers find the other.
            let once = (sum - 1.0).abs() < 1e-5;
            let twice = (sum - 2.0).abs() < 1e-5;
            assert!(once || twice, "{eta} {cos}: {sum}");
        }
    }
}

#[test]
fn extreme_parameters_are_finite() {
    for alpha in [0.0, 1e-8, 1e-4, 1e-3, 1.0, 10.0, f32::NAN] {
        for kind in [Distribution::Beckmann, Distribution::Ggx] {
            probe("metal", |wo| {
                of_material(gold(facets(kind, alpha, 0.3)), wo)
            });
            probe("glass", |wo| {
                of_material(glass(1.5, facets(kind, alpha, alpha)), wo)
            });
        }
    }
    for exponent in [0.0, 1.0, 1e6] {
        probe("phong", |wo| {
            let phong = Phong {
                diffuse_reflectance: white(),
                specular_reflectance: white(),
                exponent: grey(exponent),
            };
            of_material(phong, wo)
        });
    }
    for scale in [f32::NAN, 0.0, 0.5, 1.0] {
        probe("normal map", |wo| {
            let mut materials = crate::bsdf::Materials::default();
            let inner = materials.push(plastic(true));
            let id = materials.push(Material::NormalMap {
                normals: super::models::rgb(scale, 0.5, 0.5 * scale),
                invalid_normals: InvalidNormals::default(),
                inner,
            });
            super::at_flat_point(&materials, id, wo)
        });
    }
}

/// Extreme indices under extreme colours: nothing is infinite, and the base never returns more than
/// it would without its coat.
#[test]
fn extreme_plastics_are_finite() {
    for eta in [1e-4, 1e-3, 0.5, 1.0, 2.0, 1e3, 1e4, 1e30] {
        for color in [0.5, 1.0, 1.5, 1e6, 1e30, f32::MAX] {
            for nonlinear in [false, true] {
                let what = format!("plastic {eta} {color} {nonlinear}");
                probe(&what, |wo| {
                    let smooth = Plastic {
                        eta,
                        diffuse_reflectance: grey(color),
                        specular_reflectance: grey(color),
                        nonlinear,
                    };
                    of_material(smooth, wo)
                });
                probe(&what, |wo| {
                    let rough = RoughPlastic {
                        eta,
                        roughness: ggx(0.2),
                        diffuse_reflectance: grey(color),
                        specular_reflectance: grey(color),
                        nonlinear,
                    };
                    of_material(rough, wo)
                });
            }
        }
    }
}

#[test]
fn black_absorbs_everything() {
    let black = || grey(0.0);
    let materials = [
        Material::Diffuse(Diffuse {
            reflectance: black(),
        }),
        Material::Dielectric(Dielectric {
            eta: 1.5,
            specular_reflectance: black(),
            specular_transmittance: black(),
        }),
        Material::RoughDielectric(RoughDielectric {
            eta: 1.5,
            roughness: ggx(0.1),
            specular_reflectance: black(),
            specular_transmittance: black(),
        }),
        Material::Plastic(Plastic {
            eta: 1.5,
            diffuse_reflectance: black(),
            specular_reflectance: black(),
            nonlinear: true,
        }),
        Material::Phong(Phong {
            diffuse_reflectance: black(),
            specular_reflectance: black(),
            exponent: grey(3.0),
        }),
    ];
    for material in materials {
        probe("black", |wo| of_material(material.clone(), wo));
        let wo = Vec3::new(0.6, 0.0, 0.8);
        let bsdf = of_material(material.clone(), wo);
        for u in RANDOM {
            let s = bsdf.sample(wo, u, Vec2::splat(0.4), Transport::Radiance);
            assert!(s.is_none(), "{material:?}");
        }
    }
}

/// No reflection asked for: what remains is the transmission, with its right weight.
#[test]
fn a_dielectric_without_reflectance_always_transmits() {
    let material = Dielectric {
        eta: 1.5,
        specular_reflectance: grey(0.0),
        specular_transmittance: white(),
    };
    let wo = Vec3::Z;
    let bsdf = of_material(material, wo);
    for u in RANDOM {
        let s = bsdf
            .sample(wo, u, Vec2::ZERO, Transport::Importance)
            .expect("light passes");
        assert!(s.wi.z < 0.0);
        assert!((s.weight - Rgb::splat(0.96)).abs().max_element() < 1e-5);
    }
}
