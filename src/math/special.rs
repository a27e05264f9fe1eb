//! Functions in single precision that the standard library lacks or has too slowly: the error
//! function and its inverse, which sampling Beckmann's microfacets needs, the exponential, which
//! mixtures of Gaussians are made of, and an angle, which finding a direction's cell needs several
//! times at every vertex.

use super::rng::BELOW_ONE;
use std::f32::consts::{FRAC_PI_2, PI};

/// erf(x), with an absolute error below 3e-7 (Abramowitz and Stegun 1964, 7.1.26).
///
/// ```
/// assert!((twintree::math::special::erf(0.5) - 0.520_499_9).abs() < 1e-6);
/// ```
#[inline]
pub fn erf(x: f32) -> f32 {
    let t = 1.0 / (1.0 + 0.327_591_1 * x.abs());
    let p = t
        * (0.254_829_6
            + t * (-0.284_496_74 + t * (1.421_413_8 + t * (-1.453_152 + t * 1.061_405_4))));
    (1.0 - p * exp_negative(-x * x)).copysign(x)
}

/// The arc cosines of four numbers at once, to 3e-7; what is beyond [-1, 1] is taken as these. By
/// the polynomial of Moshier's Cephes library (`asinf`), without a branch, so that the loop becomes
/// vector code.
///
/// ```
/// let [a, b, ..] = twintree::math::special::arc_cosines([0.5, -1.0, 0.0, 1.0]);
/// assert!((a - 1.047_197_6).abs() < 3e-7 && b == std::f32::consts::PI);
/// ```
#[inline]
pub fn arc_cosines(x: [f32; 4]) -> [f32; 4] {
    let mut angles = [0.0; 4];
    for i in 0..4 {
        let size = if x[i].abs() < 1.0 { x[i].abs() } else { 1.0 };
        // Beyond a half it is twice the arc sine of half the angle's sine.
        let steep = size > 0.5;
        let z = if steep { 0.5 - 0.5 * size } else { size * size };
        let sine = if steep { z.sqrt() } else { size };
        let p = (((4.216_32e-2 * z + 2.418_131e-2) * z + 4.547_002_6e-2) * z + 7.495_300_3e-2) * z
            + 1.666_675_2e-1;
        let arc = sine + sine * z * p;
        let angle = if steep { 2.0 * arc } else { FRAC_PI_2 - arc };
        angles[i] = if x[i] < 0.0 { PI - angle } else { angle };
    }
    angles
}

/// [`exp_negative`] is 0 from here on.
pub const VANISHING: f32 = -87.0;

/// e^x for x <= 0, to 2e-7; 0 from [`VANISHING`] on. Without a branch, so that loops over it become
/// vector code, and the same bits on every machine.
///
/// ```
/// assert!((twintree::math::special::exp_negative(-1.0) - 0.367_879_44).abs() < 1e-7);
/// ```
#[inline(always)]
pub fn exp_negative(x: f32) -> f32 {
    /// Adding it leaves the nearest integer in the lowest bits.
    const MAGIC: f32 = 12_582_912.0;
    let x = x.max(VANISHING);
    let shifted = x * std::f32::consts::LOG2_E + MAGIC;
    let n = shifted - MAGIC;
    // ln 2 in two parts: n times the first is exact.
    let r = (x - n * 0.693_359_4) + n * 2.121_944_4e-4;
    let p = ((((1.987_569_1e-4 * r + 1.398_2e-3) * r + 8.333_452e-3) * r + 4.166_579_6e-2) * r
        + 1.666_666_5e-1)
        * r
        + 5e-1;
    let p = p * r * r + r + 1.0;
    let power = f32::from_bits(
        ((shifted.to_bits() as i32).wrapping_shl(23)).wrapping_add(0x3f80_0000) as u32,
    );
    let value = p * power;
    if x <= VANISHING { 0.0 } else { value }
}

/// The x with erf(x) = `y`, for `y` in `[-1, 1]`; +-1 give the largest finite value, about 3.8
/// (Giles, "Approximating the erfinv function", GPU Computing Gems Jade, 2011).
#[inline]
pub fn erf_inv(y: f32) -> f32 {
    let y = y.clamp(-BELOW_ONE, BELOW_ONE);
    let w = -((1.0 - y) * (1.0 + y)).ln();
    if w < 5.0 {
        y * polynomial(&CENTRAL, w - 2.5)
    } else {
        y * polynomial(&TAIL, w.sqrt() - 3.0)
    }
}

/// The angle of the vector `(x, y)`, both not negative and not both 0, as a share of a right angle:
/// 0 along x, 1 along y. Absolute error below 2e-7. Four times as fast as `atan2`, and the same
/// bits wherever it runs.
///
/// ```
/// assert!((twintree::math::special::quarter_turn(1.0, 1.0) - 0.5).abs() < 2e-7);
/// ```
#[inline]
pub fn quarter_turn(x: f32, y: f32) -> f32 {
    let t = x.min(y) / x.max(y);
    let share = t * polynomial(&ARC_TANGENT, t * t);
    if y > x { 1.0 - share } else { share }
}

/// 2/pi atan(t)/t as a polynomial in t^2 on `[0, 1]`, highest power first: the best of degree 8, by
/// Remez' exchange.
const ARC_TANGENT: [f32; 9] = [
    1.848_461_1e-3,
    -1.036_609_3e-2,
    2.739_972_6e-2,
    -4.796_088e-2,
    6.782_979e-2,
    -9.044_542e-2,
    1.272_797_3e-1,
    -2.122_050_7e-1,
    6.366_197_5e-1,
];

/// Giles's coefficients for w < 5, highest power first.
const CENTRAL: [f32; 9] = [
    2.810_226_4e-8,
    3.432_739_4e-7,
    -3.523_387_7e-6,
    -4.391_506_5e-6,
    2.185_808_7e-4,
    -1.253_725_e-3,
    -4.177_681_6e-3,
    2.466_407_3e-1,
    1.501_409_4,
];

/// Giles's coefficients for w >= 5, highest power first.
const TAIL: [f32; 9] = [
    -2.002_142_6e-4,
    1.009_505_6e-4,
    1.349_343_2e-3,
    -3.673_428_4e-3,
    5.739_507_7e-3,
    -7.622_461_3e-3,
    9.438_870_5e-3,
    1.001_674,
    2.832_976_8,
];

#[inline]
fn polynomial(coefficients: &[f32; 9], x: f32) -> f32 {
    coefficients.iter().fold(0.0, |sum, &c| sum * x + c)
}

/// From 0 at `low` to 1 at `high` along 3 t^2 - 2 t^3, and no farther; a step where both are equal.
#[inline]
pub fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    if low == high {
        return if x < low { 0.0 } else { 1.0 };
    }
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg_attr(miri, ignore = "hours in Miri")]
    fn quarter_turn_is_the_angle() {
        for i in 0..=100_000 {
            let (sin, cos) = (f64::from(i) * 1e-5 * std::f64::consts::FRAC_PI_2).sin_cos();
            let (x, y) = (cos.max(0.0) as f32, sin as f32);
            let expected = f64::from(y).atan2(f64::from(x)) * std::f64::consts::FRAC_2_PI;
            assert!(
                (f64::from(quarter_turn(x, y)) - expected).abs() < 2e-7,
                "{i}"
            );
        }
        assert_eq!(quarter_turn(0.0, 1e-30), 1.0);
        assert_eq!(quarter_turn(1e30, 0.0), 0.0);
    }

    #[test]
    fn arc_cosines_are_those_of_double_precision() {
        for i in -30_000..=30_000 {
            // A thousandth of what is asked for lies beyond [-1, 1].
            let x = i as f32 * (1.001 / 30_000.0);
            let expected = f64::from(x).clamp(-1.0, 1.0).acos();
            for angle in arc_cosines([x; 4]) {
                assert!((f64::from(angle) - expected).abs() < 3e-7, "{x}: {angle}");
            }
        }
        assert_eq!(arc_cosines([1.0, 0.0, -1.0, 2.0])[0], 0.0);
    }

    #[test]
    fn erf_matches_tabulated_values() {
        for (x, expected) in [
            (0.0, 0.0),
            (0.1, 0.112_462_92),
            (1.0, 0.842_700_8),
            (2.0, 0.995_322_3),
            (3.5, 0.999_999_3),
            (f32::INFINITY, 1.0),
        ] {
            assert!((erf(x) - expected).abs() < 4e-7, "{x}");
            assert!((erf(-x) + expected).abs() < 4e-7, "{x}");
        }
    }

    #[test]
    fn inverse_undoes_erf() {
        for i in -999..1000 {
            let y = i as f32 / 1000.0;
            assert!((erf(erf_inv(y)) - y).abs() < 1e-6, "{y}");
        }
        assert!(erf_inv(1.0).is_finite() && erf_inv(-1.0).is_finite());
    }

    #[test]
    fn the_exponential_is_exact_to_a_few_roundings() {
        for i in 0..=8600 {
            let x = -f64::from(i) / 100.0;
            let exact = (f64::from(x as f32)).exp();
            let relative = (f64::from(exp_negative(x as f32)) / exact - 1.0).abs();
            assert!(relative < 4e-7, "{x}: {relative}");
        }
        assert_eq!(exp_negative(0.0), 1.0);
        assert_eq!(exp_negative(-1e30), 0.0);
        assert_eq!(exp_negative(f32::NEG_INFINITY), 0.0);
    }
}
