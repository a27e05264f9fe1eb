//! Triangles that stand exactly where another one of the mesh does.
//!
//! A few in a mesh do no harm. Where a thousandth of it and more lies in one place, every ray that
//! comes there would meet them all, and light sampling would count each as a lamp of its own. Such
//! a mesh shows in a sample of its triangles; only then all of them are compared.

use super::Raw;
use crate::math::Vec3;
use crate::math::rng::hash_all;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

/// Triangles in the sample. Of k triangles in one place among n it holds two or more almost
/// certainly where k / n is a thousandth: about (4096 k / n)^2 / 2 = 8 pairs.
const SAMPLE: usize = 4096;
/// Smaller meshes are left as they are.
const FEWEST: usize = 1000;

/// The corners of a triangle as bits, the least first: equal for all that wind around the same way.
type Key = [[u32; 3]; 3];

fn key(positions: &[Vec3], triangle: &[u32; 3]) -> Key {
    // Adding zero makes one of the two zeros.
    let bits = |&i: &u32| {
        let p = positions[i as usize] + Vec3::ZERO;
        p.to_array().map(f32::to_bits)
    };
    let mut key: Key = [0, 1, 2].map(|c| bits(&triangle[c]));
    let least = (0..3).min_by_key(|&c| key[c]).unwrap_or(0);
    key.rotate_left(least);
    key
}

fn hash(key: &Key) -> u64 {
    let flat: &[u32] = key.as_flattened();
    hash_all(std::array::from_fn::<u64, 9, _>(|i| u64::from(flat[i])))
}

/// Which triangles repeat one before them; nothing where that is so for few.
pub(super) fn find(raw: &Raw) -> Option<Vec<bool>> {
    let (positions, triangles) = (&raw.positions, &raw.triangles);
    if triangles.len() < FEWEST || !sample_repeats(positions, triangles) {
        return None;
    }
    let hashes: Vec<u64> = triangles
        .par_iter()
        .map(|t| hash(&key(positions, t)))
        .collect();
    let mut first: FxHashMap<u64, usize> = FxHashMap::default();
    let repeats = |(i, hash): (usize, &u64)| {
        let before = *first.entry(*hash).or_insert(i);
        // Two places that share a hash by chance are told apart.
        before != i && key(positions, &triangles[before]) == key(positions, &triangles[i])
    };
    Some(hashes.iter().enumerate().map(repeats).collect())
}

fn sample_repeats(positions: &[Vec3], triangles: &[[u32; 3]]) -> bool {
    let count = triangles.len();
    let pick = |n: u64| (hash_all([n]) % count as u64) as usize;
    let mut chosen: Vec<usize> = (0..SAMPLE.min(count) as u64).map(pick).collect();
    chosen.sort_unstable();
    chosen.dedup();
    let mut keys: Vec<Key> = chosen
        .iter()
        .map(|&i| key(positions, &triangles[i]))
        .collect();
    keys.sort_unstable();
    keys.windows(2).any(|pair| pair[0] == pair[1])
}
