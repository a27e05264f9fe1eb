//! A distribution over the cells of a large map that mostly stays in the processor's cache.
//!
//! A table with an entry for each cell of a map of 2048 x 1024 texels has 8 MB, and every draw and
//! every density waits for several places of it. So cells are put together to square blocks, few
//! enough for a table that fits the second-level cache. Inside a block the density is linear in the
//! polar angle (it follows the solid angle) and takes no look at the texels. Blocks where that
//! would be noisy, where a sun or a window stands out, are *fine*: they are divided into their
//! cells. Coarse blocks and the cells of fine ones, row by row, are the *parts* that one search
//! chooses among.
//!
//! Which are fine: the estimator `radiance / pdf` of what the map sends has the relative variance
//! `sum_b P_b v_b` from inside its blocks, with `P_b` the probability of block b and `v_b` the
//! relative variance of its texels. Blocks become fine, the largest products first, until the sum
//! is below [`VARIANCE`]. In a small map each cell is a block, and all are fine.

use crate::math::Vec2;
use crate::math::distribution::{Discrete, sample_linear, widen};

/// Most blocks along either axis: 256 by 128 of them have 128 KB of cumulative weights, and as much
/// to tell which block a part belongs to and which parts a block has.
const BLOCKS: usize = 256;
/// Relative variance that the coarse blocks may add. Cosine, BSDF and visibility add about 1.
const VARIANCE: f64 = 0.1;
/// Cells of a map, in blocks.
#[derive(Debug)]
pub(super) struct Blocks {
    /// Cells along each axis.
    size: [usize; 2],
    /// Binary logarithm of the number of cells along the side of a block.
    log_side: u32,
    /// Blocks along a row.
    columns: usize,
    parts: Discrete,
    /// The block that each part is, or lies in.
    block: Vec<u32>,
    /// The first part of each block, and the end of the last.
    first: Vec<u32>,
    /// Sine of the polar angle of each row of texels.
    row_weight: Vec<f32>,
}

/// A place in a map: a cell, where in it, and the density over the map's unit square.
pub(super) struct Drawn {
    pub cell: [usize; 2],
    /// Where in the cell; if `fine`, two random numbers to choose it by.
    pub at: Vec2,
    /// Density; if `fine`, its mean over the cell, where it follows the texels.
    pub density: f32,
    pub fine: bool,
}

impl Blocks {
    /// For a map of `width` columns, the last beside the first, with the sine of the polar angle of
    /// each row; `value` tells how bright a texel is. `None` if all are black.
    pub fn new(
        width: usize,
        row_weight: Vec<f32>,
        value: impl Fn(usize, usize) -> f32,
    ) -> Option<Self> {
        let size = [width, row_weight.len() - 1];
        let side = size[0].max(size[1]).div_ceil(BLOCKS).next_power_of_two();
        let count = size.map(|cells| cells.div_ceil(side));
        let nodes = Nodes {
            width,
            row_weight: &row_weight,
            value,
        };
        let places: Vec<CellBlock> = (0..count[0] * count[1])
            .map(|block| CellBlock::new(size, side, [block % count[0], block / count[0]]))
            .collect();
        let weights: Vec<f64> = places
            .iter()
            .map(|place| place.cells().map(|cell| nodes.cell(cell)).sum())
            .collect();
        let variances = places.iter().zip(&weights);
        let variances: Vec<f64> = variances
            .map(|(place, weight)| weight * nodes.relative_variance(place))
            .collect();
        let mut fine = vec![false; places.len()];
        for block in largest(&variances, VARIANCE * weights.iter().sum::<f64>()) {
            fine[block] = true;
        }
        let (mut parts, mut block, mut first) = (Vec::new(), Vec::new(), vec![0]);
        for (i, place) in places.iter().enumerate() {
            if fine[i] {
                parts.extend(place.cells().map(|cell| nodes.cell(cell)));
            } else {
                parts.push(weights[i]);
            }
            block.resize(parts.len(), i as u32);
            first.push(parts.len() as u32);
        }
        Some(Self {
            size,
            log_side: side.trailing_zeros(),
            columns: count[0],
            parts: Discrete::new(&parts)?,
            block,
            first,
            row_weight,
        })
    }

    /// Draws a place with two uniform numbers.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Drawn {
        let salt = u64::from(u.x.to_bits()) << 32 | u64::from(u.y.to_bits());
        let part = self.parts.sample(widen(u.x, salt));
        let block = self.block[part.index] as usize;
        let place = self.place([block % self.columns, block / self.columns]);
        if let Some(first) = self.cells_of(block, &place) {
            return Drawn {
                cell: place.cell(part.index - first),
                at: Vec2::new(part.rest, u.y),
                density: part.probability * self.cells(),
                fine: true,
            };
        }
        let [upper, lower] = self.edges(&place);
        let t = sample_linear(upper, lower, u.y);
        let (x, s) = split(part.rest, place.size[0]);
        let (y, t) = split(t, place.size[1]);
        let (cell, at) = ([place.first[0] + x, place.first[1] + y], Vec2::new(s, t));
        Drawn {
            cell,
            at,
            density: self.coarse(&place, part.probability, y as f32 + t),
            fine: false,
        }
    }

    /// Density over the unit square at a place of a cell, and whether it is the mean over the cell.
    #[inline]
    pub fn density(&self, cell: [usize; 2], at: Vec2) -> (f32, bool) {
        let [x, y] = cell.map(|c| c >> self.log_side);
        let place = self.place([x, y]);
        let block = y * self.columns + x;
        if let Some(first) = self.cells_of(block, &place) {
            let probability = self.parts.probability(first + place.index(cell));
            return (probability * self.cells(), true);
        }
        let probability = self.parts.probability(self.first[block] as usize);
        let t = (cell[1] - place.first[1]) as f32 + at.y;
        (self.coarse(&place, probability, t), false)
    }

    #[inline]
    fn place(&self, block: [usize; 2]) -> CellBlock {
        CellBlock::new(self.size, 1 << self.log_side, block)
    }

    /// The first of a fine block's parts. (A block of one cell is fine.)
    #[inline]
    fn cells_of(&self, block: usize, place: &CellBlock) -> Option<usize> {
        let [first, end] = [self.first[block], self.first[block + 1]];
        ((end - first) as usize == place.size[0] * place.size[1]).then_some(first as usize)
    }

    /// Sine of the polar angle of a row of texels.
    #[inline]
    pub fn row_weight(&self, y: usize) -> f32 {
        self.row_weight[y]
    }

    fn cells(&self) -> f32 {
        (self.size[0] * self.size[1]) as f32
    }

    /// Sines at the upper and the lower edge of a block.
    #[inline]
    fn edges(&self, place: &CellBlock) -> [f32; 2] {
        let first = place.first[1];
        [first, first + place.size[1]].map(|y| self.row_weight[y])
    }

    /// Density in a coarse block, `rows` below its upper edge.
    #[inline]
    fn coarse(&self, place: &CellBlock, probability: f32, rows: f32) -> f32 {
        let [upper, lower] = self.edges(place);
        let here = upper + (lower - upper) * (rows / place.size[1] as f32);
        let share = (place.size[0] * place.size[1]) as f32;
        probability * (2.0 * here / (upper + lower)) * (self.cells() / share)
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        let numbers = self.block.len() + self.first.len() + self.row_weight.len();
        self.parts.memory_bytes() + 4 * numbers
    }
}

/// The cells of a block.
struct CellBlock {
    first: [usize; 2],
    size: [usize; 2],
}

impl CellBlock {
    #[inline]
    fn new(cells: [usize; 2], side: usize, block: [usize; 2]) -> Self {
        let first = block.map(|b| b * side);
        let size = [0, 1].map(|axis| side.min(cells[axis] - first[axis]));
        Self { first, size }
    }

    #[inline]
    fn cell(&self, index: usize) -> [usize; 2] {
        let (x, y) = (index % self.size[0], index / self.size[0]);
        [self.first[0] + x, self.first[1] + y]
    }

    #[inline]
    fn index(&self, cell: [usize; 2]) -> usize {
        (cell[1] - self.first[1]) * self.size[0] + cell[0] - self.first[0]
    }

    fn cells(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        (0..self.size[0] * self.size[1]).map(|i| self.cell(i))
    }
}

/// The texels, which are the corners of cells.
struct Nodes<'a, F> {
    width: usize,
    row_weight: &'a [f32],
    value: F,
}

impl<F: Fn(usize, usize) -> f32> Nodes<'_, F> {
    /// Weight of a cell: the sum over its corners of brightness times sine.
    fn cell(&self, [x, y]: [usize; 2]) -> f64 {
        let right = (x + 1) % self.width;
        let node = |x, y: usize| f64::from((self.value)(x, y) * self.row_weight[y]);
        node(x, y) + node(right, y) + node(x, y + 1) + node(right, y + 1)
    }

    /// Variance of the texels of a block over the square of their mean.
    fn relative_variance(&self, place: &CellBlock) -> f64 {
        let (mut sum, mut squares) = (0.0, 0.0);
        for y in place.first[1]..=place.first[1] + place.size[1] {
            for x in place.first[0]..=place.first[0] + place.size[0] {
                let value = f64::from((self.value)(x % self.width, y));
                sum += value;
                squares += value * value;
            }
        }
        let count = ((place.size[0] + 1) * (place.size[1] + 1)) as f64;
        (squares * count / (sum * sum).max(f64::MIN_POSITIVE) - 1.0).max(0.0)
    }
}

/// Which of the values, the largest first, must go for the others' sum to stay below `rest`.
fn largest(values: &[f64], rest: f64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[b].total_cmp(&values[a]).then(a.cmp(&b)));
    let mut sum: f64 = values.iter().sum();
    let mut taken = Vec::new();
    for i in order {
        if sum <= rest {
            break;
        }
        sum -= values[i];
        taken.push(i);
    }
    taken
}

/// Which of `n` equal parts of `[0, 1)` a number lies in, and where in it.
#[inline]
fn split(u: f32, n: usize) -> (usize, f32) {
    let place = u * n as f32;
    let part = (place as usize).min(n - 1);
    (part, (place - part as f32).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Pcg32;

    /// A sky with a sun of a few texels and a window.
    fn map(width: usize, height: usize) -> Blocks {
        let value = |x: usize, y: usize| {
            let sun = x.abs_diff(width / 3) < 2 && y.abs_diff(height / 4) < 2;
            let window = x > width / 2 && x < width * 2 / 3 && y > height / 2;
            let noise = (x * 7 + y * 13) % 5;
            if sun {
                1e4
            } else if window {
                3.0
            } else {
                0.1 + 0.01 * noise as f32
            }
        };
        let row_weight = (0..height)
            .map(|y| (std::f32::consts::PI * (y as f32).max(0.25) / height as f32).sin())
            .collect();
        Blocks::new(width, row_weight, value).unwrap()
    }

    #[test]
    fn draws_have_the_density_that_is_told() {
        let mut rng = Pcg32::new(4, 1);
        for (width, height) in [(1, 2), (100, 50), (700, 333), (2048, 1024)] {
            let blocks = map(width, height);
            for _ in 0..20_000 {
                let drawn = blocks.sample(Vec2::new(rng.next_f32(), rng.next_f32()));
                let (density, fine) = blocks.density(drawn.cell, drawn.at);
                assert_eq!(fine, drawn.fine);
                assert!((density - drawn.density).abs() <= 1e-4 * density, "{width}");
            }
        }
    }

    #[test]
    fn the_density_integrates_to_one() {
        for (width, height) in [(1, 2), (100, 50), (700, 333), (2048, 1024)] {
            let blocks = map(width, height);
            let mut sum = 0.0;
            for i in 0..width * (height - 1) {
                let (density, _) = blocks.density([i % width, i / width], Vec2::splat(0.5));
                sum += f64::from(density);
            }
            let mean = sum / (width * (height - 1)) as f64;
            assert!((mean - 1.0).abs() < 1e-4, "{width} x {height}: {mean}");
        }
    }

    #[test]
    fn few_blocks_are_fine_and_a_sun_is_among_them() {
        let blocks = map(2048, 1024);
        let sun = blocks.density([2048 / 3, 1024 / 4], Vec2::ZERO);
        let sky = blocks.density([0, 1024 / 4], Vec2::ZERO);
        assert!(sun.1 && !sky.1);
        let widths = blocks.first.windows(2).map(|ends| ends[1] - ends[0]);
        let fine = widths.filter(|&parts| parts > 1).count();
        assert!((1..=16).contains(&fine), "{fine}");
        assert!(blocks.memory_bytes() < 512 << 10);
    }

    #[test]
    fn the_largest_go_until_the_rest_is_small() {
        assert_eq!(largest(&[1.0, 5.0, 0.5, 3.0], 2.0), [1, 3]);
        assert!(largest(&[1.0, 1.0], 2.0).is_empty());
        assert_eq!(largest(&[0.0, 2.0], 0.0), [1]);
    }
}
