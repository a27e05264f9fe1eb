//! P: the tree over the product of positions and directions. Its leaves are the links that carry
//! models; descending it finds the one leaf that holds a position and a direction.

use super::space::{Grid, Space};
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};

/// What a node of P divides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(crate) enum Split {
    /// Nothing: it is a leaf link and `first` is its number.
    Leaf = 0,
    /// Space: eight children.
    Space = 1,
    /// Directions: four children.
    Direction = 2,
}

/// A node of P: 8 bytes. Which cells of R and Q it links follows from the descent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ProductNode {
    pub first: u32,
    pub split: Split,
}

/// The two ends of a leaf link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Link {
    pub node: u32,
    pub r: u32,
    pub q: DirectionCell,
}

/// Where a descent stands: a node of P and how deep it is in R and in Q.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ProductPosition {
    pub node: u32,
    pub space_level: u8,
    pub direction_level: u8,
}

impl ProductPosition {
    pub const ROOT: Self = Self {
        node: 0,
        space_level: 0,
        direction_level: 0,
    };
}

/// One step down, or `None` at a leaf.
#[inline]
pub(crate) fn step(
    nodes: &[ProductNode],
    grid: &Grid,
    key: u64,
    code: u32,
    at: ProductPosition,
) -> Option<ProductPosition> {
    let n = nodes[at.node as usize];
    match n.split {
        Split::Leaf => None,
        Split::Space => Some(ProductPosition {
            node: n.first + grid.octant(key, at.space_level),
            space_level: at.space_level + 1,
            ..at
        }),
        Split::Direction => Some(ProductPosition {
            node: n.first + quadrant(code, at.direction_level),
            direction_level: at.direction_level + 1,
            ..at
        }),
    }
}

/// Which quadrant of a direction cell of level `level` holds the code.
#[inline]
pub(crate) fn quadrant(code: u32, level: u8) -> u32 {
    (code >> (2 * u32::from(CODE_LEVELS - 1 - level))) & 3
}

/// The tree with its leaf links.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Product {
    pub nodes: Vec<ProductNode>,
    pub links: Vec<Link>,
}

impl Product {
    /// One link: everywhere, from everywhere.
    pub fn new() -> Self {
        Self {
            nodes: vec![ProductNode {
                first: 0,
                split: Split::Leaf,
            }],
            links: vec![Link {
                node: 0,
                r: 0,
                q: DirectionCell::SPHERE,
            }],
        }
    }

    /// The leaf link that holds a position and a direction.
    #[cfg(test)]
    pub fn find(&self, grid: &Grid, key: u64, code: u32) -> u32 {
        let mut at = ProductPosition::ROOT;
        while let Some(next) = step(&self.nodes, grid, key, code, at) {
            at = next;
        }
        self.nodes[at.node as usize].first
    }

    /// Divides a leaf link. Child 0 keeps its number, the others follow at the end of `links`; the
    /// numbers are returned by the second value's first element and count.
    pub fn split(&mut self, space: &mut Space, link: u32, how: Split) -> std::ops::Range<u32> {
        let parent = self.links[link as usize];
        let arity = match how {
            Split::Leaf => return 0..0,
            Split::Space => 8,
            Split::Direction => 4,
        };
        let first_node = self.nodes.len() as u32;
        let new = self.links.len() as u32;
        let first_r = match how {
            Split::Space => space.split(parent.r),
            _ => parent.r,
        };
        for i in 0..arity {
            let number = if i == 0 { link } else { new + i - 1 };
            self.nodes.push(ProductNode {
                first: number,
                split: Split::Leaf,
            });
            let child = Link {
                node: first_node + i,
                r: if how == Split::Space {
                    first_r + i
                } else {
                    parent.r
                },
                q: if how == Split::Direction {
                    parent.q.child(i)
                } else {
                    parent.q
                },
            };
            if i == 0 {
                self.links[link as usize] = child;
            } else {
                self.links.push(child);
            }
        }
        self.nodes[parent.node as usize] = ProductNode {
            first: first_node,
            split: how,
        };
        new..new + arity - 1
    }

    /// How each node divides, parents before children, children in order: the whole shape of P.
    pub fn preorder(&self) -> Vec<(u32, Split)> {
        let mut order = Vec::with_capacity(self.nodes.len());
        let mut stack = vec![0u32];
        while let Some(i) = stack.pop() {
            let n = self.nodes[i as usize];
            order.push((i, n.split));
            let arity = match n.split {
                Split::Leaf => 0,
                Split::Space => 8,
                Split::Direction => 4,
            };
            stack.extend((0..arity).rev().map(|c| n.first + c));
        }
        order
    }

    /// The leaf links' numbers in preorder.
    pub fn leaves(&self) -> Vec<u32> {
        self.preorder()
            .iter()
            .filter(|(_, s)| *s == Split::Leaf)
            .map(|(i, _)| self.nodes[*i as usize].first)
            .collect()
    }
}
