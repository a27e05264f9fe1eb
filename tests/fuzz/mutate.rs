//! Mutations, and what to do when one is found that a reader cannot take.

use std::path::Path;
use twintree::math::Pcg32;

/// Numbers that readers may take for counts, sizes and values.
const NUMBERS: [&str; 12] = [
    "nan",
    "inf",
    "-inf",
    "1e39",
    "-1",
    "0",
    "1e-46",
    "4294967295",
    "9223372036854775807",
    "18446744073709551616",
    "-2147483648",
    "0x10",
];

/// A copy of `seed` with one to four changes.
pub fn mutated(seed: &[u8], rng: &mut Pcg32) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..=rng.next_u32() % 4 {
        change(&mut bytes, rng);
    }
    bytes
}

fn change(bytes: &mut Vec<u8>, rng: &mut Pcg32) {
    let below = |rng: &mut Pcg32, n: usize| rng.next_u32() as usize % n.max(1);
    let i = below(rng, bytes.len());
    let end = (i + below(rng, 40)).min(bytes.len());
    match rng.next_u32() % 8 {
        0 => bytes.truncate(i),
        1 if i < bytes.len() => bytes[i] = rng.next_u32() as u8,
        2 if i < bytes.len() => bytes[i] ^= 1 << (rng.next_u32() % 8),
        3 => {
            bytes.drain(i..end);
        }
        4 => {
            let copy = bytes[i..end].repeat(1 + below(rng, 3));
            let to = below(rng, bytes.len());
            bytes.splice(to..to, copy);
        }
        5 => {
            let number = NUMBERS[below(rng, NUMBERS.len())];
            bytes.splice(i..end.min(i + 4), number.bytes());
        }
        6 => {
            let value = [0u64, u64::MAX, 1 << 31, 1 << 62, 0x7fc0_0000_7f80_0000][below(rng, 5)];
            let width = 1 << below(rng, 4);
            let end = (i + width).min(bytes.len());
            bytes[i.min(end)..end].copy_from_slice(&value.to_le_bytes()[..end - i.min(end)]);
        }
        _ => bytes[i.min(end)..end].fill(rng.next_u32() as u8),
    }
}

/// Writes down the input of a round that panicked.
pub struct Reproduce<'a> {
    target: &'a str,
    seed: &'a Path,
    round: u64,
    input: Option<Vec<u8>>,
}

impl<'a> Reproduce<'a> {
    pub fn new(target: &'a str, seed: &'a Path, round: u64, input: &[u8]) -> Self {
        Self {
            target,
            seed,
            round,
            input: Some(input.to_vec()),
        }
    }

    pub fn survived(mut self) {
        self.input = None;
    }
}

impl Drop for Reproduce<'_> {
    fn drop(&mut self) {
        let Some(input) = &self.input else { return };
        let path = std::env::temp_dir().join(format!("twintree-{}-{}", self.target, self.round));
        let written = std::fs::write(&path, input).is_ok();
        eprintln!(
            "target {}, seed {}, round {}: the input is{} at {}",
            self.target,
            self.seed.display(),
            self.round,
            if written { "" } else { " not" },
            path.display()
        );
    }
}
