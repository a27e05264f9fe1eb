//! A tree over the lights of the scene: how one of millions is chosen in proportion to what it may
//! send to a point, in time that grows with the tree's depth.
//!
//! A node has up to eight children, and their importance (see [`Cluster::importance`]) is computed
//! for all of them at once: the same operations on eight numbers, which the compiler turns into
//! vector instructions. The probability of a light is the product along its path, which
//! [`LightTree::probability`] walks from the leaf up.

use super::cluster::{Cluster, Lanes, WIDTH};
use super::selection::LightSelection;
use crate::math::Vec3;

/// Marks a child that is a leaf.
const LEAF: u32 = 1 << 31;
/// The root has no parent.
const NONE: u32 = u32::MAX;

/// Up to eight children.
#[derive(Clone, Copy, Debug)]
pub(super) struct LightNode {
    lanes: Lanes,
    /// Child nodes, or leaves with the mark.
    children: [u32; WIDTH],
}

/// Where a node or a leaf hangs: the node above times eight plus the place in it.
type Link = u32;

/// The tree. One light is a tree of no nodes.
#[derive(Debug)]
pub(super) struct LightTree {
    nodes: Vec<LightNode>,
    above_node: Vec<Link>,
    above_leaf: Vec<Link>,
    root: Cluster,
}

/// A child to be put into a node.
#[derive(Clone, Copy, Debug)]
pub(super) enum Child {
    /// The node that will be pushed with this index.
    Node(u32),
    /// A leaf.
    Leaf(u32),
}

impl LightTree {
    /// A tree without nodes, for `leaves` leaves in `root`.
    pub fn new(root: Cluster, leaves: usize) -> Self {
        Self {
            nodes: Vec::new(),
            above_node: vec![NONE],
            above_leaf: vec![NONE; leaves],
            root,
        }
    }

    /// Appends a node; its children's indices must be the ones they have or will have. At most
    /// eight.
    pub fn push(&mut self, children: &[(Cluster, Child)]) {
        let mut node = LightNode {
            lanes: Lanes::EMPTY,
            children: [0; WIDTH],
        };
        let link = (self.nodes.len() * WIDTH) as Link;
        for (place, (cluster, child)) in children.iter().take(WIDTH).enumerate() {
            node.lanes.set(place, cluster);
            let (above, index, marked) = match *child {
                Child::Node(i) => (&mut self.above_node, i as usize, i),
                Child::Leaf(i) => (&mut self.above_leaf, i as usize, i | LEAF),
            };
            if above.len() <= index {
                above.resize(index + 1, NONE);
            }
            above[index] = link + place as Link;
            node.children[place] = marked;
        }
        self.nodes.push(node);
    }

    /// An estimate of the irradiance of all lights together, 0 only if none can arrive.
    #[inline]
    pub fn importance(&self, p: Vec3, n: Vec3) -> f32 {
        self.root.importance(p, n)
    }

    /// Chooses a leaf by `u` in `[0, 1)`. Returns it with its probability; `None` if no light can
    /// arrive from the branch that was taken.
    #[inline]
    pub fn sample(
        &self,
        p: Vec3,
        n: Vec3,
        selection: &mut impl LightSelection,
        u: f64,
    ) -> Option<(usize, f32)> {
        if self.nodes.is_empty() {
            return Some((0, 1.0));
        }
        let (mut at, mut u, mut probability) = (0usize, u, 1.0f32);
        let mut number = Some(0);
        loop {
            let node = &self.nodes[at];
            let prior = node.lanes.importance(p, n);
            let importance = number.map_or(prior, |node| selection.weighed(node, prior));
            let sum = total(&importance);
            if sum <= 0.0 {
                return None;
            }
            let mut rest = u * f64::from(sum);
            let mut place = WIDTH;
            for (i, &w) in importance.iter().enumerate() {
                if w > 0.0 {
                    place = i;
                    if rest < f64::from(w) {
                        break;
                    }
                    rest -= f64::from(w);
                }
            }
            let weight = importance[place];
            u = (rest / f64::from(weight)).min(1.0 - f64::EPSILON);
            probability *= weight / sum;
            if let Some(node) = number {
                let ratio = || (weight / sum) / (prior[place] / total(&prior));
                selection.chosen(node, place, ratio);
                number = (node == 0).then_some(1 + place);
            }
            let next = node.children[place];
            if next & LEAF != 0 {
                return Some(((next & !LEAF) as usize, probability));
            }
            at = next as usize;
        }
    }

    /// Probability with which [`LightTree::sample`] chooses `leaf`.
    #[inline]
    pub fn probability(
        &self,
        p: Vec3,
        n: Vec3,
        selection: &impl LightSelection,
        leaf: usize,
    ) -> f32 {
        let (mut link, mut probability) = (self.above_leaf[leaf], 1.0f32);
        while link != NONE {
            let (at, place) = (link as usize / WIDTH, link as usize % WIDTH);
            let prior = self.nodes[at].lanes.importance(p, n);
            let above = self.above_node[at];
            let number = match above {
                NONE => Some(0),
                _ if (above as usize) < WIDTH => Some(1 + above as usize),
                _ => None,
            };
            let importance = number.map_or(prior, |node| selection.weighed(node, prior));
            if importance[place] <= 0.0 {
                return 0.0;
            }
            probability *= importance[place] / total(&importance);
            link = above;
        }
        probability
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.nodes.len() * (size_of::<LightNode>() + 4) + self.above_leaf.len() * 4
    }
}

/// The sum, in an order that the vector unit likes and that sampling and density share.
#[inline]
fn total(w: &[f32; WIDTH]) -> f32 {
    ((w[0] + w[4]) + (w[1] + w[5])) + ((w[2] + w[6]) + (w[3] + w[7]))
}
