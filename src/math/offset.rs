//! Where a ray may start: outside the rounding error of the point it leaves.
//!
//! A hit point computed in `f32` lies up to `error` away from the true surface. A ray that starts
//! there can meet the same surface again. [`offset_origin`] moves the start along the *geometric*
//! normal by that bound, to the side the ray leaves on, and then one float further on each axis
//! (Pharr, Jakob, Humphreys, "Physically Based Rendering", 4th ed., 6.8.6).

use glam::Vec3;

/// Rounding error bound of `n` chained `f32` operations, relative to the operands' magnitude.
#[inline]
pub const fn gamma(n: u32) -> f32 {
    let nu = n as f32 * (f32::EPSILON * 0.5);
    nu / (1.0 - nu)
}

/// A point that is exact (on a plane through the origin, say) must leave its surface as well, and
/// by more than a denormal: threads that trace flush those to zero. Next to any other coordinate
/// this vanishes. Guarded by `an_exact_point_leaves_its_surface`.
const SMALLEST_OFFSET: f32 = 1e-30;

/// The origin for a ray that leaves `p` (known to within `error` on each axis) in direction `dir`,
/// off a surface with unit geometric normal `ng` (either orientation).
#[inline]
pub fn offset_origin(p: Vec3, error: Vec3, ng: Vec3, dir: Vec3) -> Vec3 {
    let distance = ng.abs().dot(error).max(SMALLEST_OFFSET);
    let offset = ng
        * if dir.dot(ng) < 0.0 {
            -distance
        } else {
            distance
        };
    let moved = p + offset;
    Vec3::new(
        nudge(moved.x, offset.x),
        nudge(moved.y, offset.y),
        nudge(moved.z, offset.z),
    )
}

/// The origin for a ray that leaves a point which was not met but sampled on a surface with unit
/// normal `n`: it is exact to a few roundings.
#[inline]
pub fn offset_sampled(p: Vec3, n: Vec3, dir: Vec3) -> Vec3 {
    offset_origin(p, p.abs() * (8.0 * f32::EPSILON), n, dir)
}

/// One float further towards the sign of `toward`. (`f32::next_up` needs a newer compiler than
/// Debian 13's.)
///
/// Computed both ways and then chosen from: which way it goes is chance, and a processor that
/// guesses it wrong loses more time than this takes.
#[inline]
fn nudge(x: f32, toward: f32) -> f32 {
    // A float's bits, read as a number, grow with its magnitude.
    let bits = x.to_bits();
    let to_zero = (bits ^ toward.to_bits()) >> 31;
    let next = f32::from_bits(bits.wrapping_add(1).wrapping_sub(2 * to_zero));
    let smallest = f32::from_bits(1).copysign(toward);
    let moved = if x == 0.0 { smallest } else { next };
    if (toward == 0.0) | !x.is_finite() {
        x
    } else {
        moved
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exact_point_leaves_its_surface() {
        for side in [1.0f32, -1.0] {
            let dir = Vec3::new(0.6, 0.0, 0.8 * side);
            let org = offset_origin(Vec3::new(0.3, 0.2, 0.0), Vec3::ZERO, Vec3::Z, dir);
            assert!(org.z.is_normal() && org.z * side > 0.0, "{org}");
            assert_eq!((org.x, org.y), (0.3, 0.2));
            let org = offset_origin(Vec3::new(0.3, 0.2, 5.0), Vec3::ZERO, Vec3::Z, dir);
            assert!((org.z - 5.0) * side > 0.0, "{org}");
        }
    }
}
