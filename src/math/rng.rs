//! Random numbers: a small counter-free generator for paths, and hashes that turn identities
//! (seed, pixel, sample) into streams, so that no result depends on which thread drew a number.

/// PCG32 (O'Neill 2014): 64 bits of state, 32 bits a draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pcg32 {
    state: u64,
    increment: u64,
}

impl Pcg32 {
    /// A generator at the start of stream `stream` for the seed `seed`.
    #[inline]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut rng = Self {
            state: 0,
            increment: (stream << 1) | 1,
        };
        rng.next_u32();
        rng.state = rng.state.wrapping_add(seed);
        rng.next_u32();
        rng
    }

    /// The next 32 uniform bits.
    #[inline]
    pub fn next_u32(&mut self) -> u32 {
        let old = self.state;
        self.state = old
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(self.increment);
        let xorshifted = (((old >> 18) ^ old) >> 27) as u32;
        xorshifted.rotate_right((old >> 59) as u32)
    }

    /// Uniform in `[0, 1)`; the largest value is 1 - 2^-24.
    #[inline]
    pub fn next_f32(&mut self) -> f32 {
        unit_f32(self.next_u32())
    }
}

/// Maps 32 uniform bits to `[0, 1)` by their upper 24, so that 1 is never returned.
#[inline]
pub fn unit_f32(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// The largest f32 below 1, where a rescaled random number may round up to 1.
pub const BELOW_ONE: f32 = 1.0 - f32::EPSILON * 0.5;

/// Mixes 64 bits so that every input bit moves every output bit (the finaliser of MurmurHash3,
/// Stafford's variant 13).
#[inline]
pub fn hash64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A hash of a sequence of integers: an identity such as (seed, pixel, sample) to a stream.
#[inline]
pub fn hash_all<const N: usize>(parts: [u64; N]) -> u64 {
    parts.iter().fold(0x9e37_79b9_7f4a_7c15, |h, &p| {
        hash64(h ^ p.wrapping_mul(0x9e37_79b9_7f4a_7c15)).wrapping_add(p)
    })
}
