//! Coats and bases, taken apart.

use super::densities::{check, directions};
use super::models::add;
use super::statistics::significance;
use super::{at_flat_point, resolved};
use crate::bsdf::{Bsdf, LobeFlags, Material, Materials, Transport};
use crate::math::{Pcg32, Rgb, Vec2, Vec3};

const NAMES: [&str; 2] = ["rough_plastic_beckmann", "rough_plastic_ggx"];

/// Coat and base of a material, and the factors that they come with.
fn parts(bsdf: &Bsdf, wo: Vec3) -> [(Bsdf, f32); 2] {
    [0.0, 0.999_999].map(|u| {
        let mut part = bsdf.clone();
        let factor = part.choose_part(wo, || u).expect("rough plastic");
        (part, factor)
    })
}

/// By lot the whole is met on average: what is left, times its factor, times the probability that
/// it is left.
#[test]
fn parts_make_up_the_whole() {
    let mut rng = Pcg32::new(5, 2);
    for name in NAMES {
        for wo in directions().into_iter().filter(|wo| wo.z > 0.0) {
            let bsdf = resolved(name, wo);
            let parts = parts(&bsdf, wo);
            let chances: f32 = parts.iter().map(|(_, factor)| factor.recip()).sum();
            assert!((chances - 1.0).abs() < 1e-6, "{name}");
            assert!(parts.iter().all(|(_, factor)| *factor < 4.001), "{name}");
            for _ in 0..1000 {
                let u = Vec2::new(rng.next_f32(), rng.next_f32());
                let wi = crate::math::warp::cosine_hemisphere(u);
                let of = |bsdf: &Bsdf| bsdf.eval(wo, wi, Transport::Radiance);
                let (whole, sum) = (of(&bsdf), of(&parts[0].0) + of(&parts[1].0));
                assert!((whole - sum).abs().max_element() <= 1e-6 * whole.max_element());
            }
        }
    }
}

#[test]
fn samples_of_parts_follow_their_densities() {
    let threshold = significance(NAMES.len() * 2 * 3);
    for (i, name) in NAMES.into_iter().enumerate() {
        for (k, wo) in directions().into_iter().filter(|wo| wo.z > 0.0).enumerate() {
            for (j, (part, _)) in parts(&resolved(name, wo), wo).iter().enumerate() {
                let seed = (100 * i + 10 * j + k) as u64;
                check(&format!("{name}, part {j}"), part, wo, seed, threshold);
            }
        }
    }
}

/// The base looks the same from all sides, but for the factor; on the back of a two-sided material,
/// too.
#[test]
fn bases_differ_by_their_view_alone() {
    let mut materials = Materials::default();
    let front = add(&mut materials, NAMES[1]);
    let both = materials.push(Material::TwoSided { front, back: front });
    for side in [1.0, -1.0] {
        let turned = |w: Vec3| Vec3::new(w.x, w.y, side * w.z);
        let to = [Vec3::Z, Vec3::new(0.9, 0.0, 0.3).normalize()].map(turned);
        let bases = to.map(|wo| parts(&at_flat_point(&materials, both, wo), wo)[1].0.clone());
        for base in &bases {
            assert!(base.roughness() >= 1.0 && !base.flags().has(LobeFlags::DELTA));
        }
        let view = bases[0].view().expect("a base has a view");
        let due = view.factor(to[1]) / view.factor(to[0]);
        for wi in directions().into_iter().filter(|w| w.z > 0.0).map(turned) {
            let seen: Vec<Rgb> = bases
                .iter()
                .zip(to)
                .map(|(base, wo)| base.eval(wo, wi, Transport::Radiance))
                .collect();
            let error = (seen[1] - seen[0] * due).abs().max_element();
            assert!(error < 1e-5 * seen[0].max_element(), "{seen:?} {due}");
        }
        assert!(due < 0.95, "no difference to see");
    }
    // Whole, it has none; diffuse reflection is the same from everywhere.
    assert!(resolved(NAMES[0], Vec3::Z).view().is_none());
    let diffuse = resolved("diffuse", Vec3::Z);
    assert!(diffuse.view().is_some_and(|v| v.factor(Vec3::X) == 1.0));
    assert!(diffuse.clone().choose_part(Vec3::Z, || 0.5).is_none());
}
