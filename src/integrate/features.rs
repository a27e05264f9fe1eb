//! What a denoiser is told of a path: albedo and normal of the first rough surface.
//!
//! A path from the camera that mirrors or clear glass pass on tells of what is seen in them, with
//! what they have left of it: the product of their weights so far. Where a path chooses between
//! reflection and refraction, or is split, the throughput makes up for the chances and shares, so
//! that the sum over branches, and the mean over samples, weigh all of them. A varnished surface is
//! both: it counts by the share of the path that its rough lobes get, whichever lobe is drawn, and
//! what its varnish mirrors by the rest.
//!
//! As OIDN's manual advises, the sky has the albedo 1 and no normal, and what shines has at least
//! the colour of its light, up to 1.

use super::path::{FirstHit, Path};
use crate::bsdf::{Bsdf, LobeFlags};
use crate::film::Features;
use crate::math::{Rgb, Vec3};
use crate::scene::Scene;
use crate::scene::surface::Surface;
use crate::texture::SurfacePoint;

/// What a path from the camera meets, at a distance of `depth`.
#[inline]
pub(super) fn first_hit(
    scene: &Scene,
    surface: &Surface,
    (point, wo): (&SurfacePoint, Vec3),
    bsdf: &Bsdf,
    depth: f32,
) -> FirstHit {
    let (albedo, normal) = (bsdf.albedo(), point.frame.n);
    let specular = bsdf.flags().has(LobeFlags::DELTA);
    let as_it_is = !specular
        && !surface.glows()
        && bsdf.normal() == normal
        && point.ng.dot(wo) >= 0.0
        && point.ng.dot(normal) >= 0.0;
    FirstHit {
        albedo,
        normal,
        depth,
        features: match as_it_is {
            true => None,
            false => Some(seen(scene, surface, (point, wo), bsdf, Rgb::ONE)),
        },
        specular_edges: u32::from(specular),
    }
}

/// Adds what a path meets that has come from a mirror or from glass.
#[inline(never)]
pub(super) fn add(
    first: &mut FirstHit,
    scene: &Scene,
    surface: &Surface,
    place: (&SurfacePoint, Vec3),
    bsdf: &Bsdf,
    path: &Path,
) {
    let seen = seen(scene, surface, place, bsdf, arrived(path));
    first.features.get_or_insert(Features::NONE).add(&seen);
    if bsdf.flags().has(LobeFlags::DELTA) {
        first.specular_edges = path.depth + 1;
    }
}

/// The same where the path has left the scene: the sky has no normal, like a medium.
#[inline(never)]
pub(super) fn add_sky(first: &mut FirstHit, path: &Path) {
    add_collision(first, Rgb::ONE, path);
}

/// What a path from the camera meets where it collides inside of a medium.
pub(super) fn first_collision(albedo: Rgb, depth: f32) -> FirstHit {
    FirstHit {
        albedo,
        normal: Vec3::ZERO,
        depth,
        features: Some(Features {
            albedo,
            normal: Vec3::ZERO,
            weight: 1.0,
        }),
        specular_edges: 0,
    }
}

/// The same of a path that has come from a mirror or from glass.
pub(super) fn add_collision(first: &mut FirstHit, albedo: Rgb, path: &Path) {
    let arrived = arrived(path);
    let seen = Features {
        albedo: arrived * albedo,
        normal: Vec3::ZERO,
        weight: mean(arrived),
    };
    first.features.get_or_insert(Features::NONE).add(&seen);
}

/// What is seen of a surface that this much of a path arrives at; a part of it where the surface
/// mirrors, too.
#[inline(never)]
fn seen(
    scene: &Scene,
    surface: &Surface,
    (point, wo): (&SurfacePoint, Vec3),
    bsdf: &Bsdf,
    arrived: Rgb,
) -> Features {
    let arrived = arrived * bsdf.rough_share(wo);
    let mut albedo = bsdf.albedo();
    if surface.glows() {
        albedo = albedo.max(scene.emitted(surface, point, wo).min(Rgb::ONE));
    }
    let weight = mean(arrived);
    Features {
        albedo: arrived * albedo,
        normal: facing(bsdf.normal(), point, wo) * weight,
        weight,
    }
}

/// What mirrors and glass have left of a path, without what radiance gains in denser media.
#[inline]
fn arrived(path: &Path) -> Rgb {
    path.throughput * (path.eta * path.eta)
}

#[inline]
fn mean(color: Rgb) -> f32 {
    color.element_sum() * (1.0 / 3.0)
}

/// A normal on the side of the surface that is seen from `wo`.
#[inline]
fn facing(n: Vec3, point: &SurfacePoint, wo: Vec3) -> Vec3 {
    let side = match point.ng.dot(wo) < 0.0 {
        true => -point.ng,
        false => point.ng,
    };
    if n.dot(side) < 0.0 { -n } else { n }
}
