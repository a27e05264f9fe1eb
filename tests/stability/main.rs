//! The stability suite: the renderer where numbers end.
//!
//! Every test takes something to an extreme (size, distance, brightness, depth, degeneracy) and
//! holds what comes out to a figure. The figures are printed as a table; [the readme](README.md)
//! has the one of the last release, and says where a limit is not what one would wish for.
//!
//! ```text
//! cargo test --release --test stability -- --nocapture --include-ignored --test-threads 1
//! ```
//!
//! | id | what is held | file |
//! |---|---|---|
//! | S1, S2, S8, S26 | size, distance and brightness of a scene do not matter | `invariance.rs` |
//! | S3, S4, S5 | rays leave surfaces, and never a closed mesh | `geometry.rs` |
//! | S6, S7, S21, S23 | energy: furnaces, closed forms, endless paths, denormals | `energy.rs` |
//! | S9, S10, S11 | broken meshes, no light, wild normals | `input.rs` |
//! | S12, S13, S15 | weights, sums, directions | `numbers.rs` |
//! | S19, S20 | random numbers and angles at the ends of their ranges | `ends.rs` |
//! | S14, S16, S17, S18 | the field: depth, partition, density, hostile contents | `field.rs` |
//! | S24, S25 | seeds, sample numbers beyond 2^32 | `streams.rs` |
//!
//! S22 (renders that are killed, go on, or are divided between machines have the same bits) is held
//! by `tests/cli/checkpoints.rs` and `tests/cli/shards.rs`, and by `poison.rs` for threads that
//! die.

#[path = "../support/mod.rs"]
mod support;

mod ends;
mod energy;
mod field;
mod geometry;
mod input;
mod invariance;
mod numbers;
mod poison;
mod scenes;
mod streams;
mod table;
