//! Owen-scrambled Sobol points (Burley, "Practical Hash-based Owen Scrambling", JCGT 2020), four
//! dimensions at a time.
//!
//! The points are those of the crate `sobol_burley`, bit for bit, from its building blocks. What
//! differs is when things are computed: the index is shuffled once a path instead of once a block,
//! and generator matrices are multiplied by four bits at a time from tables instead of bit by bit
//! in a loop whose length is random. Numbers were 13 % of plain path tracing in veach-ajar.

use sobol_burley::parts::{Int4, hash, hash_int4, owen_scramble_int4_rev, owen_scramble_rev};
use std::sync::LazyLock;

/// Blocks of four dimensions.
pub const BLOCKS: u32 = sobol_burley::NUM_DIMENSION_SETS_4D;

/// Products of a block's generator matrices and four bits of an index, at each of four places:
/// `[place][bits]`. Bits of indices and points are in reverse order, the first being the highest.
type Products = [[[u32; 4]; 16]; 4];

static PRODUCTS: LazyLock<Box<[Products]>> = LazyLock::new(|| {
    let product = |block, place, bits| {
        let lanes = |d| sobol_burley::parts::sobol_rev(bits << (28 - 4 * place), 4 * block + d);
        std::array::from_fn(|d| lanes(d as u32))
    };
    let block = |b| {
        std::array::from_fn(|place| {
            std::array::from_fn(|bits| product(b, place as u32, bits as u32))
        })
    };
    (0..BLOCKS).map(block).collect()
});

/// An index below 2^16, shuffled, its bits reversed: sequences of different seeds are independent.
#[inline]
pub fn shuffle(index: u32, seed: u32) -> u32 {
    owen_scramble_rev(index.reverse_bits(), hash(seed ^ 0x79c6_8e4a))
}

/// One block of a point, by the shuffled index: numbers in `[0, 1)`.
#[inline(always)]
pub fn block(shuffled: u32, block: u32, seed: u32) -> [f32; 4] {
    let products = &PRODUCTS[block as usize];
    let bits = |place: u32| {
        Int4::from(products[place as usize][(shuffled >> (28 - 4 * place) & 15) as usize])
    };
    let mut point = bits(0);
    for place in 1..4 {
        point ^= bits(place);
    }
    let lanes: Int4 = [0x912f_69ba, 0x174f_18ab, 0x691e_72ca, 0xb40c_c1b8].into();
    let seed: Int4 = [seed.wrapping_mul(0x9c8f_2d3b) ^ block; 4].into();
    owen_scramble_int4_rev(point, hash_int4(seed ^ lanes))
        .reverse_bits()
        .to_f32_norm()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_those_of_the_crate() {
        for seed in [0, 1, 0x1234_5678, u32::MAX] {
            for index in (0..1 << 16).step_by(13) {
                let shuffled = shuffle(index, seed);
                for b in [0, 1, 7, BLOCKS - 1] {
                    let expected = sobol_burley::sample_4d(index, b, seed);
                    assert_eq!(block(shuffled, b, seed), expected, "{seed} {index} {b}");
                }
            }
        }
    }
}
