//! Multiple importance sampling weights that cannot overflow.

/// The power heuristic (Veach 1997, beta 2) of a strategy with density `a` against one with density
/// `b`.
///
/// Written with the ratio of the smaller to the larger, so that squares of densities beyond 1.8e19
/// do not overflow. Infinite `a` (a delta) gives 1; two zeros give 0.
#[inline]
pub fn power_heuristic(a: f32, b: f32) -> f32 {
    // Which is the larger is chance: a processor that guesses it wrong loses more time than all of
    // this takes.
    let larger = if a >= b { a } else { b };
    let smaller = if a >= b { b } else { a };
    if larger.is_infinite() {
        return match (a.is_infinite(), b.is_infinite()) {
            (true, true) => 0.5,
            (true, false) => 1.0,
            (false, _) => 0.0,
        };
    }
    if larger == 0.0 {
        return 0.0;
    }
    let r = smaller / larger;
    let r2 = r * r;
    let above = if a >= b { 1.0 } else { r2 };
    above / (1.0 + r2)
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
