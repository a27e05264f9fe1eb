//! How a guided path scatters: the field shapes what is sampled, and paths are split.

use super::bounce::{Arrived, BounceResult, Scatter};
use super::context::PathContext;
use super::direction::{drops, record_departure, spawn_ray};
use super::guided_path::{GuidedPath, NO_ROUGH_VERTEX, PrefixState};
use super::guiding::GuidedVertex;
use super::lobe_splitting::{self, Remainder};
use super::manifold::{LastRoughVertex, Receiver, SpecularChain, receiver, sample_manifold};
use super::next_event::{ShadowRay, sample_light};
use super::observer::PathObserver;
use super::path::Arrival;
use super::reuse::{Admission, PrefixPool};
use super::roulette;
use super::settings::{PathSettings, Roulette};
use super::splitting::SplitPaths;
use super::vertex::Vertex;
use crate::accel::Ray;
use crate::bsdf::{Bsdf, BsdfSample, DeltaSplit, LobeFlags, Rest, Transport};
use crate::light::Shining;
use crate::math::{Rgb, Vec2, Vec3};
use crate::texture::SurfacePoint;

/// What the guided paths of a wave write to, besides their outcomes.
pub struct GuidedOutput<'w, 's> {
    /// Paths that were split off.
    pub split_paths: &'w mut SplitPaths,
    /// The rough vertices that paths have left.
    pub rough_vertices: &'w mut Vec<LastRoughVertex>,
    /// What paths share.
    pub pool: &'w mut PrefixPool<'s>,
    /// Radiance that vertices found by manifold next-event estimation, by accumulator.
    pub found: &'w mut Vec<(u32, Rgb)>,
    /// Rays that this took are added here.
    pub rays: &'w mut u64,
}

/// A vertex of a guided path, and how the path goes on from there.
struct GuidedScattering<'v, 's> {
    vertex: Vertex<'v, 's>,
    /// The lobes among which the path's own direction is drawn.
    lobes: Rest,
    /// Directions in which the path goes on.
    split_factor: u32,
    /// The number of the prefix that ends here.
    prefix: Option<u32>,
    /// Where manifold next-event estimation samples from, and with which probability.
    receiver: Option<(Receiver, f32)>,
    /// Distance from the vertex before.
    distance: f32,
}

impl<'s> Scatter<'s> for GuidedOutput<'_, 's> {
    type Path = GuidedPath;

    /// MIS weight of a light that a path meets behind mirrors and glass, against manifold
    /// next-event estimation at its last rough vertex.
    fn weight_after_delta(
        &self,
        context: &PathContext<'s>,
        path: &GuidedPath,
        light: Shining,
    ) -> f32 {
        let manifold = context.guide.and_then(|guide| guide.manifold());
        let vertex = self.rough_vertices.get(path.rough_vertex as usize);
        let (Some(manifold), Some(vertex)) = (manifold, vertex) else {
            return 1.0;
        };
        let chains = manifold.chains();
        chains.weight(context.scene, vertex, path.chain, light)
    }

    #[inline(always)]
    fn scatter(
        &mut self,
        context: &PathContext<'s>,
        at: Arrived<'_, 's>,
        path: &mut GuidedPath,
        observer: &mut impl PathObserver,
    ) -> BounceResult {
        scatter(context, at, path, self, observer)
    }
}

/// Samples a light, a specular chain to one, and the next direction or directions.
#[inline(always)]
fn scatter<'s>(
    context: &PathContext<'s>,
    at: Arrived<'_, 's>,
    path: &mut GuidedPath,
    output: &mut GuidedOutput<'_, 's>,
    observer: &mut impl PathObserver,
) -> BounceResult {
    let settings = context.settings;
    let Arrived {
        point,
        bsdf,
        wo,
        distance,
        mut radiance,
    } = at;
    let GuidedOutput {
        split_paths,
        rough_vertices,
        pool,
        found,
        rays,
    } = output;
    let weight = choose_layer(context, bsdf, wo, path);
    if pool.arrive(path, point, bsdf, wo, split_paths) == Admission::Shares {
        radiance = Rgb::ZERO;
    }
    // What is shared is what this choice found: it counts after the accumulator was made.
    path.base.throughput *= weight;
    path.reference_throughput *= weight;
    let (guided, split) = query_field(context, point, bsdf, wo, path);
    let mut at = GuidedScattering {
        vertex: Vertex {
            point,
            bsdf,
            wo,
            guided: guided.as_ref(),
        },
        lobes: split.map_or(Rest::ALL, |split| split.rest),
        split_factor: 1,
        prefix: None,
        receiver: None,
        distance,
    };
    let u = path.base.sampler.next4();
    let mut arrival = Arrival {
        throughput: path.base.throughput,
        radiance,
    };

    // ------------------------ Emitter sampling ------------------------
    let chance = guided.as_ref().map_or(1.0, GuidedVertex::light_chance);
    let shadow = sample_light(
        context,
        &at.vertex,
        &mut path.base,
        chance,
        [u[0], u[1], u[2]],
    );

    // ---------------- Manifold next-event estimation ------------------
    at.receiver = receiver(context, &at.vertex, path);
    let chain = sample_manifold(context, &at.vertex, at.receiver, path, distance);
    if let Some(chain) = &chain {
        **rays += u64::from(chain.rays);
        observer.sampled_manifold(&arrival, chain);
    }
    let by_chain = chain.and_then(|chain| chain.found);
    let by_chain = by_chain.map(|light| path.base.throughput * light.light());

    // ------------- Field and BSDF sampling, path splitting ------------
    let expected = expected_contribution(settings, &at.vertex, path.base.throughput);
    at.split_factor = expected.map_or(1, |expected| roulette::split_factor(path, expected));
    if pool.is_open() && ends_prefix(settings, &at, path, expected) {
        at.prefix = pool.add_prefix(&at.vertex, path, split_paths);
    }
    let mut go = |path: &mut GuidedPath, arrival: &Arrival, lobe: Option<BsdfSample>, u: f32| {
        let sampled = sample_direction(settings, &at, path, lobe, u, arrival);
        if lobe.is_none() {
            let whole = at.split_factor == 1;
            let base = &path.base;
            record_departure(&at.vertex, whole, base, arrival, sampled.as_ref(), observer);
        }
        Some(leave(&at, path, &sampled?.0, rough_vertices))
    };
    let remainder = split.map_or(Remainder::Smooth(u[3]), |split| {
        let guided = guided.is_some();
        lobe_splitting::split(
            &split,
            guided,
            u[3],
            path,
            split_paths,
            &mut arrival,
            &mut go,
        )
    });
    // The light that was sampled belongs to the other lobes, and to all of their directions.
    let accumulator = path.base.accumulator;
    found.extend(by_chain.map(|radiance| (accumulator, radiance)));
    let shadow = shadow.map(|(ray, offer)| (ray, ShadowRay { accumulator, offer }));
    let ray = match remainder {
        Remainder::Delta(ray) => ray,
        Remainder::Smooth(u) if at.split_factor > 1 => {
            split_paths.split(at.split_factor, path, |path, arrival| {
                go(path, arrival, None, u)
            })
        }
        Remainder::Smooth(u) => go(path, &arrival, None, u),
    };
    BounceResult { ray, shadow }
}

/// Behind the first rough vertex of a guided path rough plastic is its coat or its base, by
/// chance: of the base the field can tell what it will bring, and it can be shared. Returns what
/// the path is to be multiplied by. (Relative variance times time of a kitchen 46 instead of 58.)
#[inline]
fn choose_layer(context: &PathContext, bsdf: &mut Bsdf, wo: Vec3, path: &GuidedPath) -> f32 {
    if context.guide.is_none() || path.prefix == PrefixState::Growing {
        return 1.0;
    }
    // A number beside the path's own.
    let u = || path.base.sampler.fork(1).next4()[0];
    bsdf.choose_part(wo, u).unwrap_or(1.0)
}

/// What the field says at a vertex, for the lobes that the path's own direction is drawn among, and
/// the delta lobe that is followed beside them.
#[inline]
fn query_field<'s>(
    context: &PathContext<'s>,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    path: &mut GuidedPath,
) -> (Option<GuidedVertex<'s>>, Option<DeltaSplit>) {
    let guide = context.guide;
    let guided = guide.and_then(|g| g.at(point, bsdf, wo, path.base.throughput));
    if guided.is_some() {
        path.split_budget = lobe_splitting::GUIDED;
    }
    let split = lobe_splitting::delta_and_rest(path, guided.is_some(), bsdf, wo);
    let lobes = split.map_or(Rest::ALL, |split| split.rest);
    (guided.map(|g| g.among(lobes, bsdf)), split)
}

/// What a path that came with this throughput will bring by the field, if the field can tell and is
/// to be asked.
#[inline]
fn expected_contribution(settings: &PathSettings, vertex: &Vertex, throughput: Rgb) -> Option<f32> {
    if settings.roulette != Roulette::Field {
        return None;
    }
    let reflected = vertex.guided?.reflected()?;
    Some((throughput * reflected).element_sum())
}

/// Whether a path leaves its first rough vertex here, and for certain in one direction that is
/// drawn from a density: among smooth lobes alone, with nothing to end or split it. `expected` is
/// what it will bring, if that is known.
#[inline]
fn ends_prefix(
    settings: &PathSettings,
    at: &GuidedScattering,
    path: &GuidedPath,
    expected: Option<f32>,
) -> bool {
    let first = path.prefix == PrefixState::Growing && at.vertex.guided.is_some();
    let smooth = at.lobes != Rest::ALL || !at.vertex.bsdf.flags().has(LobeFlags::DELTA);
    // What roulette will say.
    let certain = match expected {
        Some(_) => path.pixel_estimate <= 0.0,
        None => path.base.depth + 1 < settings.rr_depth,
    };
    first && smooth && certain && at.split_factor == 1
}

/// The next direction, of the mixture of BSDF and field (or `lobe`, if that is drawn already), and
/// the probability with which roulette let the path take it, both already part of the throughput.
#[inline(always)]
fn sample_direction(
    settings: &PathSettings,
    at: &GuidedScattering,
    path: &mut GuidedPath,
    lobe: Option<BsdfSample>,
    u_roulette: f32,
    arrival: &Arrival,
) -> Option<(BsdfSample, f32)> {
    let Vertex {
        bsdf, wo, guided, ..
    } = at.vertex;
    let u = path.base.sampler.next4();
    path.base.depth += 1;
    let sample = match (lobe, guided) {
        (Some(lobe), _) => lobe,
        (None, Some(guided)) => guided.sample(bsdf, wo, u)?,
        (None, None) => {
            let u_lobe = at.lobes.choose(u[0]);
            bsdf.sample(wo, u_lobe, Vec2::new(u[1], u[2]), Transport::Radiance)?
        }
    };
    if drops(settings, &at.vertex, sample.wi) {
        return None;
    }
    path.base.throughput *= sample.weight;
    // Underflown: whatever it would meet counts for nothing (S21).
    if path.base.throughput == Rgb::ZERO {
        return None;
    }
    path.base.eta *= sample.eta;
    let by_field = guided.is_some() && settings.roulette == Roulette::Field;
    let expected = match lobe {
        // What the field expects comes by the smooth lobes.
        Some(_) => None,
        None => expected_contribution(settings, &at.vertex, arrival.throughput),
    };
    let survival = match expected {
        Some(expected) => roulette::by_field(path, expected),
        None if path.base.depth < settings.rr_depth => 1.0,
        None if by_field => roulette::MAX_SURVIVAL,
        None => roulette::by_throughput(&path.base, path.reference_throughput),
    };
    if u_roulette >= survival {
        return None;
    }
    path.base.throughput /= survival;
    if by_field {
        path.reference_throughput = roulette::scaled_throughput(&path.base);
    }
    Some((sample, survival))
}

/// The ray along a sampled direction; keeps what later vertices need to know of this one.
#[inline(always)]
fn leave(
    at: &GuidedScattering,
    path: &mut GuidedPath,
    sample: &BsdfSample,
    rough_vertices: &mut Vec<LastRoughVertex>,
) -> Ray {
    if sample.lobe.has(LobeFlags::DELTA) {
        path.chain = path.chain.then(sample.lobe);
    } else {
        path.chain = SpecularChain::EMPTY;
        path.rough_vertex = NO_ROUGH_VERTEX;
        if let Some((receiver, chance)) = at.receiver {
            path.rough_vertex = rough_vertices.len() as u32;
            rough_vertices.push(LastRoughVertex {
                receiver,
                dir: sample.wi,
                pdf: sample.pdf,
                chance,
            });
        }
        path.prefix = at.prefix.map_or(PrefixState::Past, PrefixState::EndsHere);
    }
    spawn_ray(&at.vertex, &mut path.base, sample, at.distance)
}
