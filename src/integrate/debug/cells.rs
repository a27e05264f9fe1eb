//! The cells of R as the camera sees them.

use super::probe::{Place, sight};
use crate::guide::Field;
use crate::integrate::context::View;
use crate::integrate::training::importance::met_by;
use crate::math::rng::{hash64, unit_f32};
use crate::math::{Rgb, Vec2};
use crate::scene::interaction::Interaction;
use rayon::prelude::*;

/// A picture of the first surfaces, each cell of the field in a colour of its own, shaded by the
/// cosine; and how many cells are in it. Black where nothing is seen.
pub fn seen(view: &View, field: &Field) -> (Vec<Rgb>, usize) {
    let (width, height) = (view.film.width, view.film.height);
    let cells: Vec<Option<(u32, f32)>> = (0..width * height)
        .into_par_iter()
        .map(|i| {
            let at = Vec2::new((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let (Interaction { wo, .. }, place) = sight(view.scene, view.camera, at).surface?;
            let Place { point, side, .. } = place;
            Some((field.cell(point.p, side), side.dot(wo).abs()))
        })
        .collect();
    let mut names: Vec<u32> = cells.iter().flatten().map(|c| c.0).collect();
    names.sort_unstable();
    names.dedup();
    let pixels = cells.into_iter().map(|cell| match cell {
        Some((cell, cosine)) => colour(cell) * (0.25 + 0.75 * cosine),
        None => Rgb::ZERO,
    });
    (pixels.collect(), names.len())
}

/// Camera paths that tell which cells are met.
const PATHS: u64 = 1 << 16;

/// Cells that camera paths meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MetCells {
    /// All of them.
    pub all: usize,
    /// The fewest that hold nine tenths of the paths' vertices.
    pub most_vertices: usize,
}

/// Which cells unguided camera paths meet at rough surfaces: the others are of use to no image.
pub fn met(view: &View, field: &Field) -> MetCells {
    let points = met_by(view, PATHS);
    let mut vertices = vec![0u32; field.cell_count() as usize];
    for point in &points {
        vertices[field.cell(point.position, point.normal) as usize] += 1;
    }
    vertices.retain(|&count| count > 0);
    vertices.sort_unstable_by(|a, b| b.cmp(a));
    MetCells {
        all: vertices.len(),
        most_vertices: cells_of_most(&vertices, points.len()),
    }
}

/// How many of the counts, which fall, it takes for nine tenths of their total.
fn cells_of_most(falling: &[u32], total: usize) -> usize {
    let wanted = total as f64 * 0.9;
    let mut sum = 0.0;
    let reached = falling.iter().position(|&count| {
        sum += f64::from(count);
        sum >= wanted
    });
    reached.map_or(0, |last| last + 1)
}

/// A bright colour that depends on a number as if by chance.
fn colour(cell: u32) -> Rgb {
    let h = hash64(u64::from(cell).wrapping_add(0x9e37_79b9_7f4a_7c15));
    let hue = 6.0 * unit_f32((h >> 32) as u32);
    let pale = 0.1 + 0.4 * unit_f32(h as u32);
    let bump = |centre: f32| {
        let away = (hue - centre).rem_euclid(6.0);
        let away = away.min(6.0 - away);
        (2.0 - away).clamp(0.0, 1.0)
    };
    let pure = Rgb::new(bump(0.0), bump(2.0), bump(4.0));
    Rgb::splat(pale) + pure * (1.0 - pale)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_tenths_of_the_vertices_lie_in_the_first_cells() {
        assert_eq!(cells_of_most(&[], 0), 0);
        assert_eq!(cells_of_most(&[10], 10), 1);
        assert_eq!(cells_of_most(&[80, 10, 5, 5], 100), 2);
        assert_eq!(cells_of_most(&[1; 10], 10), 9);
    }

    #[test]
    fn colours_are_bright_and_differ() {
        for cell in 0..1000 {
            let c = colour(cell);
            assert!(c.max_element() > 0.99 && c.min_element() >= 0.1, "{c}");
            let near = (colour(cell + 1) - c).abs().max_element();
            assert!(near > 1e-4, "{cell}");
        }
    }
}
