//! Exact integrals between voxels, against quadrature of looked-up values.

use super::*;
use crate::medium::grids::stretch::Stretch;
use crate::medium::grids::walk::Span;

#[test]
fn stretches_have_the_values_and_integrals_of_the_grid() {
    let mut rng = Pcg32::new(6, 0);
    for lookup in lookups() {
        let place = odd_place();
        let grid = grid([5, 4, 7], 3, place, lookup, || rng.next_f32());
        for _ in 0..40 {
            let (org, dir) = ray(&place, &mut rng);
            let span = Span::new(grid.to_grid(), org, dir, f32::INFINITY).unwrap();
            let (from, to) = (0.1 * span.length, 0.9 * span.length);
            let mut at = from;
            for part in Stretch::along(&grid, &span, from, to) {
                assert!((part.from - at).abs() < 1e-12 * to);
                at += part.length;
                let value = |share: f64| grid.eval_local(span.at(part.from + share * part.length));
                for share in [0.01, 0.3, 0.99] {
                    let off = (part.value(share) - value(share)).abs().max_element();
                    assert!(off < 1e-12, "{off}");
                }
                let sum = quadrature(1.0, 2000, value) * part.length;
                let off = (part.integral(1.0) - sum).abs().max_element();
                assert!(off <= 1e-6 * part.length, "{off}");
            }
            assert!((at - to).abs() < 1e-12 * to);
        }
    }
}

#[test]
fn the_place_of_an_integral_is_found() {
    let mut rng = Pcg32::new(7, 0);
    let lookup = Lookup::default();
    for scale in [1e-30f32, 1.0, 1e30] {
        // Many voxels are empty: integrals that begin or end flat.
        let value = || scale * (rng.next_f32() - 0.5).max(0.0).powi(3);
        let grid = grid([6; 3], 1, Affine3A::IDENTITY, lookup, value);
        for _ in 0..300 {
            let (org, dir) = ray(&Affine3A::IDENTITY, &mut rng);
            let span = Span::new(grid.to_grid(), org, dir, f32::INFINITY).unwrap();
            for part in Stretch::along(&grid, &span, 0.0, span.length) {
                let whole = part.integral(1.0).x;
                if whole <= f64::from(scale) * 1e-12 {
                    continue;
                }
                for share in [1e-9, 0.1, 0.5, 0.9999, 1.0] {
                    let found = part.share_at(0, share * whole);
                    assert!((0.0..=1.0).contains(&found), "{found}");
                    let off = (part.integral(found).x / whole - share).abs();
                    assert!(off < 1e-12, "{share} of {whole}: off by {off}");
                }
            }
        }
    }
}

#[test]
fn optical_depths_are_those_of_quadrature() {
    let mut rng = Pcg32::new(8, 0);
    for lookup in lookups() {
        let place = odd_place();
        let grid = grid([9, 6, 5], 3, place, lookup, || rng.next_f32());
        let medium = Heterogeneous::new(grid, 3.0, Albedo::Constant(Rgb::ONE)).unwrap();
        for _ in 0..10 {
            let (org, dir) = ray(&place, &mut rng);
            let distance = 10.0;
            let depth = -expected(&medium, org, dir, distance).0.map(f64::ln);
            let exact = medium.optical_depth(org, dir, distance).as_dvec3();
            // The midpoint rule errs at jumps by up to the width of a step for each.
            let off = (exact - depth).abs().max_element();
            assert!(off < 3e-3, "{lookup:?}: {exact} for {depth}");
        }
    }
}
