//! A binary tree over the lights of the scene: how one of millions is chosen in proportion to what it
//! may send to a point, in time that grows with the tree's depth.
//!
//! At each node one of two children is taken by [`Cluster::importance`]. The probability of a light is
//! the product along its path, which [`LightTree::probability`] walks again: the path is kept as bits.

use super::cluster::Cluster;
use crate::math::Vec3;

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;

/// Two children side by side, so that choosing between them touches one place in memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub children: [Cluster; 2],
    pub index: [u32; 2],
}

/// The tree. One light is a tree of no nodes.
#[derive(Debug)]
pub(super) struct LightTree {
    pub nodes: Vec<Node>,
    /// For each leaf the turns to take from the root, the first in the lowest bit.
    pub trails: Vec<u64>,
    pub root: Cluster,
}

/// The index of a child that is a leaf.
pub(super) fn leaf_index(leaf: usize) -> u32 {
    leaf as u32 | LEAF
}

impl LightTree {
    /// An estimate of the irradiance of all lights together, 0 only if none can arrive.
    #[inline]
    pub fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        self.root.importance(p, n)
    }

    /// Chooses a leaf by `u` in `[0, 1)`. Returns it with its probability; `None` if no light can arrive
    /// from the branch that was taken.
    #[inline]
    pub fn sample(&self, p: Vec3, n: Vec3, u: f64) -> Option<(usize, f32)> {
        if self.nodes.is_empty() {
            return Some((0, 1.0));
        }
        let (mut at, mut u, mut probability) = (0usize, u, 1.0f32);
        loop {
            let node = &self.nodes[at];
            let left = probability_of_first(node, p, n)?;
            let split = f64::from(left);
            let side = usize::from(u >= split);
            if side == 0 {
                u /= split;
                probability *= left;
            } else {
                u = (u - split) / (1.0 - split);
                probability *= 1.0 - left;
            }
            let next = node.index[side];
            if next & LEAF != 0 {
                return Some(((next & !LEAF) as usize, probability));
            }
            at = next as usize;
        }
    }

    /// Probability with which [`LightTree::sample`] chooses `leaf`.
    #[inline]
    pub fn probability(&self, p: Vec3, n: Vec3, leaf: usize) -> f32 {
        if self.nodes.is_empty() {
            return 1.0;
        }
        let (mut at, mut trail, mut probability) = (0usize, self.trails[leaf], 1.0f32);
        loop {
            let node = &self.nodes[at];
            let Some(left) = probability_of_first(node, p, n) else {
                return 0.0;
            };
            let side = (trail & 1) as usize;
            probability *= if side == 0 { left } else { 1.0 - left };
            let next = node.index[side];
            if next & LEAF != 0 || probability == 0.0 {
                return probability;
            }
            trail >>= 1;
            at = next as usize;
        }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.nodes.len() * size_of::<Node>() + self.trails.len() * 8
    }
}

/// Probability of the first child; `None` if neither can send anything.
#[inline]
fn probability_of_first(node: &Node, p: Vec3, n: Vec3) -> Option<f32> {
    let [a, b] = &node.children;
    let (a, b) = (a.importance(p, n), b.importance(p, n));
    let sum = a + b;
    (sum > 0.0).then(|| a / sum)
}
