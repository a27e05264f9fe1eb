//! Walks along rays leave nothing out, and majorants are above what a ray meets.

use super::*;
use crate::medium::grids::majorant::Majorants;
use crate::medium::grids::walk::{Lattice, Span, Walk};

/// A span of the unit cube.
fn span(org: Vec3, dir: Vec3) -> Option<Span> {
    Span::new(&crate::math::DAffine3::IDENTITY, org, dir, f32::INFINITY)
}

/// Checks the walk along a span: without gaps, through cells that the ray is in, from end to end.
fn check_walk(span: &Span, cells: [u32; 3], offset: f64) {
    let scale = DVec3::from_array(cells.map(|n| f64::from(n) - 2.0 * offset));
    let lattice = Lattice {
        cells,
        scale,
        offset,
    };
    let (mut at, mut steps) = (0.0, 0);
    for step in Walk::new(span, &lattice, 0.0, span.length) {
        assert_eq!(step.from, at);
        assert!(step.to >= at);
        at = step.to;
        steps += 1;
        let middle = span.at(0.5 * (step.from + step.to)) * scale + offset;
        for axis in 0..3 {
            let (place, cell) = (middle[axis], step.cell[axis] as f64);
            assert!((0..i64::from(cells[axis])).contains(&step.cell[axis]));
            assert!(
                (cell - 1e-9..=cell + 1.0 + 1e-9).contains(&place),
                "{step:?}"
            );
        }
    }
    assert_eq!(at, span.length);
    assert!(steps <= cells.iter().sum::<u32>(), "{steps} for {cells:?}");
}

#[test]
fn walks_are_complete() {
    let mut rng = Pcg32::new(3, 0);
    for _ in 0..20_000 {
        let (org, dir) = ray(&Affine3A::IDENTITY, &mut rng);
        let cells = std::array::from_fn(|_| 1 + rng.next_u32() % 20);
        let span = span(org, dir).unwrap();
        check_walk(&span, cells, 0.0);
        check_walk(&span, cells.map(|n| n + 1), 0.5);
    }
}

#[test]
fn rays_along_faces_edges_and_corners_are_walked() {
    let places = [-1.0, -0.0, 0.0, 0.25, 0.5, 1.0 - f32::EPSILON, 1.0, 2.0];
    let parts = [-1.0, -1e-30, -0.0, 0.0, 1e-42, 0.5, 1.0];
    let mut rng = Pcg32::new(4, 0);
    let (mut hits, mut misses) = (0, 0);
    for _ in 0..200_000 {
        let mut pick = |list: &[f32]| list[rng.next_u32() as usize % list.len()];
        let org = Vec3::from_array(std::array::from_fn(|_| pick(&places)));
        let dir = Vec3::from_array(std::array::from_fn(|_| pick(&parts)));
        if dir.abs().max_element() < 0.5 {
            continue;
        }
        let Some(span) = span(org, dir.normalize()) else {
            misses += 1;
            continue;
        };
        hits += 1;
        check_walk(&span, [4, 8, 1], 0.0);
        check_walk(&span, [5, 9, 2], 0.5);
    }
    assert!(hits > 10_000 && misses > 10_000, "{hits} {misses}");
}

#[test]
fn what_is_no_ray_passes_no_medium() {
    let nan = Vec3::new(0.5, f32::NAN, 0.5);
    for (org, dir) in [
        (Vec3::splat(0.5), Vec3::ZERO),
        (nan, Vec3::X),
        (Vec3::splat(0.5), nan),
        (Vec3::splat(f32::INFINITY), Vec3::X),
        (Vec3::new(2.0, 0.5, 0.5), Vec3::X),
        (Vec3::new(0.5, 1.5, 0.5), Vec3::X),
    ] {
        assert!(span(org, dir).is_none(), "{org} {dir}");
    }
    let identity = crate::math::DAffine3::IDENTITY;
    for distance in [0.0, -1.0, f32::NAN] {
        assert!(Span::new(&identity, Vec3::splat(0.5), Vec3::X, distance).is_none());
    }
}

#[test]
fn majorants_are_above_all_values_of_their_stretch() {
    let mut rng = Pcg32::new(5, 0);
    for lookup in lookups().cycle().take(120) {
        let resolution = std::array::from_fn(|_| 1 + rng.next_u32() % 23);
        let channels = 1 + 2 * (rng.next_u32() % 2);
        let place = odd_place();
        let grid = grid(resolution, channels, place, lookup, || {
            rng.next_f32().powi(4)
        });
        let majorants = Majorants::new(&grid);
        for _ in 0..50 {
            let (org, dir) = ray(&place, &mut rng);
            let span = Span::new(grid.to_grid(), org, dir, f32::INFINITY).unwrap();
            for part in majorants.along(&span) {
                for i in 0..=8 {
                    let at = part.from + (part.to - part.from) * f64::from(i) / 8.0;
                    let value = grid.eval_local(span.at(at)).max_element();
                    // Convex combinations may round up.
                    assert!(value <= part.majorant * (1.0 + 1e-12), "{value} {part:?}");
                }
            }
        }
    }
}

#[test]
fn majorants_are_as_low_as_their_voxels_allow() {
    // One voxel of 40: with interpolation it reaches from the centre of its neighbour before to
    // that of the one behind, and so into one cell of four voxels, or two.
    for (peak, cells) in [(17usize, 1), (19, 2), (20, 2), (39, 1)] {
        let mut i = 0;
        let value = || {
            i += 1;
            if i == peak + 1 { 7.0 } else { 0.0 }
        };
        let grid = grid([40, 1, 1], 1, Affine3A::IDENTITY, Lookup::default(), value);
        let span = span(Vec3::new(-1.0, 0.5, 0.5), Vec3::X).unwrap();
        let majorants = Majorants::new(&grid);
        let parts: Vec<f64> = majorants.along(&span).map(|p| p.majorant).collect();
        assert_eq!(parts.len(), 10);
        assert_eq!(
            parts.iter().filter(|m| **m == 7.0).count(),
            cells,
            "{parts:?}"
        );
        assert_eq!(parts.iter().filter(|m| **m == 0.0).count(), 10 - cells);
    }
}
