//! `coateddiffuse` and `coatedconductor` beside pbrt's own definition of them: a random walk between
//! a dielectric interface and a base ("Physically Based Rendering", 4th edition, section 14.3).

use super::stage::Stage;
use twintree::bsdf::material::{
    Conductor, Dielectric, Distribution, RoughConductor, RoughDielectric, Roughness, white,
};
use twintree::bsdf::{LobeFlags, MaterialId, Materials, Transport};
use twintree::math::warp::cosine_hemisphere;
use twintree::math::{Pcg32, Rgb, Vec2, Vec3};
use twintree::texture::{SurfacePoint, Texture};

const WALKS: u32 = 60_000;
/// pbrt's defaults.
const THICKNESS: f32 = 0.01;
const BOUNCES: u32 = 10;

fn pair(rng: &mut Pcg32) -> Vec2 {
    Vec2::new(rng.next_f32(), rng.next_f32())
}

/// A direction that `material` sends light from `wo` to, and the weight of it.
fn scattered(
    materials: &Materials,
    material: MaterialId,
    wo: Vec3,
    rng: &mut Pcg32,
) -> Option<(Vec3, f32, bool)> {
    let point = SurfacePoint::at_uv(Vec2::ZERO);
    let bsdf = materials.resolve(material, &point, wo);
    let u = rng.next_f32();
    let sample = bsdf.sample(wo, u, pair(rng), Transport::Radiance)?;
    let through = sample.lobe.has(LobeFlags::TRANSMISSION);
    Some((sample.wi, sample.weight.x, through))
}

/// Where a base sends light that goes down along `w`, and the part of it that it sends.
type Base<'b> = dyn Fn(Vec3, &mut Pcg32) -> Option<(Vec3, f32)> + 'b;

/// Light that returns from a walk that begins at `wo`.
fn walk(coat: &(Materials, MaterialId), base: &Base, wo: Vec3, rng: &mut Pcg32) -> f32 {
    let Some((mut w, mut light, through)) = scattered(&coat.0, coat.1, wo, rng) else {
        return 0.0;
    };
    if !through {
        return light;
    }
    for bounce in 0..BOUNCES {
        light *= (-THICKNESS / w.z.abs()).exp();
        if bounce % 2 == 0 {
            let Some((next, weight)) = base(w, rng) else {
                return 0.0;
            };
            light *= weight;
            w = next;
            continue;
        }
        let Some((next, weight, through)) = scattered(&coat.0, coat.1, -w, rng) else {
            return 0.0;
        };
        light *= weight;
        if through {
            return light;
        }
        w = next;
    }
    0.0
}

fn facets(alpha: f32) -> Roughness {
    Roughness {
        distribution: Distribution::Ggx,
        alpha_u: Texture::Constant(Rgb::splat(alpha)),
        alpha_v: Texture::Constant(Rgb::splat(alpha)),
    }
}

fn interface(alpha: f32) -> (Materials, MaterialId) {
    let mut materials = Materials::default();
    let id = match alpha > 0.0 {
        false => materials.push(Dielectric {
            eta: 1.5,
            specular_reflectance: white(),
            specular_transmittance: white(),
        }),
        true => materials.push(RoughDielectric {
            eta: 1.5,
            roughness: facets(alpha),
            specular_reflectance: white(),
            specular_transmittance: white(),
        }),
    };
    (materials, id)
}

/// All the light that is reflected to a direction when the same comes from everywhere: ours against
/// the walk. Both means have errors below 0.3 % of the light.
#[test]
fn coated_diffuse_is_near_to_pbrts_random_walk() {
    let stage = Stage::new();
    let mut rng = Pcg32::new(11, 1);
    let mut worst = [0.0f32; 2];
    for (roughness, base) in [0.0f32, 0.04, 0.25, 0.5]
        .into_iter()
        .flat_map(|r| [0.2, 0.5, 0.8].map(|b| (r, b)))
    {
        stage.write(
            "scene.pbrt",
            format!(
                "WorldBegin Material \"coateddiffuse\" \"rgb reflectance\" [{base} {base} {base}]
             \"float roughness\" {roughness} Shape \"sphere\""
            ),
        );
        let d = stage.load("scene.pbrt");
        let material = d.shapes[0].material;
        let coat = interface(roughness.sqrt());
        for cos in [0.3f32, 0.6, 0.95] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let (mut ours, mut theirs) = (0.0, 0.0);
            for _ in 0..WALKS {
                ours += scattered(&d.materials, material, wo, &mut rng).map_or(0.0, |s| s.1);
                let diffuse = |_, rng: &mut Pcg32| Some((cosine_hemisphere(pair(rng)), base));
                theirs += walk(&coat, &diffuse, wo, &mut rng);
            }
            let off = ours / theirs - 1.0;
            println!(
                "roughness {roughness} base {base} cos {cos}: {:.4} for {:.4}, {:+.1} %",
                ours / WALKS as f32,
                theirs / WALKS as f32,
                off * 100.0
            );
            worst[usize::from(roughness > 0.0)] =
                worst[usize::from(roughness > 0.0)].max(off.abs());
        }
    }
    println!("worst, smooth and rough: {worst:?}");
    // Of a smooth coat more is left when pbrt gives up a walk after ten bounces.
    assert!(worst[0] < 0.045 && worst[1] < 0.025, "{worst:?}");
}

/// A metal seen from within the coat.
fn metal(constants: [f32; 2], alpha: f32) -> (Materials, MaterialId) {
    let mut materials = Materials::default();
    let [eta, k] = constants.map(|x| Texture::Constant(Rgb::splat(x / 1.5)));
    let specular_reflectance = white();
    let id = match alpha > 0.0 {
        false => materials.push(Conductor {
            eta,
            k,
            specular_reflectance,
        }),
        true => materials.push(RoughConductor {
            eta,
            k,
            roughness: facets(alpha),
            specular_reflectance,
        }),
    };
    (materials, id)
}

/// The same of metals under a coat: copper in green, silver in red, tungsten.
#[test]
fn coated_conductor_is_near_to_pbrts_random_walk() {
    let stage = Stage::new();
    let mut rng = Pcg32::new(12, 1);
    let (mut worst, mut sum) = (0.0f32, 0.0);
    let roughnesses = [0.0f32, 0.04, 0.25];
    let pairs = roughnesses.map(|coat| roughnesses.map(|base| (coat, base)));
    for ([eta, k], (coat, base)) in [[0.98f32, 2.62], [0.13, 4.1], [3.5, 2.7]]
        .into_iter()
        .flat_map(|metal| pairs.concat().into_iter().map(move |pair| (metal, pair)))
    {
        stage.write(
            "scene.pbrt",
            format!(
                "WorldBegin Material \"coatedconductor\" \"rgb conductor.eta\" [{eta} {eta} {eta}]
                 \"rgb conductor.k\" [{k} {k} {k}] \"float interface.roughness\" {coat}
                 \"float conductor.roughness\" {base} Shape \"sphere\""
            ),
        );
        let d = stage.load("scene.pbrt");
        let material = d.shapes[0].material;
        let (interface, metal) = (interface(coat.sqrt()), metal([eta, k], base.sqrt()));
        for cos in [0.3f32, 0.6, 0.95] {
            let wo = Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
            let (mut ours, mut theirs) = (0.0, 0.0);
            for _ in 0..WALKS {
                ours += scattered(&d.materials, material, wo, &mut rng).map_or(0.0, |s| s.1);
                let below = |w: Vec3, rng: &mut Pcg32| {
                    let (next, weight, _) = scattered(&metal.0, metal.1, -w, rng)?;
                    Some((next, weight))
                };
                theirs += walk(&interface, &below, wo, &mut rng);
            }
            let off = ours / theirs - 1.0;
            println!(
                "eta {eta} coat {coat} metal {base} cos {cos}: {:.4} for {:.4}, {:+.1} %",
                ours / WALKS as f32,
                theirs / WALKS as f32,
                off * 100.0
            );
            worst = worst.max(off.abs());
            sum += off.abs();
        }
    }
    let mean = sum / 81.0;
    println!("worst: {worst}, mean: {mean}");
    assert!(worst < 0.18 && mean < 0.05, "{worst} {mean}");
}
