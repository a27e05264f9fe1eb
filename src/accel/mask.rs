//! Masked geometry: whether a hit on a half-transparent surface counts.
//!
//! A hit is kept with probability [`Opacity::opacity`]. The random number is a hash of the ray's
//! origin and direction (the bits the caller gave, not the ones rounded into an instance's space)
//! and of what was hit, the walls of round shapes told apart. So closest hits, shadow rays,
//! packets, single rays and both backends decide alike.

use super::{Hit, Opacity, Ray};
use crate::math::rng::{hash_all, unit_f32};

/// Whether `ray`'s `hit` on a masked geometry is to be kept. `wall` is the crossing's with an exact
/// shape, 0 with triangles.
pub fn keeps(opacity: &dyn Opacity, ray: &Ray, hit: &Hit, wall: u32) -> bool {
    let alpha = opacity.opacity(hit);
    if alpha >= 1.0 {
        return true;
    }
    uniform(ray, hit, wall) < alpha
}

/// A number in `[0, 1)` that belongs to this ray and this wall of this primitive.
fn uniform(ray: &Ray, hit: &Hit, wall: u32) -> f32 {
    let pair = |a: u32, b: u32| u64::from(a) | u64::from(b) << 32;
    let hash = hash_all([
        pair(ray.org.x.to_bits(), ray.org.y.to_bits()),
        pair(ray.org.z.to_bits(), ray.dir.x.to_bits()),
        pair(ray.dir.y.to_bits(), ray.dir.z.to_bits()),
        pair(hit.shape, hit.instance),
        pair(hit.prim, wall),
    ]);
    unit_f32((hash >> 32) as u32)
}
