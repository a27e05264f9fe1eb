//! Multiple importance sampling weights that cannot overflow.

/// The power heuristic (Veach 1997, beta 2) of a strategy with density `a` against one with density `b`.
///
/// Written with the ratio of the smaller to the larger, so that squares of densities beyond 1.8e19
/// do not overflow. Infinite `a` (a delta) gives 1; two zeros give 0.
#[inline]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    if a >= b {
        if a == 0.0 {
            return 0.0;
        }
        if a.is_infinite() {
            return if b.is_infinite() { 0.5 } else { 1.0 };
        }
        let r = b / a;
        1.0 / (1.0 + r * r)
    } else {
        if b.is_infinite() {
            return 0.0;
        }
        let r = a / b;
        let r2 = r * r;
        r2 / (1.0 + r2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    #[test]
    fn weights_of_any_two_densities_sum_to_one() {
        let mut rng = Pcg32::new(1, 2);
        for _ in 0..1_000_000 {
            let a = 10f32.powf(rng.next_f32() * 78.0 - 40.0);
            let b = 10f32.powf(rng.next_f32() * 78.0 - 40.0);
            let (wa, wb) = (power_heuristic(a, b), power_heuristic(b, a));
            assert!((0.0..=1.0).contains(&wa), "{a} {b} {wa}");
            assert!((wa + wb - 1.0).abs() < 1e-6, "{a} {b} {wa} {wb}");
        }
        assert_eq!(power_heuristic(0.0, 0.0), 0.0);
        assert_eq!(power_heuristic(f32::INFINITY, 1.0), 1.0);
    }
}
