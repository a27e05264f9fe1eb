//! The tree of directions of a spatial leaf, while it learns.

use super::{Settings, Target};
use crate::math::Vec2;

/// A square of the map, cut into four: quadrant 1 is beside 0 along x, 2 along y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Node {
    /// What was added to the quadrants that are not divided.
    pub sums: [f32; 4],
    /// The quadrants' own nodes, behind this one; 0 for those that are not divided.
    pub children: [u32; 4],
}

/// What a pass adds to a tree, node by node.
pub(super) type Sums = Vec<[f32; 4]>;

/// A quadtree over the unit square.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Quadtree {
    nodes: Vec<Node>,
}

/// The quadrant that holds a point of a square, and the point as the quadrant has it.
#[inline]
pub(super) fn enter(p: Vec2) -> (usize, Vec2) {
    let p = 2.0 * p;
    let upper = p.cmpge(Vec2::ONE);
    let quadrant = upper.bitmask() as usize;
    (quadrant, p - Vec2::select(upper, Vec2::ONE, Vec2::ZERO))
}

/// A box of the map.
type Box2 = [Vec2; 2];

/// A box cut at the square's edge along x. What is beyond lies elsewhere on the sphere's map: it is
/// mirrored back over the edge, and the edge itself is turned around.
fn folded([low, high]: Box2) -> [Option<Box2>; 2] {
    let inside = [low.with_x(low.x.max(0.0)), high.with_x(high.x.min(1.0))];
    let beyond = match (low.x < 0.0, high.x > 1.0) {
        (true, _) => Some((0.0, -low.x)),
        (_, true) => Some((2.0 - high.x, 1.0)),
        _ => None,
    };
    let turned = |(from, to)| [Vec2::new(from, 1.0 - high.y), Vec2::new(to, 1.0 - low.y)];
    [Some(inside), beyond.map(turned)]
}

fn swapped(v: Vec2) -> Vec2 {
    Vec2::new(v.y, v.x)
}

impl Quadtree {
    /// Four quadrants that have received nothing.
    pub fn new() -> Self {
        Self {
            nodes: vec![Node::default()],
        }
    }

    /// The nodes, parents first.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Quadrants that are not divided.
    pub fn cells(&self) -> u64 {
        3 * self.nodes.len() as u64 + 1
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.nodes[..]) as u64
    }

    /// Adds a term at a point of the square.
    #[inline]
    pub fn add(&self, sums: &mut [[f32; 4]], point: Vec2, term: f32, filter: bool) {
        let (mut node, mut p, mut side) = (0, point, 0.5);
        let quadrant = loop {
            let (quadrant, inner) = enter(p);
            match self.nodes[node].children[quadrant] {
                0 => break quadrant,
                child => (node, p, side) = (child as usize, inner, 0.5 * side),
            }
        };
        if !filter {
            sums[node][quadrant] += term;
            return;
        }
        let half = Vec2::splat(0.5 * side);
        let density = term / (side * side);
        for piece in folded([point - half, point + half]).into_iter().flatten() {
            for turned in folded(piece.map(swapped)).into_iter().flatten() {
                self.spread(sums, 0, turned.map(swapped), 0.25 * density);
            }
        }
    }

    /// Adds what a box that has a density of 1 brings to a node's quadrants, where a quadrant that
    /// is filled gets `whole`.
    fn spread(&self, sums: &mut [[f32; 4]], node: usize, [low, high]: Box2, whole: f32) {
        for quadrant in 0..4 {
            let corner = Vec2::new((quadrant & 1) as f32, (quadrant >> 1) as f32);
            let inner = [low, high].map(|v| (2.0 * v - corner).clamp(Vec2::ZERO, Vec2::ONE));
            let area = (inner[1] - inner[0]).max(Vec2::ZERO).element_product();
            if area <= 0.0 {
                continue;
            }
            match self.nodes[node].children[quadrant] {
                0 => sums[node][quadrant] += whole * area,
                child => self.spread(sums, child as usize, inner, 0.25 * whole),
            }
        }
    }

    /// Sums of nothing.
    pub fn no_sums(&self) -> Sums {
        vec![[0.0; 4]; self.nodes.len()]
    }

    /// Takes in what a pass has added.
    pub fn take(&mut self, sums: &[[f32; 4]]) {
        for (node, added) in self.nodes.iter_mut().zip(sums) {
            for (sum, a) in node.sums.iter_mut().zip(added) {
                *sum += a;
            }
        }
    }

    /// Lets all sums count for so much of themselves.
    pub fn scale(&mut self, by: f32) {
        for sum in self.nodes.iter_mut().flat_map(|n| &mut n.sums) {
            *sum *= by;
        }
    }

    /// What each quadrant of each node is worth to the target; all of it in the end.
    pub fn energies(&self, target: Target) -> (Vec<[f32; 4]>, f32) {
        let mut areas = vec![0.25f32; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate() {
            for &child in node.children.iter().filter(|c| **c != 0) {
                areas[child as usize] = 0.25 * areas[i];
            }
        }
        let mut energies = vec![[0f32; 4]; self.nodes.len()];
        for (i, node) in self.nodes.iter().enumerate().rev() {
            energies[i] = std::array::from_fn(|q| match (node.children[q], target) {
                (0, Target::Radiance) => node.sums[q],
                (0, Target::SecondMoment) => (node.sums[q] * areas[i]).sqrt(),
                (child, _) => energies[child as usize].iter().sum(),
            });
        }
        let all = energies[0].iter().sum();
        (energies, all)
    }

    /// The same sums on a tree whose cells are divided where they hold more than a share of the
    /// energy, and not elsewhere.
    pub fn reshaped(&self, settings: &Settings, share: f32) -> Self {
        let (energies, all) = self.energies(settings.target);
        let mut shape = Shape {
            old: self,
            energies,
            limit: all * share,
            max_level: settings.max_level,
            nodes: Vec::new(),
        };
        shape.add(Source::Node(0), 1);
        Self { nodes: shape.nodes }
    }

    /// All that was added below a quadrant.
    fn below(&self, node: u32, quadrant: usize) -> f32 {
        let node = &self.nodes[node as usize];
        match node.children[quadrant] {
            0 => node.sums[quadrant],
            child => (0..4).map(|q| self.below(child, q)).sum(),
        }
    }
}

/// Where a new node's sums come from.
#[derive(Clone, Copy)]
enum Source {
    /// The old tree has the node.
    Node(u32),
    /// A cell that was not divided: a quarter of its sum and of its energy for each quadrant.
    Quarters { sum: f32, energy: f32 },
}

/// A tree in the making.
struct Shape<'a> {
    old: &'a Quadtree,
    energies: Vec<[f32; 4]>,
    /// Energy of a cell that is not divided, at most.
    limit: f32,
    max_level: u32,
    nodes: Vec<Node>,
}

impl Shape<'_> {
    /// Adds a node of this level and all below it; its number.
    fn add(&mut self, source: Source, level: u32) -> u32 {
        let number = self.nodes.len();
        self.nodes.push(Node::default());
        for quadrant in 0..4 {
            let (energy, child) = match source {
                Source::Node(n) => (
                    self.energies[n as usize][quadrant],
                    self.old.nodes[n as usize].children[quadrant],
                ),
                Source::Quarters { energy, .. } => (energy, 0),
            };
            let sum = match source {
                Source::Node(n) => self.old.below(n, quadrant),
                Source::Quarters { sum, .. } => sum,
            };
            if energy > self.limit && level < self.max_level {
                let below = match child {
                    0 => Source::Quarters {
                        sum: 0.25 * sum,
                        energy: 0.25 * energy,
                    },
                    child => Source::Node(child),
                };
                let child = self.add(below, level + 1);
                self.nodes[number].children[quadrant] = child;
            } else {
                self.nodes[number].sums[quadrant] = sum;
            }
        }
        number as u32
    }
}
