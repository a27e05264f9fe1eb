//! One vertex of a camera path.

use super::aim::{aim, aims};
use super::chain::{Place, Station};
use super::emission::{add_emission, add_environment};
use super::forks::Forks;
use super::guiding::{Guidance, GuidedVertex};
use super::lots::{self, Left};
use super::next_event::{ShadowRay, sample_light};
use super::onward::{go_on, leave, watch};
use super::record::{Arrival, Witness};
use super::reuse::{Admission, Pool, Stage};
use super::roulette;
use super::wave::{FirstHit, Outcome, Path};
use super::{PathSettings, Roulette};
use crate::accel::{Hit, Ray};
use crate::bsdf::{Apart, Bsdf, BsdfSample, LobeFlags, Rest};
use crate::math::{Rgb, Vec3};
use crate::scene::Scene;
use crate::scene::surface::DARK;
use crate::texture::SurfacePoint;

/// How a path goes on.
#[derive(Clone, Copy, Debug)]
pub struct Next {
    /// The next ray, or none if the path ends.
    pub ray: Option<Ray>,
    /// A shadow ray to trace.
    pub shadow: Option<(Ray, ShadowRay)>,
    /// Light for an account.
    pub found: Option<(u32, Rgb)>,
    /// Rays that were traced here.
    pub rays: u32,
}

impl Next {
    /// The path ends here.
    pub const END: Next = Next {
        ray: None,
        shadow: None,
        found: None,
        rays: 0,
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
pub struct Watched<'w, 's, W: Witness> {
    /// The path's account.
    pub outcome: &'w mut Outcome,
    /// Where ways that split off go.
    pub forks: &'w mut Forks,
    /// The rough vertices that paths have left.
    pub stations: &'w mut Vec<Station>,
    /// What paths share.
    pub pool: &'w mut Pool<'s>,
    /// Who looks on.
    pub witness: &'w mut W,
}

impl<W: Witness> Watched<'_, '_, W> {
    fn arrive(&mut self, path: &Path, distance: f32) {
        let so_far = self.outcome.radiance;
        self.witness.arrive(path.slot, so_far, distance);
    }
}

/// Handles what `ray` met: adds emission to the path's account, samples a light, samples the BSDF (and the
/// field, with a guide), splits the path or plays roulette.
///
/// `GUIDED` says whether the walk may have a guide: otherwise what only guided paths do is left out when this
/// is compiled. It stands in its caller so that rays and paths need not be handed over through memory:
/// what was just written by halves would be waited for when it is read as a whole.
#[inline(always)]
pub fn visit<'s, const GUIDED: bool>(
    walk: &Walk<'s>,
    ray: &Ray,
    hit: &Hit,
    path: &mut Path,
    mut watched: Watched<'_, 's, impl Witness>,
) -> Next {
    let Walk {
        scene, settings, ..
    } = *walk;
    if !hit.is_some() {
        watched.arrive(path, f32::INFINITY);
        add_environment(walk, ray, path, watched.stations, watched.outcome);
        return Next::END;
    }
    let surface = &scene.surfaces.list[hit.shape as usize];
    let point = scene
        .surfaces
        .point(ray, hit, path.cone_width + path.cone_spread * hit.t);
    let wo = -ray.dir;
    watched.arrive(path, hit.t);
    if surface.emitter != DARK {
        add_emission(
            walk,
            surface,
            (&point, wo),
            path,
            watched.stations,
            watched.outcome,
        );
    }
    if path.depth + 1 >= settings.max_depth && path.depth > 0 {
        return Next::END;
    }
    let mut bsdf = scene
        .surfaces
        .materials
        .resolve(surface.material, &point, wo);
    if path.depth == 0 {
        watched.outcome.first = FirstHit {
            albedo: bsdf.albedo(),
            normal: point.frame.n,
            depth: hit.t,
        };
        if settings.max_depth < 2 {
            return Next::END;
        }
    }
    scatter::<GUIDED>(walk, &point, &mut bsdf, wo, hit.t, path, watched)
}

/// Behind the first rough vertex of a guided path rough plastic is its coat or its base, by lot: of the base the field can
/// tell what it will bring, and it can be shared. Returns what the path is to be multiplied by. (Relative variance
/// times time of a kitchen 46 instead of 58.)
#[inline]
fn simplify(walk: &Walk, bsdf: &mut Bsdf, wo: Vec3, path: &Path) -> f32 {
    if walk.guide.is_none() || path.stage == Stage::Fresh {
        return 1.0;
    }
    // A number beside the path's own.
    let u = || path.sampler.fork(1).next4()[0];
    bsdf.choose_part(wo, u).unwrap_or(1.0)
}

/// Samples a light, and sends the path on its way or ways from a point that it met at a distance.
#[inline(always)]
fn scatter<'s, const GUIDED: bool>(
    walk: &Walk<'s>,
    point: &SurfacePoint<'s>,
    bsdf: &mut Bsdf,
    wo: Vec3,
    distance: f32,
    path: &mut Path,
    watched: Watched<'_, 's, impl Witness>,
) -> Next {
    let settings = walk.settings;
    let Watched {
        outcome,
        forks,
        stations,
        pool,
        witness,
    } = watched;
    let mut so_far = outcome.radiance;
    let (mut guided, mut apart) = (None, None);
    if GUIDED {
        let part = simplify(walk, bsdf, wo, path);
        if pool.arrive(path, point, bsdf, wo, forks) == Admission::Shares {
            so_far = Rgb::ZERO;
        }
        // What is shared is what was found by this lot: it comes after the account was opened.
        path.throughput *= part;
        path.aimed_with *= part;
        (guided, apart) = ask(walk, point, bsdf, wo, path);
    }
    let mut vertex = Vertex {
        point,
        bsdf,
        guided: guided.as_ref(),
        wo,
        lobes: apart.map_or(Rest::ALL, |apart| apart.rest),
        ways: 1,
        stem: None,
        aims: None,
    };
    let block = path.sampler.next4();
    let mut arrival = Arrival {
        throughput: path.throughput,
        radiance: so_far,
    };
    let shadow = sample_light::<GUIDED>(walk, &vertex, path, [block[0], block[1], block[2]]);
    let (mut found, mut rays) = (None, 0);
    if GUIDED {
        vertex.aims = aims(walk, &vertex, path);
        let aimed = aim(walk, &vertex, path, distance);
        if let Some(aimed) = &aimed {
            rays += aimed.rays;
            witness.aimed(&arrival, aimed);
            found = aimed.found.map(|found| path.throughput * found.light());
        }
    }
    let coming = coming::<GUIDED>(settings, &vertex, path.throughput);
    vertex.ways = coming.map_or(1, |coming| roulette::ways(path, coming));
    if GUIDED && pool.is_open() && is_stem(settings, &vertex, path, coming) {
        vertex.stem = pool.add_stem(&vertex, path, forks);
    }
    let mut go = |path: &mut Path, arrival: &Arrival, lobe: Option<BsdfSample>, u: f32| {
        let onward = go_on::<GUIDED>(settings, &vertex, path, lobe, u, arrival);
        if lobe.is_none() {
            watch(&vertex, path, arrival, onward.as_ref(), witness);
        }
        leave(&vertex, path, &onward?.0, distance, stations)
    };
    let left = apart.map_or(Left::Rest(block[3]), |apart| {
        let guided = guided.is_some();
        lots::by_lobe(&apart, guided, block[3], path, forks, &mut arrival, &mut go)
    });
    // The light that was sampled belongs to the rest of the lobes, and to all of their ways together.
    let slot = path.slot;
    let shadow = shadow.map(|(ray, offer)| (ray, ShadowRay { slot, offer }));
    let found = found.map(|radiance| (slot, radiance));
    let ray = match left {
        Left::Delta(ray) => ray,
        Left::Rest(u) if GUIDED && vertex.ways > 1 => {
            forks.split(vertex.ways, path, |path, arrival| {
                go(path, arrival, None, u)
            })
        }
        Left::Rest(u) => go(path, &arrival, None, u),
    };
    Next {
        ray,
        shadow,
        found,
        rays,
    }
}

/// What the field says at a vertex, for the lobes that the path's own direction is drawn among, and the delta lobe
/// that is followed beside them.
#[inline]
fn ask<'s>(
    walk: &Walk<'s>,
    point: &SurfacePoint,
    bsdf: &Bsdf,
    wo: Vec3,
    path: &mut Path,
) -> (Option<GuidedVertex<'s>>, Option<Apart>) {
    let guide = walk.guide;
    let guided = guide.and_then(|g| g.at(point, bsdf, wo, path.throughput));
    if guided.is_some() {
        path.lots = lots::AIMED;
    }
    let apart = lots::apart(path, guided.is_some(), bsdf, wo);
    let lobes = apart.map_or(Rest::ALL, |apart| apart.rest);
    (guided.map(|g| g.among(lobes, bsdf)), apart)
}

/// What a path that came with this throughput will bring by the field's account, if the field can tell and is
/// to be asked.
#[inline]
pub(super) fn coming<const GUIDED: bool>(
    settings: &PathSettings,
    vertex: &Vertex,
    throughput: Rgb,
) -> Option<f32> {
    if !GUIDED || settings.roulette != Roulette::Field {
        return None;
    }
    let reflected = vertex.guided?.reflected()?;
    Some((throughput * reflected).element_sum())
}

/// Whether a path leaves its first rough vertex here, and for certain in one direction that is drawn from a density:
/// among smooth lobes alone, with nothing to end or split it. `coming` is what it will bring, if that is known.
#[inline]
fn is_stem(settings: &PathSettings, vertex: &Vertex, path: &Path, coming: Option<f32>) -> bool {
    let first = path.stage == Stage::Fresh && vertex.guided.is_some();
    let smooth = vertex.lobes != Rest::ALL || !vertex.bsdf.flags().has(LobeFlags::DELTA);
    // What roulette will say.
    let certain = match coming {
        Some(_) => path.expected <= 0.0,
        None => path.depth + 1 < settings.rr_depth,
    };
    first && smooth && certain && vertex.ways == 1
}

/// What is known at a vertex.
pub(super) struct Vertex<'v, 's> {
    pub point: &'v SurfacePoint<'s>,
    pub bsdf: &'v Bsdf,
    pub guided: Option<&'v GuidedVertex<'s>>,
    pub wo: Vec3,
    /// The lobes among which the path's own direction is drawn.
    pub lobes: Rest,
    /// Directions in which the path goes on.
    pub ways: u32,
    /// The number of the stem that ends here.
    pub stem: Option<u32>,
    /// Where chains are sampled here, and how often.
    pub aims: Option<(Place, f32)>,
}
