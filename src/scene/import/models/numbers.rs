//! Numbers between commas, as words of the command line hold them.

/// Finite numbers between commas.
pub(in crate::scene::import) fn numbers(value: &str) -> Option<Vec<f64>> {
    let parse = |t: &str| t.trim().parse().ok().filter(|x: &f64| x.is_finite());
    value.split(',').map(parse).collect()
}
