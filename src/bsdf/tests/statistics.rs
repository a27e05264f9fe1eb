//! Pearson's chi-square test: observed counts against expected ones.

/// Cells that expect fewer than this are pooled: below it the statistic is not chi-square
/// distributed.
const MIN_EXPECTED: f64 = 5.0;

/// p-value of observing `observed` where `expected` counts were due: the chance of a deviation at
/// least as large. `None` where nothing can be compared; what is left over after the last full pool
/// is left out.
pub(super) fn chi_square(observed: &[f64], expected: &[f64]) -> Option<f64> {
    let mut cells: Vec<(f64, f64)> = expected
        .iter()
        .copied()
        .zip(observed.iter().copied())
        .collect();
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut statistic, mut degrees) = (0.0, 0i32);
    let (mut pooled_expected, mut pooled_observed) = (0.0, 0.0);
    for (e, o) in cells {
        pooled_expected += e;
        pooled_observed += o;
        if pooled_expected >= MIN_EXPECTED {
            let d = pooled_observed - pooled_expected;
            statistic += d * d / pooled_expected;
            degrees += 1;
            (pooled_expected, pooled_observed) = (0.0, 0.0);
        }
    }
    (degrees > 1).then(|| upper_gamma(0.5 * f64::from(degrees - 1), 0.5 * statistic))
}

/// The significance for each of `tests` tests that keeps the chance of any false alarm at 1 %
/// (Sidak).
pub(super) fn significance(tests: usize) -> f64 {
    1.0 - 0.99f64.powf(1.0 / tests as f64)
}

/// Regularised upper incomplete gamma function Q(a, x): by the series below a + 1, else by Lentz's
/// continued fraction (Press et al., "Numerical Recipes", 6.2).
fn upper_gamma(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 1.0;
    }
    let scale = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut n) = (1.0 / a, 1.0 / a, a);
        while term > sum * 1e-15 {
            n += 1.0;
            term *= x / n;
            sum += term;
        }
        return 1.0 - sum * scale;
    }
    let mut b = x + 1.0 - a;
    let mut c = 1e300;
    let mut d = 1.0 / b;
    let mut h = d;
    for i in 1..10_000 {
        let i = f64::from(i);
        let an = i * (a - i);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        h *= c * d;
        if (c * d - 1.0).abs() < 1e-14 {
            break;
        }
    }
    h * scale
}

/// ln Gamma(x) by Stirling's series, moved up to where it is exact.
fn ln_gamma(x: f64) -> f64 {
    let (mut x, mut shift) = (x, 0.0);
    while x < 12.0 {
        shift += x.ln();
        x += 1.0;
    }
    let r = 1.0 / (x * x);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r / 1680.0))) / x;
    (x - 0.5) * x.ln() - x + 0.5 * (2.0 * std::f64::consts::PI).ln() + series - shift
}

#[test]
fn p_values_match_tables() {
    // Q for chi-square: 5 % points of 1, 10 and 1000 degrees of freedom.
    for (k, x) in [(1.0, 3.841_459), (10.0, 18.307_04), (1000.0, 1074.679)] {
        let q = upper_gamma(0.5 * k, 0.5 * x);
        assert!((q - 0.05).abs() < 1e-6, "{k}: {q}");
    }
    assert!(upper_gamma(5.0, 1e-3) > 0.999_999);
}

#[test]
fn a_one_percent_error_is_seen() {
    let expected = vec![1e5; 16];
    let mut observed = expected.clone();
    observed[3] *= 1.02;
    observed[5] *= 0.98;
    let p = chi_square(&observed, &expected).expect("cells");
    assert!(p < 1e-6, "{p}");
    assert!(chi_square(&expected, &expected).expect("cells") > 0.99);
}
