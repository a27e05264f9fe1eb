//! S19, S20: random numbers at the ends of their range, angles at the ends of theirs.

use crate::scenes::{field_of, room};
use crate::support::grey;
use crate::table::Table;
use twintree::accel::Backend;
use twintree::bsdf::material::{
    Dielectric, Diffuse, Distribution, Null, Phong, Plastic, Principled, RoughConductor,
    RoughDielectric, Roughness, white,
};
use twintree::bsdf::{Bsdf, Material, Materials, Transport};
use twintree::film::filter::{Filter, FilterSampler};
use twintree::guide::{Field, ModelKind};
use twintree::math::equal_area::square_to_sphere;
use twintree::math::warp;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};
use twintree::texture::SurfacePoint;

/// The ends of the range, and one next to them.
const ENDS: [f32; 4] = [0.0, 2.328_306_4e-10, 0.5, 1.0 - f32::EPSILON * 0.5];

fn ggx(alpha: f32) -> Roughness {
    Roughness {
        distribution: Distribution::Ggx,
        alpha_u: grey(alpha),
        alpha_v: grey(alpha),
    }
}

fn materials() -> Vec<Material> {
    let glass = |eta| {
        Material::Dielectric(Dielectric {
            eta,
            specular_reflectance: white(),
            specular_transmittance: white(),
        })
    };
    let principled = Principled {
        base_color: grey(0.5),
        roughness: grey(0.3),
        anisotropic: grey(0.5),
        metallic: grey(0.5),
        spec_trans: grey(0.5),
        eta: 1.5,
        spec_tint: grey(0.5),
        sheen: grey(0.5),
        sheen_tint: grey(0.5),
        flatness: grey(0.0),
        clearcoat: grey(0.5),
        clearcoat_gloss: grey(0.5),
        main_specular_sampling_rate: 1.0,
        clearcoat_sampling_rate: 1.0,
        diffuse_reflectance_sampling_rate: 1.0,
    };
    let mut list = vec![
        Material::Diffuse(Diffuse {
            reflectance: white(),
        }),
        glass(1.5),
        glass(1.0),
        Material::Plastic(Plastic {
            eta: 1.5,
            diffuse_reflectance: grey(0.5),
            specular_reflectance: white(),
            nonlinear: true,
        }),
        Material::Phong(Phong {
            diffuse_reflectance: grey(0.5),
            specular_reflectance: grey(0.5),
            exponent: grey(1e4),
        }),
        Material::from(principled),
        Material::Null(Null),
    ];
    for alpha in [0.0, 1e-8, 1e-4, 0.1, 1.0] {
        list.push(Material::from(RoughConductor {
            eta: grey(0.2),
            k: grey(3.9),
            roughness: ggx(alpha),
            specular_reflectance: white(),
        }));
        list.push(Material::from(RoughDielectric {
            eta: 1.5,
            roughness: ggx(alpha),
            specular_reflectance: white(),
            specular_transmittance: white(),
        }));
    }
    list
}

/// A flat surface of that material, seen along `wo`.
fn flat(material: Material, wo: Vec3) -> Bsdf {
    let mut all = Materials::default();
    let id = all.push(material);
    all.resolve(id, &SurfacePoint::at_uv(Vec2::splat(0.5)), wo)
}

#[test]
fn s19_random_numbers_at_their_ends() {
    let mut table = Table::default();
    let mut bad = [0u32; 4];
    let four = || (0..256).map(|i| [ENDS[i % 4], ENDS[i / 4 % 4], ENDS[i / 16 % 4], ENDS[i / 64]]);
    for material in materials() {
        for z in [1e-8f32, 1e-3, 0.5, 1.0] {
            let wo = Vec3::new((1.0 - z * z).sqrt(), 0.0, z);
            let bsdf = flat(material.clone(), wo);
            for [a, b, c, _] in four() {
                let sample = bsdf.sample(wo, a, Vec2::new(b, c), Transport::Radiance);
                let fine = sample.is_none_or(|s| {
                    s.weight.is_finite()
                        && s.weight.min_element() >= 0.0
                        && s.pdf > 0.0
                        && s.pdf.is_finite()
                        && (s.wi.length() - 1.0).abs() < 1e-5
                });
                bad[0] += u32::from(!fine);
            }
        }
    }
    table.hold(
        "S19",
        "samples of materials that are no numbers",
        "bsdf",
        0.0,
        bad[0].into(),
    );

    let built = room(Backend::default());
    let guide = field_of(&built);
    for [a, b, c, d] in four() {
        for p in [
            Vec3::ZERO,
            Vec3::new(0.0, -1.0, 0.0),
            Vec3::new(0.0, 0.25, 0.25),
        ] {
            let lights = &built.scene.lights;
            let fine = lights
                .sample(p, Vec3::ZERO, &mut (), [a, b, c])
                .is_none_or(|l| {
                    let radiance = lights.radiance(&l.incoming);
                    radiance.is_finite() && l.pdf > 0.0 && l.dir.is_finite()
                });
            bad[1] += u32::from(!fine);
            let local = guide.field.at(p, Some(Vec3::Y), Rgb::ONE);
            let drawn = local.sample(Vec2::new(a, b), Vec2::new(c, d));
            let fine = drawn.direction.is_finite() && drawn.pdf > 0.0 && drawn.pdf.is_finite();
            bad[2] += u32::from(!fine);
        }
    }
    table.hold(
        "S19",
        "samples of lights that are no numbers",
        "light",
        0.0,
        bad[1].into(),
    );
    table.hold(
        "S19",
        "samples of fields that are no numbers",
        "guide",
        0.0,
        bad[2].into(),
    );

    for [a, b, c, d] in four() {
        let (u, v) = (Vec2::new(a, b), Vec2::new(c, d));
        let ray = built.camera.ray(u * 32.0, v).ray;
        let filter = FilterSampler::new(Filter::Gaussian { stddev: 0.5 }).sample(u);
        let warped = [
            warp::cosine_hemisphere(u),
            warp::uniform_sphere(u),
            warp::uniform_cone(u, 1e-8),
            warp::uniform_triangle(u).extend(0.0),
            square_to_sphere(u),
        ];
        let fine = ray.is_traceable()
            && filter.offset.is_finite()
            && filter.weight.is_finite()
            && warped.iter().all(|w| w.is_finite());
        bad[3] += u32::from(!fine);
    }
    table.hold(
        "S19",
        "camera rays, filters and warps that are no numbers",
        "math",
        0.0,
        bad[3].into(),
    );
}

/// A smooth interface sends as much out as comes in, at and around the critical angle.
#[test]
fn s20_interfaces_are_lossless() {
    let mut table = Table::default();
    for eta in [1.0, 1.0 + f32::EPSILON, 1.5, 1e3, 1e-3, 1.0 / 1.5] {
        let critical = if eta < 1.0 {
            (1.0 - eta * eta).sqrt()
        } else {
            0.5
        };
        let mut worst: f64 = 0.0;
        for side in [1.0f32, -1.0] {
            for cos in [1e-8f32, 1e-3, critical, critical + f32::EPSILON, 0.3, 1.0] {
                let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, side * cos);
                let material = Material::Dielectric(Dielectric {
                    eta,
                    specular_reflectance: white(),
                    specular_transmittance: white(),
                });
                let bsdf = flat(material, wo);
                let first = |u: f32| bsdf.sample(wo, u, Vec2::ZERO, Transport::Importance);
                let (Some(a), Some(b)) = (first(0.0), first(ENDS[3])) else {
                    panic!("{eta} {cos}: no direction");
                };
                // Where one of both lobes has no energy both numbers find the other.
                let other = if a.lobe == b.lobe {
                    0.0
                } else {
                    b.weight.x * b.pdf
                };
                worst = worst.max(f64::from(a.weight.x * a.pdf + other - 1.0).abs());
            }
        }
        table.hold(
            "S20",
            &format!("index {eta:e}: |R + T - 1|"),
            "bsdf",
            1e-6,
            worst,
        );
    }
}

/// The models of the field at the ends, too: all of them.
#[test]
fn s19_models_of_fields_at_their_ends() {
    let mut table = Table::default();
    let mut bad = 0u32;
    for model in ModelKind::ALL {
        let field = Field::random(Vec3::ZERO, Vec3::ONE, *model, 5);
        let mut rng = Pcg32::new(1, 1);
        for i in 0..4096 {
            let p = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
            let local = field.at(p, Some(Vec3::Z), Rgb::ONE);
            let u = Vec2::new(ENDS[i % 4], ENDS[i / 4 % 4]);
            let v = Vec2::new(ENDS[i / 16 % 4], ENDS[i / 64 % 4]);
            let drawn = local.sample(u, v);
            let again = local.pdf(drawn.direction);
            bad += u32::from(!(drawn.pdf > 0.0 && drawn.pdf.is_finite() && again > 0.0));
        }
    }
    table.hold(
        "S19",
        "samples of random fields that are no numbers",
        "guide",
        0.0,
        bad.into(),
    );
}
