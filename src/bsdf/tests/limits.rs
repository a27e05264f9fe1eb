//! Closed forms: models in limits where they become other models, or where their integral is known.

use super::densities::directions;
use super::models::{clear, diffuse, ggx, glass, grey, rgb};
use super::{at_flat_point, of_material, resolved};
use crate::bsdf::material::{Material, Phong, RoughDiffuse, Roughness, Ward, WardVariant, white};
use crate::bsdf::{Bsdf, Materials, Transport};
use crate::math::{Rgb, Vec2, Vec3};

/// Integral of f |cos| over the upper hemisphere by a midpoint rule in `sqrt(1 - z)`, which is
/// about the angle where lobes are narrow.
fn integral(bsdf: &Bsdf, wo: Vec3) -> Rgb {
    const N: usize = 400;
    let mut sum = Rgb::ZERO;
    for i in 0..N {
        let t = (i as f32 + 0.5) / N as f32;
        let z = 1.0 - t * t;
        let r = (1.0 - z * z).sqrt();
        for j in 0..N {
            let phi = std::f32::consts::TAU * (j as f32 + 0.5) / N as f32;
            let wi = Vec3::new(r * phi.cos(), r * phi.sin(), z);
            sum += bsdf.eval(wo, wi, Transport::Radiance) * (2.0 * t / N as f32);
        }
    }
    sum * (std::f32::consts::TAU / N as f32)
}

fn same(a: &Bsdf, b: &Bsdf, tolerance: f32) {
    for wo in directions() {
        for wi in directions() {
            let (x, p) = a.eval_pdf(wo, wi, Transport::Radiance);
            let (y, q) = b.eval_pdf(wo, wi, Transport::Radiance);
            let scale = y.max_element().max(0.1);
            assert!(
                (x - y).abs().max_element() < tolerance * scale,
                "{wo} {wi}: {x} {y}"
            );
            assert!((p - q).abs() < tolerance * q.max(0.1), "{wo} {wi}: {p} {q}");
        }
    }
}

#[test]
fn rough_diffuse_without_roughness_is_diffuse() {
    for fast_approx in [false, true] {
        let rough = RoughDiffuse {
            reflectance: rgb(0.2, 0.5, 0.8),
            alpha: grey(0.0),
            fast_approx,
        };
        same(
            &of_material(rough, Vec3::Z),
            &of_material(diffuse(), Vec3::Z),
            1e-5,
        );
    }
}

/// Oren and Nayar's figures for sigma = 0.3 at normal incidence: `f = rho / pi (C1 + rho C4)`
/// there.
#[test]
fn rough_diffuse_at_normal_incidence() {
    let rough = RoughDiffuse {
        reflectance: grey(0.5),
        alpha: grey(0.3 * std::f32::consts::SQRT_2),
        fast_approx: false,
    };
    let value = of_material(rough, Vec3::Z)
        .eval(Vec3::Z, Vec3::Z, Transport::Radiance)
        .x;
    let (c1, c4) = (1.0 - 0.5 * 0.09 / 0.42, 0.17 * 0.09 / 0.22);
    assert!((value * std::f32::consts::PI - 0.5 * (c1 + 0.5 * c4)).abs() < 1e-5);
}

/// The lobe of exponent n is normalised by n + 2 for light along the normal.
#[test]
fn phong_reflects_its_specular_part() {
    for exponent in [1.0, 20.0, 200.0] {
        let phong = Phong {
            diffuse_reflectance: rgb(0.3, 0.2, 0.0),
            specular_reflectance: grey(0.4),
            exponent: grey(exponent),
        };
        let sum = integral(&of_material(phong, Vec3::Z), Vec3::Z);
        assert!(
            (sum - Rgb::new(0.7, 0.6, 0.4)).abs().max_element() < 2e-3,
            "{exponent}: {sum}"
        );
    }
}

/// A narrow lobe of Ward's is normalised away from grazing angles in Duer's and the balanced
/// variant; the first one falls off with the cosine (Duer 2006).
#[test]
fn ward_reflects_its_specular_part() {
    for variant in [
        WardVariant::Ward,
        WardVariant::WardDuer,
        WardVariant::Balanced,
    ] {
        for wo in [Vec3::Z, Vec3::new(0.5, 0.2, 0.8).normalize()] {
            let ward = Ward {
                variant,
                diffuse_reflectance: grey(0.3),
                specular_reflectance: grey(0.4),
                alpha_u: grey(0.05),
                alpha_v: grey(0.08),
            };
            let sum = integral(&of_material(ward, wo), wo).x;
            let lobe = match variant {
                WardVariant::Ward => 0.4 * wo.z,
                _ => 0.4,
            };
            assert!((sum - 0.3 - lobe).abs() < 6e-3, "{variant:?} {wo}: {sum}");
        }
    }
}

/// Too much reflectance is scaled to 0.99, as in Mitsuba 0.6.
#[test]
fn empirical_models_are_scaled_to_conserve() {
    let phong = Phong {
        diffuse_reflectance: grey(0.9),
        specular_reflectance: grey(0.9),
        exponent: grey(30.0),
    };
    assert!((of_material(phong, Vec3::Z).albedo().x - 0.99).abs() < 1e-5);
}

fn coated(rough: Option<Roughness>, eta: f32, sigma: f32, thickness: f32) -> Bsdf {
    let mut materials = Materials::default();
    let inner = materials.push(diffuse());
    let id = materials.push(match rough {
        None => Material::Coating {
            eta,
            thickness,
            sigma_a: grey(sigma),
            specular_reflectance: white(),
            inner,
        },
        Some(roughness) => Material::RoughCoating {
            eta,
            roughness,
            thickness,
            sigma_a: grey(sigma),
            specular_reflectance: white(),
            inner,
        },
    });
    at_flat_point(&materials, id, Vec3::Z)
}

#[test]
fn a_coating_of_air_is_no_coating() {
    same(
        &coated(None, 1.0, 0.0, 1.0),
        &of_material(diffuse(), Vec3::Z),
        1e-5,
    );
    same(
        &coated(Some(ggx(1e-3)), 1.0, 0.0, 1.0),
        &of_material(diffuse(), Vec3::Z),
        2e-2,
    );
}

/// Straight down and up again: `rho / pi (1 - F)^2 / eta^2 exp(-2 sigma d)`.
#[test]
fn coatings_absorb_along_both_ways() {
    let expected = |loss: f32| 0.5 / std::f32::consts::PI * 0.96 * 0.96 / 2.25 * loss;
    let value = |b: Bsdf| b.eval(Vec3::Z, Vec3::Z, Transport::Radiance).y;
    for (sigma, thickness) in [(0.0f32, 1.0f32), (0.3, 2.0)] {
        let due = expected((-2.0 * sigma * thickness).exp());
        assert!((value(coated(None, 1.5, sigma, thickness)) / due - 1.0).abs() < 1e-4);
    }
}

/// A nearly smooth interface scatters into the directions of a smooth one.
/// The tables are those of GGX facets of width 0.35, and of 0.25 by 0.5 with a mean of 0.354.
#[test]
fn measured_facets_are_as_wide_as_those_that_were_tabulated() {
    for (name, alpha) in [("measured", 0.35), ("measured_anisotropic", 0.354)] {
        let found = resolved(name, Vec3::Z).roughness();
        assert!((found / alpha - 1.0).abs() < 0.01, "{name}: {found}");
    }
}

#[test]
fn rough_glass_becomes_clear() {
    let wo = Vec3::new(0.6, 0.0, 0.8);
    for u_lobe in [0.0, 0.9] {
        let u = Vec2::new(0.5, 0.5);
        let sample = |m: Material| of_material(m, wo).sample(wo, u_lobe, u, Transport::Radiance);
        let rough = sample(glass(1.5, ggx(1e-4)).into()).expect("a sample");
        let smooth = sample(clear(1.5).into()).expect("a sample");
        assert!((rough.wi - smooth.wi).length() < 1e-3);
        assert!((rough.weight - smooth.weight).abs().max_element() < 1e-3);
        assert_eq!(rough.eta, smooth.eta);
    }
}
