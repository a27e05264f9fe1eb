//! Random numbers with more digits near 0 and 1.
//!
//! A uniform `f32` is a multiple of 2^-24 at best: a chance of 1e-8 would never be taken, or six
//! times too often.

use crate::math::rng::BELOW_ONE;

/// Numbers closer than this to 0 or 1 get a second draw.
const NEAR: f64 = 1.0 / 1024.0;
/// Of the first draw these many values are kept then.
const COARSE: f64 = 65536.0;

/// Uniform in [0, 1), from draws that are; near 0 and near 1 in steps of 2^-40.
#[inline]
pub(super) fn uniform(u: &mut impl FnMut() -> f32) -> f64 {
    let first = f64::from(u());
    if (NEAR..=1.0 - NEAR).contains(&first) {
        return first;
    }
    // Given which of 65536 intervals it is, the place in it is uniform.
    let interval = (first * COARSE).floor().clamp(0.0, COARSE - 1.0);
    let place = f64::from(u()).clamp(0.0, f64::from(BELOW_ONE));
    (interval + place) / COARSE
}

/// Exponentially distributed with mean 1: the optical depth up to a collision. Finite.
#[inline]
pub(super) fn exponential(u: &mut impl FnMut() -> f32) -> f64 {
    -(-uniform(u)).ln_1p()
}
