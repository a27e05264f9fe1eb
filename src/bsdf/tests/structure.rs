//! Models in models, sides, frames, masks, and the two directions of transport.

use super::models::{self, add, diffuse, grey, rgb};
use super::{at_flat_point, resolved};
use crate::bsdf::material::{Diffuse, Material, white};
use crate::bsdf::{LobeFlags, Materials, Transport};
use crate::math::{Frame, Pcg32, Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;

#[test]
fn two_sided_materials_show_the_side_they_are_seen_from() {
    let mut materials = Materials::default();
    let front = materials.push(Diffuse {
        reflectance: rgb(1.0, 0.0, 0.0),
    });
    let back = materials.push(Diffuse {
        reflectance: rgb(0.0, 1.0, 0.0),
    });
    let id = materials.push(Material::TwoSided { front, back });
    for (wo, color) in [(Vec3::Z, Rgb::X), (-Vec3::Z, Rgb::Y)] {
        let bsdf = at_flat_point(&materials, id, wo);
        assert_eq!(bsdf.albedo(), color);
        let s = bsdf
            .sample(wo, 0.5, Vec2::new(0.2, 0.7), Transport::Radiance)
            .expect("a sample");
        assert!(s.wi.z * wo.z > 0.0);
        assert_eq!(s.weight, color);
    }
    assert_eq!(
        resolved("diffuse", -Vec3::Z).eval(-Vec3::Z, -Vec3::Z, Transport::Radiance),
        Rgb::ZERO
    );
}

#[test]
fn masks_resolve_to_what_they_mask() {
    let mut materials = Materials::default();
    let inner = materials.push(diffuse());
    let mask = materials.push(Material::Mask {
        opacity: grey(0.25),
        inner,
    });
    let both = materials.push(Material::TwoSided {
        front: mask,
        back: inner,
    });
    let twice = materials.push(Material::Mask {
        opacity: grey(0.5),
        inner: mask,
    });
    let point = SurfacePoint::at_uv(Vec2::ZERO);
    for (id, masked, opacity) in [
        (inner, false, 1.0),
        (mask, true, 0.25),
        (both, true, 0.25),
        (twice, true, 0.125),
    ] {
        assert_eq!(materials.is_masked(id), masked);
        assert!((materials.opacity(id, &point) - opacity).abs() < 1e-6);
    }
    let bsdf = at_flat_point(&materials, mask, Vec3::Z);
    assert_eq!(bsdf.albedo(), Rgb::new(0.2, 0.5, 0.8));
    assert_eq!(materials.len(), 4);
}

#[test]
fn circles_and_missing_materials_absorb() {
    let mut materials = Materials::default();
    let circle = materials.push(Material::Blend {
        weight: grey(0.5),
        first: 0,
        second: 7,
    });
    for id in [circle, 99] {
        let bsdf = at_flat_point(&materials, id, Vec3::Z);
        assert!(
            bsdf.sample(Vec3::Z, 0.3, Vec2::splat(0.3), Transport::Radiance)
                .is_none()
        );
        assert_eq!(bsdf.eval(Vec3::Z, Vec3::Z, Transport::Radiance), Rgb::ZERO);
        assert_eq!(materials.opacity(id, &SurfacePoint::at_uv(Vec2::ZERO)), 1.0);
    }
}

#[test]
fn flags_and_roughness_describe_the_lobes() {
    let of = |name| {
        let b = resolved(name, Vec3::Z);
        (b.flags(), b.roughness())
    };
    let (smooth, delta) = (LobeFlags::SMOOTH, LobeFlags::DELTA);
    let (reflection, transmission) = (LobeFlags::REFLECTION, LobeFlags::TRANSMISSION);
    assert_eq!(of("diffuse"), (smooth | reflection, 1.0));
    assert_eq!(of("plastic"), (smooth | delta | reflection, 1.0));
    assert_eq!(of("dielectric"), (delta | reflection | transmission, 0.0));
    assert_eq!(of("null"), (delta | transmission | LobeFlags::NULL, 0.0));
    assert_eq!(of("blend"), (smooth | reflection, 0.3));
    assert_eq!(of("coating"), (smooth | delta | reflection, 0.2));
    assert_eq!(
        of("rough_dielectric_ggx"),
        (smooth | reflection | transmission, 0.3)
    );
}

/// What a denoiser is told: the normal that a map has turned, and how much is rough.
#[test]
fn maps_turn_the_normal_and_delta_lobes_have_their_share() {
    let coded = Vec3::new(0.65, 0.42, 0.9) * 2.0 - 1.0;
    let turned = resolved("normal_map", Vec3::Z);
    assert!((turned.normal() - coded.normalize()).length() < 1e-6);
    assert_eq!(resolved("coated_diffuse", Vec3::Z).normal(), Vec3::Z);
    // Seen from its back, in which it is mirrored, the map is on the other side.
    let back = resolved("two_sided_nest", -Vec3::Z).normal();
    assert!((back.z.abs() - coded.normalize().z).abs() < 1e-6, "{back}");
    let share = |name| resolved(name, Vec3::Z).rough_share(Vec3::Z);
    assert_eq!([share("diffuse"), share("dielectric")], [1.0, 0.0]);
    let plastic = share("plastic");
    assert!((0.5..1.0).contains(&plastic), "{plastic}");
}

/// A frame that is not the world's changes nothing but the coordinates.
#[test]
fn world_directions_go_through_the_frame() {
    let mut materials = Materials::default();
    let id = add(&mut materials, "normal_map");
    let n = Vec3::new(0.3, -0.5, 0.4).normalize();
    let frame = Frame::with_tangent(n, Vec3::new(0.2, 0.1, -0.9));
    let turned = SurfacePoint {
        frame,
        ng: n,
        ..SurfacePoint::at_uv(Vec2::ZERO)
    };
    let (o, i) = (
        Vec3::new(0.3, 0.2, 0.8).normalize(),
        Vec3::new(-0.4, 0.1, 0.6).normalize(),
    );
    let flat = at_flat_point(&materials, id, o);
    let (wo, wi) = (frame.to_world(o), frame.to_world(i));
    let bsdf = materials.resolve(id, &turned, wo);
    for transport in [Transport::Radiance, Transport::Importance] {
        let (a, p) = flat.eval_pdf(o, i, transport);
        let (b, q) = bsdf.eval_pdf(wo, wi, transport);
        assert!((a - b).abs().max_element() < 1e-5 && (p - q).abs() < 1e-5);
        let u = Vec2::new(0.4, 0.6);
        let s = flat.sample(o, 0.5, u, transport).expect("a sample");
        let t = bsdf.sample(wo, 0.5, u, transport).expect("a sample");
        assert!((frame.to_world(s.wi) - t.wi).length() < 1e-5);
        assert!((s.weight - t.weight).abs().max_element() < 1e-4);
    }
}

/// With a shading normal (from the mesh or from a map), what power transport scatters from a to b
/// is what radiance transport scatters from b to a, both per projected area of the *real* surface
/// (Veach 1997, 5.3). The normal is turned little enough that no limit is reached.
#[test]
fn shading_normals_keep_transport_adjoint() {
    let n = Vec3::new(0.2, -0.1, 1.0).normalize();
    let point = SurfacePoint {
        frame: Frame::with_tangent(n, Vec3::X),
        ..SurfacePoint::at_uv(Vec2::ZERO)
    };
    let mut rng = Pcg32::new(8, 8);
    for name in [
        "diffuse",
        "rough_conductor_ggx",
        "rough_dielectric_ggx",
        "normal_map",
    ] {
        let mut materials = Materials::default();
        let id = add(&mut materials, name);
        for _ in 0..500 {
            let mut w = |sign: f32| {
                let (x, y) = (rng.next_f32() - 0.5, rng.next_f32() - 0.5);
                Vec3::new(x, y, sign).normalize()
            };
            let down = if name == "rough_dielectric_ggx" {
                -1.0
            } else {
                1.0
            };
            let (a, b) = (w(1.0), w(down));
            let forth = materials
                .resolve(id, &point, a)
                .eval(a, b, Transport::Radiance);
            let back = materials
                .resolve(id, &point, b)
                .eval(b, a, Transport::Importance);
            // f |b.ns| |a.ng| = f* |a.ng| ... : both sides times the other's geometric cosine.
            let (x, y) = (forth * a.z.abs(), back * b.z.abs());
            let error = (x - y).abs().max_element();
            assert!(
                error < 2e-3 * x.max_element().max(1e-3),
                "{name} {a} {b}: {x} {y}"
            );
        }
    }
}

#[test]
fn glass_compresses_radiance_and_not_power() {
    let wo = Vec3::Z;
    let bsdf = resolved("dielectric", wo);
    let weight = |t| bsdf.sample(wo, 0.9, Vec2::ZERO, t).expect("refraction");
    let (radiance, power) = (weight(Transport::Radiance), weight(Transport::Importance));
    assert!((radiance.weight.x * 2.25 - 1.0).abs() < 1e-5);
    assert!((power.weight.x - 1.0).abs() < 1e-5);
    assert!((radiance.eta - 1.5).abs() < 1e-6);
}

/// A mixture of less than everything keeps the rest.
#[test]
fn mixtures_weigh_their_parts() {
    let mut materials = Materials::default();
    let a = materials.push(Diffuse {
        reflectance: white(),
    });
    let light = materials.push(Material::Mixture {
        parts: vec![(0.25, a), (0.5, a)],
    });
    let heavy = materials.push(Material::Mixture {
        parts: vec![(3.0, a), (1.0, a)],
    });
    let empty = materials.push(Material::Mixture { parts: Vec::new() });
    for (id, share) in [(light, 0.75), (heavy, 1.0), (empty, 0.0)] {
        let bsdf = at_flat_point(&materials, id, Vec3::Z);
        let value = bsdf.eval(Vec3::Z, Vec3::Z, Transport::Radiance).x;
        assert!(
            (value * std::f32::consts::PI - share).abs() < 1e-5,
            "{share}"
        );
        assert!((bsdf.albedo().x - share).abs() < 1e-5);
    }
}

/// Choosing the delta lobe with its probability, or else among the rest, is the same as choosing
/// among all: each number that chooses a lobe gives the same sample either way.
#[test]
fn a_delta_lobe_and_the_rest_are_all_lobes() {
    let wo = Vec3::new(0.5, 0.1, 0.8).normalize();
    let u = Vec2::new(0.3, 0.6);
    let mut apart = 0;
    for name in models::all() {
        let bsdf = resolved(name, wo);
        let Some(parts) = bsdf.split_delta(wo, Transport::Radiance) else {
            continue;
        };
        apart += 1;
        let p = parts.delta.pdf;
        assert!(parts.delta.lobe.has(LobeFlags::DELTA), "{name}");
        assert!((p + parts.rest.chance - 1.0).abs() < 1e-6, "{name}");
        let same = |u_lobe: f32| {
            let s = bsdf.sample(wo, u_lobe, u, Transport::Radiance);
            s.is_some_and(|s| s.wi == parts.delta.wi && s.weight == parts.delta.weight)
        };
        let numbers = (0..1000).map(|i| (i as f32 + 0.5) / 1000.0);
        assert!(
            !numbers.clone().any(|v| same(parts.rest.choose(v))),
            "{name}"
        );
        let chosen = numbers.filter(|&v| same(v)).count() as f32 / 1000.0;
        assert!((chosen - p).abs() < 2e-3, "{name}: {chosen} of {p}");
    }
    assert!(apart >= 4, "only {apart} models were looked at");
}
