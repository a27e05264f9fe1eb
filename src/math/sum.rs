//! Sums that are exact and do not depend on order: non-negative values in 128-bit fixed point.
//!
//! A floating-point sum of 1e9 photons either stalls (in `f32`, at 2^24 equal terms) or depends on
//! the order of its terms, and with it on the number of threads. An integer sum does neither, and
//! two sums made on two machines add up to the same bits as one. Terms are stored in quanta of
//! 2^-60 of a *unit*, a power of two near the typical term. A `f32` from 2^-36 to 2^30 units is
//! exact; smaller ones round to the quantum, larger ones are clamped. 2^37 terms fit whatever they
//! are.

/// Bits below the unit.
const FRACTION_BITS: i32 = 60;
/// Terms are clamped to 2^CLAMP_BITS units.
const CLAMP_BITS: i32 = 30;

/// The unit of a family of sums.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumUnit {
    exponent: i32,
    scale: f64,
}

impl SumUnit {
    /// The unit 2^exponent, `exponent` clamped to the range of `f32`, -149 to 127.
    pub fn from_exponent(exponent: i32) -> Self {
        let exponent = exponent.clamp(-149, 127);
        Self {
            exponent,
            scale: 2f64.powi(FRACTION_BITS - exponent),
        }
    }

    /// The power of two at or below `typical`; 1 if that is not a positive finite number.
    pub fn near(typical: f32) -> Self {
        if !(typical > 0.0 && typical.is_finite()) {
            return Self::from_exponent(0);
        }
        Self::from_exponent(f64::from(typical).log2().floor() as i32)
    }

    /// The unit's binary exponent.
    pub fn exponent(self) -> i32 {
        self.exponent
    }

    /// The unit itself.
    pub fn value(self) -> f64 {
        2f64.powi(self.exponent)
    }

    /// A term in quanta; negative numbers and NaN count as 0.
    #[inline]
    pub fn quanta(self, x: f32) -> u128 {
        const LIMIT: f64 = (1u128 << (FRACTION_BITS + CLAMP_BITS)) as f64;
        // NaN passes through clamp and becomes 0 in the cast.
        (f64::from(x) * self.scale).clamp(0.0, LIMIT).round() as u128
    }

    /// A sum of quanta as a number.
    #[inline]
    pub fn to_f64(self, quanta: u128) -> f64 {
        quanta as f64 / self.scale
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    #[test]
    #[cfg_attr(miri, ignore = "hours in Miri")]
    fn a_billion_mixed_terms_are_exact() {
        // A block of 1000 terms of weights 1e-8 to 1e8, repeated a million times by multiplication,
        // against the exact rational sum of the f32 terms (all multiples of 2^-60).
        let unit = SumUnit::near(1.0);
        let mut rng = Pcg32::new(9, 9);
        let terms: Vec<f32> = (0..1000)
            .map(|_| 10f32.powf(rng.next_f32() * 16.0 - 8.0))
            .collect();
        let block: u128 = terms.iter().map(|&t| unit.quanta(t)).sum();
        let exact: f64 = terms.iter().map(|&t| f64::from(t)).sum::<f64>();
        let total = unit.to_f64(block * 1_000_000);
        assert!((total / (exact * 1e6) - 1.0).abs() <= 1e-12);
        // Order does not matter.
        let back: u128 = terms.iter().rev().map(|&t| unit.quanta(t)).sum();
        assert_eq!(block, back);
        // The largest terms leave room for 1e10 of them.
        assert!(unit.quanta(f32::MAX).checked_mul(10_000_000_000).is_some());
    }

    #[test]
    fn any_scale_has_a_unit() {
        for typical in [1e-45f32, 1e-30, 1.0, 3.0, 1e10, 1e30, f32::MAX] {
            let unit = SumUnit::near(typical);
            let back = unit.to_f64(unit.quanta(typical));
            assert!((back / f64::from(typical) - 1.0).abs() < 1e-12, "{typical}");
        }
        for odd in [f32::NAN, -1.0, f32::NEG_INFINITY] {
            assert_eq!(SumUnit::near(odd).quanta(odd), 0);
        }
    }
}
