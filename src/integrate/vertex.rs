//! One vertex of a camera path.

use super::emission::{add_emission, add_environment};
use super::forks::Forks;
use super::guiding::{Guidance, GuidedVertex, facing, is_guidable};
use super::record::{Arrival, Departure, Onward, Witness};
use super::roulette;
use super::wave::{FirstHit, Outcome, Path};
use super::{PathSettings, Roulette};
use crate::accel::{Hit, Ray};
use crate::bsdf::{Bsdf, BsdfSample, LobeFlags, Transport};
use crate::math::mis::power_heuristic;
use crate::math::offset::{gamma, offset_origin};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::surface::DARK;
use crate::texture::SurfacePoint;

/// A shadow ray stops this much short of the light, relative to the distance, so as not to meet the
/// light's own surface. An occluder closer to the light than this is not seen.
const SHADOW_MARGIN: f32 = 1e-4;
/// Light that a sample receives if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub struct ShadowRay {
    /// The account of the path that sampled it.
    pub slot: u32,
    /// Throughput, BSDF, light and MIS weight multiplied out.
    pub radiance: Rgb,
}

/// How a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Next {
    /// The next ray, or none if the path ends.
    pub ray: Option<Ray>,
    /// A shadow ray to trace.
    pub shadow: Option<(Ray, ShadowRay)>,
}

impl Next {
    /// The path ends here.
    pub const END: Next = Next {
        ray: None,
        shadow: None,
    };
}

/// What all vertices of a render share.
#[derive(Clone, Copy)]
pub struct Walk<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// How paths are traced.
    pub settings: &'a PathSettings,
    /// A learned field, to guide by.
    pub guide: Option<Guidance<'a>>,
}

/// What a vertex writes to beside its path.
pub struct Watched<'w, W: Witness> {
    /// The path's account.
    pub outcome: &'w mut Outcome,
    /// Where ways that split off go.
    pub forks: &'w mut Forks,
    /// Who looks on.
    pub witness: &'w mut W,
}

/// Handles what `ray` met: adds emission to the path's account, samples a light, samples the BSDF (and the
/// field, with a guide), splits the path or plays roulette.
#[inline]
pub fn visit(
    walk: &Walk,
    ray: &Ray,
    hit: &Hit,
    path: &mut Path,
    watched: Watched<impl Witness>,
) -> Next {
    let Walk {
        scene,
        settings,
        guide,
    } = *walk;
    let Watched {
        outcome,
        forks,
        witness,
    } = watched;
    if !hit.is_some() {
        witness.arrive(path.slot, outcome.radiance, f32::INFINITY);
        add_environment(scene, settings, ray, path, outcome);
        return Next::END;
    }
    let surface = &scene.surfaces.list[hit.shape as usize];
    let point = scene
        .surfaces
        .point(ray, hit, path.cone_width + path.cone_spread * hit.t);
    let wo = -ray.dir;
    witness.arrive(path.slot, outcome.radiance, hit.t);
    if surface.emitter != DARK {
        add_emission(scene, settings, surface.emitter, &point, wo, path, outcome);
    }
    if path.depth + 1 >= settings.max_depth && path.depth > 0 {
        return Next::END;
    }
    let bsdf = scene
        .surfaces
        .materials
        .resolve(surface.material, &point, wo);
    if path.depth == 0 {
        outcome.first = FirstHit {
            albedo: bsdf.albedo(),
            normal: point.frame.n,
            depth: hit.t,
        };
        if settings.max_depth < 2 {
            return Next::END;
        }
    }
    let guided = guide.and_then(|g| g.at(&point, &bsdf, wo, path.throughput));
    let mut vertex = Vertex {
        point: &point,
        bsdf: &bsdf,
        guided: guided.as_ref(),
        wo,
        ways: 1,
    };
    let block = path.sampler.next4();
    let arrival = Arrival {
        throughput: path.throughput,
        radiance: outcome.radiance,
    };
    let shadow = sample_light(walk, &vertex, path, [block[0], block[1], block[2]]);
    let coming = coming(settings, &vertex, path.throughput);
    vertex.ways = coming.map_or(1, |coming| roulette::ways(path, coming));
    let mut go = |path: &mut Path, arrival: &Arrival| {
        scatter(settings, &vertex, path, block[3], arrival, hit.t, witness)
    };
    let ray = if vertex.ways > 1 {
        split(vertex.ways, path, forks, &mut go)
    } else {
        go(path, &arrival)
    };
    Next { ray, shadow }
}

/// What a path that came with this throughput will bring by the field's account, if the field can tell and is
/// to be asked.
#[inline]
fn coming(settings: &PathSettings, vertex: &Vertex, throughput: Rgb) -> Option<f32> {
    if settings.roulette != Roulette::Field {
        return None;
    }
    let reflected = vertex.guided?.reflected()?;
    Some((throughput * reflected).element_sum())
}

/// Lets a path `go` on in several ways, each with its share of the throughput. The path itself takes the
/// first, with an account of its own like the others.
fn split(
    ways: u32,
    path: &mut Path,
    forks: &mut Forks,
    go: &mut impl FnMut(&mut Path, &Arrival) -> Option<Ray>,
) -> Option<Ray> {
    let parent = path.slot;
    path.throughput /= ways as f32;
    path.ways *= ways;
    let arrival = Arrival {
        throughput: path.throughput,
        radiance: Rgb::ZERO,
    };
    for i in 1..ways {
        let mut way = Path {
            slot: forks.open(parent),
            sampler: path.sampler.fork(i),
            ..*path
        };
        if let Some(ray) = go(&mut way, &arrival) {
            forks.push(way, ray);
        }
    }
    path.slot = forks.open(parent);
    go(path, &arrival)
}

/// What is known at a vertex.
struct Vertex<'v, 's> {
    point: &'v SurfacePoint<'s>,
    bsdf: &'v Bsdf,
    guided: Option<&'v GuidedVertex<'s>>,
    wo: Vec3,
    /// Directions in which the path goes on.
    ways: u32,
}

/// Whether geometric and shading normal disagree about the side `w` is on.
#[inline]
fn crosses(point: &SurfacePoint, w: Vec3) -> bool {
    point.ng.dot(w) * point.frame.n.dot(w) <= 0.0
}

/// Next-event estimation: a shadow ray with the light it would bring, if there is one. With a guide it is
/// left out where it seldom brings any.
#[inline]
fn sample_light(
    walk: &Walk,
    vertex: &Vertex,
    path: &mut Path,
    u: [f32; 3],
) -> Option<(Ray, ShadowRay)> {
    let Walk {
        scene, settings, ..
    } = *walk;
    let Vertex {
        point,
        bsdf,
        guided,
        wo,
        ..
    } = *vertex;
    path.light_chance = guided.map_or(1.0, GuidedVertex::light_chance);
    if !bsdf.flags().has(LobeFlags::SMOOTH) {
        path.from_normal = Vec3::ZERO;
        return None;
    }
    path.from_normal = bsdf.light_normal(wo);
    if u[0] >= path.light_chance {
        return None;
    }
    let u = [(u[0] / path.light_chance).min(BELOW_ONE), u[1], u[2]];
    let light = scene.lights.sample(point.p, path.from_normal, u)?;
    if settings.strict_normals && (crosses(point, light.dir) || crosses(point, wo)) {
        return None;
    }
    let (f, bsdf_pdf) = bsdf.eval_pdf(wo, light.dir, Transport::Radiance);
    if f == Rgb::ZERO {
        return None;
    }
    let light_pdf = light.pdf * path.light_chance;
    let weight = if light.delta {
        1.0
    } else {
        let pdf = guided.map_or(bsdf_pdf, |g| g.pdf(light.dir, bsdf_pdf));
        power_heuristic(light_pdf, pdf)
    };
    // Large BSDFs (narrow lobes) meet small weights before bright lights: the other order overflows (S8).
    let radiance = path.throughput * (f * (weight / light_pdf)) * light.radiance;
    let org = offset_origin(point.p, point.error, point.ng, light.dir);
    let ray = if light.distance.is_finite() {
        shadow_ray(org, point.p + light.dir * light.distance)
    } else {
        Ray::new(org, light.dir)
    };
    Some((
        ray,
        ShadowRay {
            slot: path.slot,
            radiance,
        },
    ))
}

/// A ray that ends just before a place on a light.
///
/// It runs through that place, not along the direction in which the light was sampled: beside that, by the
/// offset of its origin, it meets a light that it grazes earlier than its margin allows (a lamp that
/// touches the ceiling lost 3 % of its light around the touch).
#[inline]
fn shadow_ray(org: Vec3, light: Vec3) -> Ray {
    let to = light - org;
    let distance = to.length();
    let mut ray = Ray::new(org, to / distance.max(f32::MIN_POSITIVE));
    let rounding = 4.0 * gamma(7) * org.abs().max_element();
    ray.tmax = distance * (1.0 - SHADOW_MARGIN) - rounding;
    ray
}

/// Samples the BSDF, or the mixture of BSDF and field, and plays roulette: the next ray, or none.
#[inline]
fn scatter(
    settings: &PathSettings,
    vertex: &Vertex,
    path: &mut Path,
    u_roulette: f32,
    arrival: &Arrival,
    distance: f32,
    witness: &mut impl Witness,
) -> Option<Ray> {
    let onward = go_on(settings, vertex, path, u_roulette, arrival);
    let delta = |sample: &BsdfSample| sample.lobe.has(LobeFlags::DELTA);
    // A delta lobe was chosen: no smooth direction was. That counts as a vertex without one.
    let smooth = onward.as_ref().filter(|o| !delta(&o.0));
    watch(vertex, path, arrival, smooth, witness);
    let (sample, _) = onward?;
    let delta = delta(&sample);
    let Vertex { point, bsdf, .. } = *vertex;
    path.pdf = if delta { f32::INFINITY } else { sample.pdf };
    path.from = point.p;
    path.cone_width += path.cone_spread * distance;
    if !delta {
        path.cone_spread = path.cone_spread.max(bsdf.roughness() * ROUGH_SPREAD);
    }
    Some(Ray::new(
        offset_origin(point.p, point.error, point.ng, sample.wi),
        sample.wi,
    ))
}

/// The next direction and the chance with which roulette let the path take it, both already part of the
/// throughput.
#[inline]
fn go_on(
    settings: &PathSettings,
    vertex: &Vertex,
    path: &mut Path,
    u_roulette: f32,
    arrival: &Arrival,
) -> Option<(BsdfSample, f32)> {
    let Vertex {
        point,
        bsdf,
        guided,
        wo,
        ..
    } = *vertex;
    let block = path.sampler.next4();
    path.depth += 1;
    let sample = match guided {
        Some(guided) => guided.sample(bsdf, wo, block)?,
        None => {
            let u = Vec2::new(block[1], block[2]);
            bsdf.sample(wo, block[0], u, Transport::Radiance)?
        }
    };
    if settings.strict_normals && (crosses(point, sample.wi) || crosses(point, wo)) {
        return None;
    }
    path.throughput *= sample.weight;
    // Underflown: whatever it would meet counts for nothing (S21).
    if path.throughput == Rgb::ZERO {
        return None;
    }
    path.eta *= sample.eta;
    let by_field = guided.filter(|_| settings.roulette == Roulette::Field);
    let survival = match coming(settings, vertex, arrival.throughput) {
        Some(coming) => roulette::by_field(path, coming),
        None if path.depth < settings.rr_depth => 1.0,
        None if by_field.is_some() => roulette::MAX_SURVIVAL,
        None => roulette::by_throughput(path),
    };
    if u_roulette >= survival {
        return None;
    }
    path.throughput /= survival;
    if by_field.is_some() {
        path.aimed_with = roulette::standing(path);
    }
    Some((sample, survival))
}

/// Tells the witness how the path left a vertex that a field could guide.
#[inline]
fn watch<W: Witness>(
    vertex: &Vertex,
    path: &Path,
    arrival: &Arrival,
    onward: Option<&(BsdfSample, f32)>,
    witness: &mut W,
) {
    if !W::WATCHES || !is_guidable(vertex.bsdf) {
        return;
    }
    let onward = onward.map(|(sample, survival)| {
        let guide_pdf = vertex.guided.map_or(0.0, |g| g.field_pdf(sample.wi));
        Onward {
            direction: sample.wi,
            pdf: sample.pdf,
            guide_pdf,
            bsdf_pdf: vertex
                .guided
                .map_or(sample.pdf, |g| g.bsdf_pdf(sample.pdf, guide_pdf)),
            weight: sample.weight,
            survival: *survival,
            throughput: path.throughput,
        }
    });
    // The light sample belongs to all ways together.
    let single = vertex.guided.filter(|_| vertex.ways == 1);
    let departure = Departure {
        position: vertex.point.p,
        normal: facing(vertex.point, vertex.wo),
        arrival: *arrival,
        light_chance: single.map(GuidedVertex::light_chance),
        onward,
    };
    witness.leave(path.slot, departure);
}

/// After a rough bounce textures are seen blurred: a lobe of roughness 1 spreads its cone this much per
/// unit distance. A blur of the texture far below the lobe's own width.
const ROUGH_SPREAD: f32 = 0.05;
