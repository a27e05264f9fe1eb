//! The spatial binary tree.

use super::Settings;
use crate::guide::sides::normal_octant;
use crate::math::{DVec3, Vec3};

/// In [`Node::link`], a leaf; the rest is its number.
const LEAF: u32 = 1 << 31;
/// Halvings of an axis at most.
const MOST_HALVINGS: f64 = 20.0;

#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// The first of two children, or the marked number of a leaf.
    link: u32,
    depth: u32,
}

/// Boxes of a cube around the scene, each half of its parent's along the axes in turn; one tree, or
/// one for each octant of normals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Space {
    min: DVec3,
    inverse: f64,
    roots: u32,
    max_depth: u32,
    /// The roots first.
    nodes: Vec<Node>,
}

/// A leaf, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub leaf: u32,
    /// Sides of its box, in units of the cube.
    pub sides: Vec3,
}

/// Sides of a box of this depth: axis a was halved at the depths a, a + 3, ...
fn sides(depth: u32) -> Vec3 {
    let side = |axis: u32| 0.5f32.powi(((depth + 2 - axis) / 3) as i32);
    Vec3::new(side(0), side(1), side(2))
}

/// Enters the child of a node of this depth that holds a point of its box, as a cube.
#[inline]
fn enter(p: &mut Vec3, depth: u32) -> u32 {
    let at = &mut p[(depth % 3) as usize];
    *at *= 2.0;
    let upper = *at >= 1.0;
    *at -= f32::from(u8::from(upper));
    u32::from(upper)
}

impl Space {
    /// One leaf, or one for each octant.
    pub fn new(settings: &Settings) -> Self {
        let (min, max) = (settings.min.as_dvec3(), settings.max.as_dvec3());
        let extent = (max - min).max_element().max(1e-30) * (1.0 + 1e-6);
        // No box below 64 ulp, where positions differ by rounding only.
        let largest = min.abs().max(max.abs()).max_element();
        let least = (64.0 * largest * f64::from(f32::EPSILON)).max(1e-300);
        let halvings = (extent / least).log2().floor().clamp(0.0, MOST_HALVINGS);
        let roots = if settings.normals { 8 } else { 1 };
        let leaf = |number| Node {
            link: LEAF | number,
            depth: 0,
        };
        Self {
            min,
            inverse: 1.0 / extent,
            roots,
            max_depth: 3 * halvings as u32,
            nodes: (0..roots).map(leaf).collect(),
        }
    }

    /// Leaves of a new space.
    pub fn roots(&self) -> u32 {
        self.roots
    }

    /// The tree for a normal.
    #[inline]
    pub fn root(&self, normal: Vec3) -> u32 {
        match self.roots {
            1 => 0,
            _ => normal_octant(normal) as u32,
        }
    }

    /// A position in the unit cube; what lies outside, or nowhere, is moved to its faces.
    #[inline]
    pub fn place(&self, position: Vec3) -> Vec3 {
        let p = ((position.as_dvec3() - self.min) * self.inverse).as_vec3();
        // NaN becomes 0.
        Self::inside(p.max(Vec3::ZERO))
    }

    /// The nearest point of the half-open unit cube.
    #[inline]
    pub fn inside(p: Vec3) -> Vec3 {
        p.clamp(Vec3::ZERO, Vec3::splat(crate::math::rng::BELOW_ONE))
    }

    /// The leaf of a tree that holds a point of the unit cube.
    #[inline]
    pub fn find(&self, root: u32, mut p: Vec3) -> Found {
        let mut node = self.nodes[root as usize];
        while node.link & LEAF == 0 {
            let child = node.link + enter(&mut p, node.depth);
            node = self.nodes[child as usize];
        }
        Found {
            leaf: node.link & !LEAF,
            sides: sides(node.depth),
        }
    }

    /// Halves leaves until `divides` says of none that it is to be divided; it is told the leaf's
    /// number and that of its new other half, which is the next one.
    pub fn divide(&mut self, mut leaves: u32, mut divides: impl FnMut(u32, u32) -> bool) {
        let mut i = 0;
        while i < self.nodes.len() {
            let Node { link, depth } = self.nodes[i];
            let leaf = link & !LEAF;
            if link & LEAF != 0 && depth < self.max_depth && divides(leaf, leaves) {
                self.nodes[i].link = self.nodes.len() as u32;
                let halves = [leaf, leaves].map(|number| Node {
                    link: LEAF | number,
                    depth: depth + 1,
                });
                self.nodes.extend(halves);
                leaves += 1;
            }
            i += 1;
        }
    }

    /// For each leaf its tree and the centre of its box.
    pub fn centres(&self) -> Vec<(u32, Vec3)> {
        let leaves = self.nodes.iter().filter(|n| n.link & LEAF != 0).count();
        let mut centres = vec![(0, Vec3::ZERO); leaves];
        let mut stack: Vec<_> = (0..self.roots).map(|r| (r, r, Vec3::ZERO)).collect();
        while let Some((root, node, low)) = stack.pop() {
            let Node { link, depth } = self.nodes[node as usize];
            if link & LEAF != 0 {
                centres[(link & !LEAF) as usize] = (root, low + 0.5 * sides(depth));
                continue;
            }
            let mut high = low;
            high[(depth % 3) as usize] += 0.5 * sides(depth)[(depth % 3) as usize];
            stack.extend([(root, link, low), (root, link + 1, high)]);
        }
        centres
    }

    /// Nodes of all trees.
    pub fn node_count(&self) -> u64 {
        self.nodes.len() as u64
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.nodes[..]) as u64
    }
}
