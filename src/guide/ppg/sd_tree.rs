//! The frozen tree: samples and their density.

use super::quadtree::{Quadtree, enter};
use super::settings::Target;
use super::space::Space;
use crate::guide::GuideSample;
use crate::guide::cells::Cells;
use crate::math::equal_area::{sphere_to_square, square_to_sphere};
use crate::math::rng::BELOW_ONE;
use crate::math::{Rgb, Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// Density of uniform directions.
const UNIFORM: f32 = 0.25 * FRAC_1_PI;
/// [`Leaf::root`] of a leaf that knows no light.
const DARK: u32 = u32::MAX;

/// An SD-tree, ready to be asked. Made by [`super::PpgTrainer::freeze`].
#[derive(Clone, Debug, PartialEq)]
pub struct SdTree {
    space: Space,
    leaves: Vec<Leaf>,
    /// The quadtrees of all leaves, one after the other.
    nodes: Vec<Node>,
    defensive: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Leaf {
    root: u32,
    irradiance: Rgb,
}

/// A node of a quadtree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Node {
    /// The quadrants' probabilities.
    chances: [f32; 4],
    /// The quadrants' nodes; 0 for those that are uniform.
    children: [u32; 4],
}

/// The tree's answer for one path vertex.
#[derive(Clone, Copy, Debug)]
pub struct LocalTree<'t> {
    tree: &'t SdTree,
    root: u32,
    cell: u32,
    horizon: Option<Vec3>,
}

/// The nodes of a quadtree as they are asked; none where there is no energy.
pub(super) fn frozen(tree: &Quadtree, target: Target) -> Vec<Node> {
    let (energies, all) = tree.energies(target);
    if !(all > 0.0 && all.is_finite()) {
        return Vec::new();
    }
    let nodes = tree.nodes().iter().zip(energies);
    let freeze = |(node, energies): (&super::quadtree::Node, [f32; 4])| {
        let sum: f32 = energies.iter().sum();
        Node {
            chances: match sum > 0.0 {
                true => energies.map(|e| e / sum),
                false => [0.25; 4],
            },
            children: node.children,
        }
    };
    nodes.map(freeze).collect()
}

impl SdTree {
    /// Puts together what the leaves know: each its irradiance and its nodes.
    pub(super) fn new(space: Space, known: Vec<(Rgb, Vec<Node>)>, defensive: f32) -> Self {
        let count = known.iter().map(|k| k.1.len()).sum();
        let (mut nodes, mut leaves) = (Vec::with_capacity(count), Vec::with_capacity(known.len()));
        for (irradiance, of_leaf) in known {
            let first = nodes.len() as u32;
            let root = if of_leaf.is_empty() { DARK } else { first };
            leaves.push(Leaf { root, irradiance });
            nodes.extend(of_leaf.into_iter().map(|node| Node {
                children: node.children.map(|c| if c == 0 { 0 } else { first + c }),
                ..node
            }));
        }
        Self {
            space,
            leaves,
            nodes,
            defensive,
        }
    }

    /// What is known at a point of a surface with this normal, or nothing where no light is.
    /// Directions below the horizon, if there is one, get no density.
    #[inline]
    pub fn at(&self, position: Vec3, normal: Vec3, horizon: Option<Vec3>) -> Option<LocalTree<'_>> {
        let cell = self.cell(position, normal);
        let root = self.leaves[cell as usize].root;
        (root != DARK).then_some(LocalTree {
            tree: self,
            root,
            cell,
            horizon,
        })
    }

    /// Density over the unit square.
    #[inline]
    fn density(&self, root: u32, mut p: Vec2) -> f32 {
        let mut density = 1.0;
        let mut node = root;
        loop {
            let Node { chances, children } = &self.nodes[node as usize];
            let (quadrant, inner) = enter(p);
            density *= 4.0 * chances[quadrant];
            match children[quadrant] {
                0 => return density,
                child => (node, p) = (child, inner),
            }
        }
    }

    /// A point of the unit square by that density.
    #[inline]
    fn sample(&self, root: u32, mut u: Vec2) -> Vec2 {
        let (mut corner, mut side) = (Vec2::ZERO, 1.0);
        let mut node = root;
        loop {
            let Node { chances, children } = &self.nodes[node as usize];
            let right = choose(&mut u.x, chances[0] + chances[2], chances[1] + chances[3]);
            let up = choose(&mut u.y, chances[right], chances[right + 2]);
            side *= 0.5;
            corner += side * Vec2::new(right as f32, up as f32);
            match children[right + 2 * up] {
                0 => return corner + side * u,
                child => node = child,
            }
        }
    }
}

/// Chooses the first or the second by their weights, and makes a new number of what is left of `u`.
#[inline]
fn choose(u: &mut f32, first: f32, second: f32) -> usize {
    let share = first / (first + second);
    let (chosen, rest) = match *u < share {
        true => (0, *u / share),
        false => (1, (*u - share) / (1.0 - share)),
    };
    *u = rest.min(BELOW_ONE);
    chosen
}

impl Cells for SdTree {
    #[inline]
    fn cell(&self, position: Vec3, normal: Vec3) -> u32 {
        let (root, place) = (self.space.root(normal), self.space.place(position));
        self.space.find(root, place).leaf
    }

    fn cell_count(&self) -> u32 {
        self.leaves.len() as u32
    }

    fn parts_of(&self, coarser: &Self) -> Vec<u32> {
        let centres = self.space.centres().into_iter();
        let part_of = |(root, centre)| coarser.space.find(root, centre).leaf;
        centres.map(part_of).collect()
    }

    fn bytes(&self) -> u64 {
        let arrays = size_of_val(&self.leaves[..]) + size_of_val(&self.nodes[..]);
        self.space.bytes() + arrays as u64
    }
}

impl LocalTree<'_> {
    /// The number of the cell that was asked.
    #[inline]
    pub fn cell(&self) -> u32 {
        self.cell
    }

    /// Incident flux per area, in W/m^2.
    #[inline]
    pub fn irradiance(&self) -> Rgb {
        self.tree.leaves[self.cell as usize].irradiance
    }

    /// A direction. `select` tells whether it is uniform, `u` where it lies, both uniform.
    #[inline]
    pub fn sample(&self, select: f32, u: Vec2) -> GuideSample {
        let place = match select < self.tree.defensive {
            true => u,
            false => self.tree.sample(self.root, u),
        };
        let mut direction = square_to_sphere(place);
        let below = self.horizon.filter(|n| n.dot(direction) < 0.0);
        if let Some(normal) = below {
            direction = mirrored(direction, normal).normalize();
        }
        GuideSample {
            direction,
            pdf: self.density(direction),
        }
    }

    /// Solid-angle density of [`LocalTree::sample`]: positive, but for what is below the horizon.
    #[inline]
    pub fn pdf(&self, w: Vec3) -> f32 {
        match self.horizon {
            Some(normal) if normal.dot(w) < 0.0 => 0.0,
            _ => self.density(w),
        }
    }

    /// The same, taking for granted that the direction is above the horizon.
    #[inline]
    fn density(&self, w: Vec3) -> f32 {
        let of_tree = |w| self.tree.density(self.root, sphere_to_square(w));
        let (tree, ways) = match self.horizon {
            Some(normal) => (of_tree(w) + of_tree(mirrored(w, normal)), 2.0),
            None => (of_tree(w), 1.0),
        };
        let share = self.tree.defensive;
        (share * ways + (1.0 - share) * tree) * UNIFORM
    }
}

/// A direction mirrored by the plane of a normal.
#[inline]
fn mirrored(w: Vec3, normal: Vec3) -> Vec3 {
    w - 2.0 * w.dot(normal) * normal
}
