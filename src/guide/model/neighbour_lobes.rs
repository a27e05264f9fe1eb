//! Narrow lobes of light that neighbours know.
//!
//! The sun through a pane, in a mirror, inside a block of glass: from wherever it is seen, it is
//! seen in the same direction, and only some cells of a region have met it so far. A cell that has
//! not draws it with the density of the dim light around it, and the path that finds it then is a
//! firefly. So every cell draws a small share from the narrow lobes of all cells in the same larger
//! cell of R.
//!
//! A tenth of the samples from what all mixtures of a larger cell find improbable instead (eight
//! records a cell, kept with a chance in proportion to weight over the root of the density, in a
//! table of cells 1.8 degrees wide) was tried beside that: 0.90 of the torus's relative variance,
//! but 1.12 of a kitchen's, in 1.05 times the time.

use super::prior::PRIOR;
use crate::guide::gaussian::{Domain, LOBES, Lobe, Mixture, positive};
use crate::math::Vec2;

/// Share of the neighbours' narrow lobes, where there are any. (Relative variance of a sample, 64
/// samples, for 0, and for 0.05 with lobes of up to 1.5 degrees: a torus in glass under a small sun
/// 5.9, 4.1; veach-ajar 4.66, 4.64; a Cornell box 0.319, 0.328. For 0.1 with lobes of up to 3
/// degrees the last two are 4.9 and 0.352.)
pub(super) const SHARE: f32 = 0.05;
/// Cells of R learn from all cells below the cell so many levels up. (A torus in glass for 2, 3, 4
/// and all levels, from cells of the same depth alone: 6.6, 4.7, 5.1, 5.3 instead of 8.0 without
/// narrow lobes; from cells of all depths 3.5 instead of 4.1.)
pub(crate) const LEVELS_UP: u8 = 3;
/// A needle's variance is at most that of 1.5 degrees, in the unit square.
const NARROW: f32 = 4.3e-5;
/// Narrow lobes whose means are closer than one degree are one.
const NEAR: f32 = 4.4e-3;
/// A lobe of less weight may be chance.
const LEAST_WEIGHT: f32 = 0.01;
/// No more narrow lobes are told apart.
const MAX_NARROW_LOBES: usize = 64;
/// A cell that has met so many records is believed half as much as one that has met countless.
const DOUBT: f64 = 16.0;
/// Keeps the mixture's density positive.
const UNIFORM: f32 = 1e-3;

/// Lobes that are one needle: where the heaviest points to, and the sums of weight, x, y, xx, xy,
/// yy.
struct NeighbourLobe {
    place: Vec2,
    sums: [f64; 6],
}

impl NeighbourLobe {
    fn add(&mut self, lobe: &Lobe, weight: f64) {
        let (x, y) = (f64::from(lobe.mean.x), f64::from(lobe.mean.y));
        let [xx, xy, yy] = lobe.covariance.map(f64::from);
        let moments = [1.0, x, y, x * x + xx, x * y + xy, y * y + yy];
        for (sum, m) in self.sums.iter_mut().zip(moments) {
            *sum += weight * m;
        }
    }

    /// Drawn in proportion to the root of its weight: a needle that few cells have met is dim or
    /// new.
    fn lobe(&self) -> Lobe {
        let [w, x, y, xx, xy, yy] = self.sums;
        let (x, y) = (x / w, y / w);
        let covariance = [xx / w - x * x, xy / w - x * y, yy / w - y * y];
        Lobe {
            weight: w.sqrt() as f32,
            mean: Vec2::new(x as f32, y as f32),
            covariance: positive(covariance, PRIOR.least_variance),
        }
    }
}

/// The narrow lobes that these cells have met, the eight heaviest; `None` if there are none. Of
/// each cell: how many records it has met, and its lobes; all over the same plane, the cells'
/// normals point into the same octant.
pub(super) fn neighbour_lobes<'a>(
    cells: impl Iterator<Item = (f64, &'a [Lobe; LOBES])>,
) -> Option<Mixture> {
    let mut known: Vec<(f64, &Lobe)> = Vec::new();
    for (count, lobes) in cells {
        let trust = count / (count + DOUBT);
        let narrow = |l: &&Lobe| l.covariance[0] < NARROW && l.covariance[2] < NARROW;
        let usable = lobes
            .iter()
            .filter(|l| l.weight > LEAST_WEIGHT)
            .filter(narrow);
        known.extend(usable.map(|l| (f64::from(l.weight) * trust, l)));
    }
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut neighbour_lobes: Vec<NeighbourLobe> = Vec::new();
    for (weight, lobe) in known.into_iter().filter(|k| k.0 > 0.0) {
        let near = |n: &NeighbourLobe| n.place.distance_squared(lobe.mean) < NEAR * NEAR;
        let place = match neighbour_lobes.iter().position(near) {
            Some(place) => place,
            None if neighbour_lobes.len() == MAX_NARROW_LOBES => continue,
            None => {
                neighbour_lobes.push(NeighbourLobe {
                    place: lobe.mean,
                    sums: [0.0; 6],
                });
                neighbour_lobes.len() - 1
            }
        };
        neighbour_lobes[place].add(lobe, weight);
    }
    if neighbour_lobes.is_empty() {
        return None;
    }
    neighbour_lobes.sort_by(|a, b| b.sums[0].total_cmp(&a.sums[0]));
    let mut lobes = [Lobe::default(); LOBES];
    for (lobe, needle) in lobes.iter_mut().zip(&neighbour_lobes) {
        *lobe = needle.lobe();
    }
    Some(Mixture::new(&lobes, UNIFORM, Domain::Disk))
}
