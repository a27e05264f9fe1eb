//! Owen-scrambled Sobol points (Burley, "Practical Hash-based Owen Scrambling", JCGT 2020), four
//! dimensions at a time, for the pixels of an image.
//!
//! The points are made of the building blocks of the crate `sobol_burley`, by dimensions in an order
//! of our own. The index is shuffled once a path instead of once a block, and generator matrices are
//! multiplied by four bits at a time from tables instead of bit by bit in a loop whose length is
//! random: numbers were 13 % of plain path tracing in veach-ajar.
//!
//! The pixels of a tile share a scramble and differ by a digital shift. In every block of four
//! numbers the shifts of the [`CELLS`] pixels are themselves the first points of Sobol's sequence in
//! four dimensions, a net, so that the points of a tile avoid each other as those of a pixel do:
//! means over many pixels have less noise, and so has what pixels share. Which pixel has which shift
//! is drawn anew for every block. (Shifts that follow the places of the pixels, as in Ahmed and
//! Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical
//! Ordering of Pixels", 2020, link the blocks: what many vertices decide together had twice the
//! variance of independent pixels.) The first block, places on film and lens, is scrambled by
//! pixels: there neighbours have nothing to share out.

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev};
use std::sync::LazyLock;

/// Blocks of four dimensions.
pub const BLOCKS: u32 = DIMENSIONS.len() as u32;

/// The dimensions of Sobol's sequence that each block takes.
///
/// In their own order many pairs are poor: of eight to 64 points, those of the dimensions 20 and 22
/// have eight times the variance of independent points. Here they were chosen one after another so
/// that the numbers which act together at a vertex (block 2k - 1: a light and a place on it; block
/// 2k: a direction) and at the next ones have little: the weighted mean over pairs is 0.67 times
/// that of independent points instead of 1.14. Guarded by
/// `numbers_of_a_block_are_better_than_independent_ones`; `EXPERIMENTS.md` of the path tracer has
/// what images gain.
const DIMENSIONS: [[u32; 4]; 17] = [
    [0, 1, 2, 3],
    [175, 168, 102, 234],
    [247, 208, 185, 55],
    [253, 196, 11, 62],
    [207, 232, 242, 151],
    [123, 203, 252, 143],
    [32, 69, 33, 214],
    [169, 53, 213, 105],
    [248, 157, 56, 4],
    [198, 124, 147, 28],
    [22, 212, 116, 46],
    [25, 129, 91, 15],
    [194, 58, 243, 112],
    [60, 229, 155, 255],
    [146, 81, 30, 159],
    [166, 90, 78, 189],
    [96, 152, 41, 167],
];
/// Pixels of a tile, by their number in it.
pub const CELLS: u32 = 256;

/// Products of a block's generator matrices and four bits of an index, at each of four places:
/// `[place][bits]`. Bits of indices and points are in reverse order, the first being the highest.
type Products = [[[u32; 4]; 16]; 4];

static PRODUCTS: LazyLock<Box<[Products]>> = LazyLock::new(|| {
    let product = |block, place, bits| unscrambled(bits << (28 - 4 * place), block);
    let block = |b| {
        std::array::from_fn(|place| {
            std::array::from_fn(|bits| product(b, place as u32, bits as u32))
        })
    };
    (0..BLOCKS).map(block).collect()
});

/// The shifts of a tile's pixels.
static SHIFTS: LazyLock<Box<[[u32; 4]]>> = LazyLock::new(|| {
    (0..CELLS)
        .map(|i| unscrambled(i.reverse_bits(), 0))
        .collect()
});

/// One block of the point of an index whose bits are reversed, not scrambled.
fn unscrambled(index: u32, block: u32) -> [u32; 4] {
    DIMENSIONS[block as usize].map(|d| sobol_burley::parts::sobol_rev(index, d))
}

/// A block's generator matrices times an index of 16 bits.
#[inline(always)]
fn product(index: u32, block: u32) -> Int4 {
    let products = &PRODUCTS[block as usize];
    let bits = |place: u32| {
        Int4::from(products[place as usize][(index >> (28 - 4 * place) & 15) as usize])
    };
    let mut point = bits(0);
    for place in 1..4 {
        point ^= bits(place);
    }
    point
}

/// Scrambles a block of a point as the crate does.
#[inline(always)]
fn scrambled(point: Int4, block: u32, seed: u32) -> [f32; 4] {
    let lanes: Int4 = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].into();
    let seed: Int4 = [seed.wrapping_mul(0x9c8f_2d3b) ^ block; 4].into();
    owen_scramble_int4_rev(point, hash_int4(seed ^ lanes))
        .reverse_bits()
        .to_f32_norm()
}

/// A point of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The index, shuffled, its bits reversed.
    index: u32,
    /// Of the tile.
    seed: u32,
    /// Of the pixel.
    cell: u32,
}

impl Point {
    /// Point number `index`, below 2^16, of pixel `cell`, below [`CELLS`], of a tile. Tiles of
    /// other seeds know nothing of each other.
    #[inline]
    pub fn new(index: u32, cell: u32, seed: u32) -> Self {
        Self {
            index: owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a)),
            seed,
            cell,
        }
    }

    /// One block of it: numbers in `[0, 1)`.
    #[inline(always)]
    pub fn block(&self, block: u32) -> [f32; 4] {
        let mut point = product(self.index, block);
        if block == 0 {
            return scrambled(point, block, hash(self.seed ^ self.cell));
        }
        point ^= Int4::from(SHIFTS[self.shift(block) as usize]);
        scrambled(point, block, self.seed)
    }

    /// Which shift the pixel has in a block, below [`CELLS`]: pixels of a tile with consecutive
    /// numbers have points that avoid each other best.
    #[inline]
    pub fn shift(&self, block: u32) -> u32 {
        permuted(self.cell, hash(self.seed ^ block.wrapping_mul(0x9e37_79b9)))
    }
}

/// The place of a number below [`CELLS`] in one of many orders of them, by 32 random bits.
#[inline]
fn permuted(number: u32, order: u32) -> u32 {
    const MASK: u32 = CELLS - 1;
    let mut x = number.wrapping_add(order);
    // Odd factors and shifts to the right can be undone modulo a power of two.
    for odd in [order >> 8, order >> 11, order >> 17] {
        x = x.wrapping_mul(odd | 1) & MASK;
        x ^= x >> 4;
    }
    x.wrapping_add(order >> 24) & MASK
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_crate() {
        for seed in [0, 1, 0x1234_5678, u32::MAX] {
            for index in (0..1 << 16).step_by(13) {
                let point = Point::new(index, 0, seed);
                let found = scrambled(product(point.index, 0), 0, seed);
                let expected = sobol_burley::sample_4d(index, 0, seed);
                assert_eq!(found, expected, "{seed} {index}");
                for b in [1, 7, BLOCKS - 1] {
                    let found = scrambled(product(point.index, b), b, seed);
                    let expected = scrambled(unscrambled(point.index, b).into(), b, seed);
                    assert_eq!(found, expected, "{seed} {index} {b}");
                }
            }
        }
    }

    /// The variance of the mean of a product of two or three steps, over that of independent points,
    /// for 8 to 64 points; the standard error is 3 %.
    fn gain(block: u32, dimensions: &[usize]) -> f64 {
        let (mut squares, mut rng) = (0.0, crate::math::Pcg32::new(1, 2));
        const SEEDS: u32 = 1000;
        for seed in 0..SEEDS {
            let heights: [f32; 4] = std::array::from_fn(|_| 0.15 + 0.7 * rng.next_f32());
            let mut sum = 0.0;
            for index in 0..64u32 {
                let point = Point::new(index, 0, hash(seed)).block(block);
                let step = |&d: &usize| {
                    let h = f64::from(heights[d]);
                    (f64::from(u8::from(point[d] < heights[d])) - h) / (h * (1.0 - h)).sqrt()
                };
                sum += dimensions.iter().map(step).product::<f64>();
                if index + 1 >= 8 && (index + 1).is_power_of_two() {
                    squares += sum * sum / f64::from(index + 1);
                }
            }
        }
        squares / f64::from(4 * SEEDS)
    }

    #[test]
    fn numbers_of_a_block_are_better_than_independent_ones() {
        for block in 0..BLOCKS {
            for together in [&[0, 1][..], &[1, 2], &[0, 1, 2]] {
                let gain = gain(block, together);
                assert!(gain < 1.2, "{block} {together:?}: {gain}");
            }
            assert!(gain(block, &[0, 2]) < 1.7, "{block}");
        }
    }

    #[test]
    fn every_pixel_of_a_tile_has_a_shift_of_its_own() {
        for seed in 0..1000 {
            let mut taken = [false; CELLS as usize];
            for cell in 0..CELLS {
                taken[Point::new(0, cell, seed).shift(seed % 9) as usize] = true;
            }
            assert!(taken.iter().all(|&t| t), "{seed}");
        }
    }
}
