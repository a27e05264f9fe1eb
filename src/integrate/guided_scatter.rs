//! How a guided path scatters: the field shapes what is sampled, and paths are split.

use super::bounce::{Arrived, BounceResult, Scatter};
use super::context::PathContext;
use super::guided_direction::{DirectionSplit, GuidedDeparture};
use super::guided_path::{GuidedPath, PrefixState};
use super::guided_vertex::GuidedVertex;
use super::lobe_splitting::{self, Remainder};
use super::manifold::{LastRoughVertex, receiver, sample_manifold};
use super::next_event::{ShadowRay, sample_light};
use super::observer::PathObserver;
use super::path::{Arrival, FirstHit, NO_CELL, Path};
use super::reuse::{Admission, PrefixPool};
use super::splitting::SplitPaths;
use super::vertex::Vertex;
use crate::bsdf::{Bsdf, BsdfSample, DeltaSplit, Rest};
use crate::guide::LightChoice;
use crate::light::Shining;
use crate::math::{Rgb, Vec3};
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

    #[inline]
    fn seen_by<'f>(
        &self,
        path: &GuidedPath,
        first_hits: &'f mut [FirstHit],
    ) -> Option<&'f mut FirstHit> {
        if path.prefix != PrefixState::Growing {
            return None;
        }
        let sample = self.split_paths.sample_of(path.base.accumulator);
        Some(&mut first_hits[sample as usize])
    }

    fn accumulators(&self) -> Option<usize> {
        Some(self.split_paths.accumulators())
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
        media,
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
    let (guided, delta) = query_field(context, point, bsdf, wo, path);
    let mut vertex = Vertex {
        point,
        bsdf,
        wo,
        guided: guided.as_ref(),
        media,
        light_choice: LightChoice::NONE,
    };
    let [u0, u1, u2, u_lobe] = path.base.sampler.next4();
    let mut arrival = Arrival {
        throughput: path.base.throughput,
        radiance,
    };

    // ------------------------ Emitter sampling ------------------------
    let probability = guided.as_ref().map_or(1.0, GuidedVertex::light_probability);
    let mut selection = guided
        .as_ref()
        .map(GuidedVertex::light_selection)
        .unwrap_or_default();
    path.base.light_cell = guided.as_ref().map_or(NO_CELL, GuidedVertex::light_cell);
    let shadow = sample_light(
        context,
        &vertex,
        &mut path.base,
        probability,
        &mut selection,
        [u0, u1, u2],
    );
    vertex.light_choice = selection.choice;

    // ---------------- Manifold next-event estimation ------------------
    let receiver = receiver(context, &vertex, path);
    let chain = sample_manifold(context, &vertex, receiver, path, distance);
    if let Some(chain) = &chain {
        **rays += u64::from(chain.rays);
        observer.sampled_manifold(&arrival, chain);
    }
    let by_chain = chain.and_then(|chain| chain.found);
    let bounces = path.base.depth + 1;
    let by_chain = by_chain.map(|light| (light, path.base.throughput * light.light()));

    // ------------- Field and BSDF sampling, path splitting ------------
    let mut departure = GuidedDeparture {
        split: DirectionSplit::decide(settings, &vertex, path),
        vertex,
        lobes: delta.map_or(Rest::ALL, |delta| delta.rest),
        prefix: None,
        receiver,
        distance,
    };
    if pool.is_open() && departure.ends_prefix(settings, path) {
        departure.prefix = pool.add_prefix(&departure.vertex, path, split_paths);
    }
    let mut go = |path: &mut GuidedPath, arrival: &Arrival, lobe: Option<BsdfSample>, u: f32| {
        departure.go(settings, path, (arrival, lobe, u), rough_vertices, observer)
    };
    let guided = guided.is_some();
    let remainder = delta.map_or(Remainder::Smooth(u_lobe), |delta| {
        lobe_splitting::split(
            &delta,
            guided,
            u_lobe,
            path,
            split_paths,
            &mut arrival,
            &mut go,
        )
    });
    // The light that was sampled belongs to the other lobes, and to all of their directions.
    let accumulator = path.base.accumulator;
    found.extend(by_chain.map(|(_, radiance)| (accumulator, radiance)));
    let shadow = shadow.map(|(ray, offer)| (ray, ShadowRay { accumulator, offer }));
    let ray = match remainder {
        Remainder::Delta(ray) => ray,
        Remainder::Smooth(u) => {
            let go = |path: &mut GuidedPath, arrival: &Arrival| go(path, arrival, None, u);
            split_paths.split(departure.split.factor, path, &arrival, go)
        }
    };
    if let Some((light, radiance)) = by_chain {
        observer.shines(accumulator, bounces + light.chain, radiance, light.from);
    }
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
    let Path {
        throughput, depth, ..
    } = path.base;
    let guided = guide.and_then(|g| g.at(point, bsdf, wo, throughput, depth));
    if guided.is_some() {
        path.split_budget = lobe_splitting::GUIDED;
    }
    let split = lobe_splitting::delta_and_rest(path, guided.is_some(), bsdf, wo);
    let lobes = split.map_or(Rest::ALL, |split| split.rest);
    (guided.map(|g| g.among(lobes, bsdf)), split)
}
