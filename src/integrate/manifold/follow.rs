//! A chain of mirrors and clear glass, followed.

use super::ray_differential::RayDifferential;
use crate::accel::{Hit, Ray};
use crate::bsdf::{Bsdf, BsdfSample, LobeFlags, Transport};
use crate::math::frame::normals_disagree;
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use crate::scene::Scene;

/// The kinds of scattering along a chain, from the rough vertex outwards: two bits each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct SpecularChain(u32);

/// Most scatterings of a chain.
pub const LONGEST: u32 = 8;

/// The bits of a delta lobe's kind.
fn bits(lobe: LobeFlags) -> u32 {
    if lobe.has(LobeFlags::NULL) {
        3
    } else if lobe.has(LobeFlags::TRANSMISSION) {
        2
    } else {
        1
    }
}

impl SpecularChain {
    /// None yet.
    pub const EMPTY: Self = Self(0);
    /// More than are told apart.
    pub const LOST: Self = Self(u32::MAX);

    /// How many.
    #[inline]
    pub fn len(self) -> u32 {
        (u32::BITS - self.0.leading_zeros()).div_ceil(2)
    }

    /// Whether there is none.
    #[inline]
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }

    /// With one more at the far end.
    #[inline]
    pub fn then(self, lobe: LobeFlags) -> Self {
        let len = self.len();
        if len >= LONGEST {
            return Self::LOST;
        }
        Self(self.0 | bits(lobe) << (2 * len))
    }

    /// With one more at the rough vertex' end.
    #[inline]
    pub fn before(self, lobe: LobeFlags) -> Self {
        if self.len() >= LONGEST {
            return Self::LOST;
        }
        Self(self.0 << 2 | bits(lobe))
    }
}

/// The cone that a ray stands for.
#[derive(Clone, Copy, Debug)]
pub struct Cone {
    /// Its width where the ray begins.
    pub width: f32,
    /// Growth of that per unit distance.
    pub spread: f32,
}

impl Cone {
    /// None: textures are seen as sharp as they are.
    pub const NONE: Self = Self {
        width: 0.0,
        spread: 0.0,
    };

    /// Widens it over a distance.
    #[inline]
    pub fn grow(&mut self, distance: f32) {
        self.width += self.spread * distance;
    }
}

/// Where a chain leads.
#[derive(Clone, Copy, Debug)]
pub struct Arrived {
    /// The ray behind the last of its scatterings.
    pub ray: Ray,
    /// What the lobes let through.
    pub weight: Rgb,
    /// What the ray stands for.
    pub cone: Cone,
    /// Its neighbours, if they are asked for and known.
    pub pencil: Option<RayDifferential>,
}

/// The delta lobe of a kind, with its value instead of a weight.
fn lobe(bsdf: &Bsdf, wo: Vec3, kind: u32) -> Option<BsdfSample> {
    if !bsdf.flags().has(LobeFlags::DELTA) {
        return None;
    }
    // Reflection comes first, mostly: where it is not wanted, it is not looked at first.
    let either = if kind == 1 {
        [0.0, BELOW_ONE]
    } else {
        [BELOW_ONE, 0.0]
    };
    either.into_iter().find_map(|u| {
        let mut sample = bsdf.sample(wo, u, Vec2::splat(0.5), Transport::Radiance)?;
        sample.weight *= sample.pdf;
        (sample.lobe.has(LobeFlags::DELTA) && bits(sample.lobe) == kind).then_some(sample)
    })
}

/// Where the ray goes on from what it met, by a lobe of the kind.
fn pass(scene: &Scene, arrived: Arrived, hit: &Hit, kind: u32, strict: bool) -> Option<Arrived> {
    let Arrived {
        ray,
        mut cone,
        pencil,
        ..
    } = arrived;
    cone.grow(hit.t);
    let surface = scene.surfaces.met(hit)?;
    let point = scene.surfaces.point(&ray, hit, cone.width);
    let wo = -ray.dir;
    let sample = lobe(&scene.surfaces.bsdf(surface, &point, wo), wo, kind)?;
    if strict && normals_disagree(point.normals(), [sample.wi, wo]) {
        return None;
    }
    Some(Arrived {
        ray: point.spawn_ray(sample.wi),
        weight: arrived.weight * sample.weight,
        cone,
        pencil: pencil.and_then(|p| p.pass(scene, (&ray, hit), &point, &sample)),
    })
}

/// Follows a chain along a ray; `seen` is told each ray and what it met.
pub fn follow(
    scene: &Scene,
    ray: Ray,
    (chain, cone): (SpecularChain, Cone),
    strict: bool,
    seen: &mut impl FnMut(&Ray, &Hit),
) -> Option<Arrived> {
    walk(scene, ray, chain, (cone, None), strict, seen)
}

/// The same, with the neighbours of the ray.
pub fn follow_differential(
    scene: &Scene,
    ray: Ray,
    pencil: RayDifferential,
    chain: SpecularChain,
) -> Option<Arrived> {
    let with = (Cone::NONE, Some(pencil));
    walk(scene, ray, chain, with, false, &mut |_, _| {})
}

fn walk(
    scene: &Scene,
    ray: Ray,
    chain: SpecularChain,
    (cone, pencil): (Cone, Option<RayDifferential>),
    strict: bool,
    seen: &mut impl FnMut(&Ray, &Hit),
) -> Option<Arrived> {
    let mut arrived = Arrived {
        ray,
        weight: Rgb::ONE,
        cone,
        pencil,
    };
    let mut kinds = chain.0;
    while kinds != 0 {
        let hit = scene.first_hit(&arrived.ray);
        seen(&arrived.ray, &hit);
        arrived = pass(scene, arrived, &hit, kinds & 3, strict)?;
        kinds >>= 2;
    }
    Some(arrived)
}
