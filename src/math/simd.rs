//! Code for the widest vectors that a processor has.
//!
//! Programs are compiled for every processor of their architecture: on x86-64 with vectors of four
//! numbers. [`widest`] compiles a piece of code twice, and runs it with vectors of eight where the
//! processor has them (AVX2). The results are the same bits: every operation is that of IEEE 754 in
//! both, and Rust neither fuses nor reorders them.

/// Runs `f`. What is to have wide vectors in it must be inlined.
#[inline(always)]
pub fn widest<R>(f: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(f)
}
