//! Needles of light that neighbours know.
//!
//! The sun through a pane, in a mirror, inside a block of glass: from wherever it is seen, it is seen in the same
//! direction, and only some cells of a region have met it so far. A cell that has not draws it with the density
//! of the dim light around it, and the path that finds it then is a firefly. So every cell draws a small share
//! from the narrow lobes of all cells in the same larger cell of R.

use super::gauss::GaussStats;
use crate::guide::gaussian::{Domain, LOBES, Lobe, Mixture};
use crate::math::Vec2;

/// Share of the neighbours' needles, where there are any. (Relative variance of a sample, 64 samples, for 0, and
/// for 0.05 with lobes of up to 1.5 degrees: a torus in glass under a small sun 5.9, 4.1; veach-ajar 4.66, 4.64; a
/// Cornell box 0.319, 0.328. For 0.1 with lobes of up to 3 degrees the last two are 4.9 and 0.352.)
pub(super) const SHARE: f32 = 0.05;
/// Cells of R learn from all cells below the cell so many levels up. (A torus in glass for 2, 3, 4 and all levels,
/// from cells of the same depth alone: 6.6, 4.7, 5.1, 5.3 instead of 8.0 without needles; from cells of all depths
/// 3.5 instead of 4.1.)
pub(crate) const LEVELS_UP: u8 = 3;
/// A needle's variance is at most that of 1.5 degrees, in the unit square.
const NARROW: f32 = 4.3e-5;
/// Needles whose means are closer than one degree are one.
const NEAR: f32 = 4.4e-3;
/// A lobe of less weight may be chance.
const LEAST_WEIGHT: f32 = 0.01;
/// No more needles are told apart.
const MOST: usize = 64;
/// A cell that has met so many records is believed half as much as one that has met countless.
const DOUBT: f64 = 16.0;
/// Variance of a needle that is known from a lobe without any.
const LEAST_VARIANCE: f64 = 1.5e-6;
/// Keeps the mixture's density positive.
const UNIFORM: f32 = 1e-3;

/// Lobes that are one needle: where the heaviest points to, and the sums of weight, x, y, xx, xy, yy.
struct Needle {
    place: Vec2,
    sums: [f64; 6],
}

impl Needle {
    fn add(&mut self, lobe: &Lobe, weight: f64) {
        let (x, y) = (f64::from(lobe.mean.x), f64::from(lobe.mean.y));
        let [xx, xy, yy] = lobe.covariance.map(f64::from);
        let moments = [1.0, x, y, x * x + xx, x * y + xy, y * y + yy];
        for (sum, m) in self.sums.iter_mut().zip(moments) {
            *sum += weight * m;
        }
    }

    /// Drawn in proportion to the root of its weight: a needle that few cells have met is dim or new.
    fn lobe(&self) -> Lobe {
        let [w, x, y, xx, xy, yy] = self.sums;
        let (x, y) = (x / w, y / w);
        let xx = (xx / w - x * x).max(LEAST_VARIANCE);
        let yy = (yy / w - y * y).max(LEAST_VARIANCE);
        // Rounding must not carry the correlation beyond 1.
        let most = 0.999 * (xx * yy).sqrt();
        let xy = (xy / w - x * y).clamp(-most, most);
        Lobe {
            weight: w.sqrt() as f32,
            mean: Vec2::new(x as f32, y as f32),
            covariance: [xx, xy, yy].map(|v| v as f32),
        }
    }
}

/// The needles that these cells have met, the eight heaviest; `None` if there are none. All lobes are over the same
/// plane: the cells' normals point into the same octant.
pub(super) fn needles<'a>(cells: impl Iterator<Item = &'a GaussStats>) -> Option<Mixture> {
    let mut known: Vec<(f64, Lobe)> = Vec::new();
    for cell in cells {
        let count = cell.count();
        let trust = count / (count + DOUBT);
        let [xx, yy] = [0, 2];
        let narrow = |l: &Lobe| l.covariance[xx] < NARROW && l.covariance[yy] < NARROW;
        let usable = cell
            .lobes()
            .iter()
            .filter(|l| l.weight > LEAST_WEIGHT && narrow(l));
        known.extend(usable.map(|l| (f64::from(l.weight) * trust, *l)));
    }
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut needles: Vec<Needle> = Vec::new();
    for (weight, lobe) in known.iter().filter(|k| k.0 > 0.0) {
        let near = |n: &&mut Needle| n.place.distance_squared(lobe.mean) < NEAR * NEAR;
        if let Some(needle) = needles.iter_mut().find(near) {
            needle.add(lobe, *weight);
            continue;
        }
        if needles.len() == MOST {
            continue;
        }
        let mut needle = Needle {
            place: lobe.mean,
            sums: [0.0; 6],
        };
        needle.add(lobe, *weight);
        needles.push(needle);
    }
    if needles.is_empty() {
        return None;
    }
    needles.sort_by(|a, b| b.sums[0].total_cmp(&a.sums[0]));
    let mut lobes = [Lobe::default(); LOBES];
    for (lobe, needle) in lobes.iter_mut().zip(&needles) {
        *lobe = needle.lobe();
    }
    Some(Mixture::new(&lobes, UNIFORM, Domain::Disk))
}
