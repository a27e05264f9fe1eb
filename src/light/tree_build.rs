//! Building the light tree: binned splits by the surface area orientation heuristic (Conty Estevez
//! and Kulla 2018): strength times the area of the bounds times the measure of the directions lit.

use super::cluster::Cluster;
use super::cluster::WIDTH;
use super::tree::{Child, LightTree};
use crate::accel::Bounds;
use crate::math::Vec3;
use std::f32::consts::{FRAC_PI_2, PI};

/// Bins on each axis.
const BINS: usize = 12;
/// Depth beyond which the list is halved by count, so that no arrangement of lights makes a deep
/// tree.
const HALVE_FROM: u32 = 32;
/// Lights by which a split is judged; of more, some evenly strewn over the list.
const LOOKED_AT: usize = 4096;
/// Lights below which a subtree is not worth a task of its own.
const TASK: usize = 4096;

/// Bounds of a group while it is being built.
#[derive(Clone, Copy, Debug)]
struct Group {
    bounds: Bounds,
    axis: Vec3,
    /// Half-angle of the normals' cone; negative for an empty group.
    spread: f32,
    strength: f32,
}

/// A light to be put into the tree.
#[derive(Clone, Copy, Debug)]
struct Item {
    group: Group,
    leaf: u32,
}

impl Group {
    const EMPTY: Group = Group {
        bounds: Bounds::EMPTY,
        axis: Vec3::Z,
        spread: -1.0,
        strength: 0.0,
    };

    fn of(c: &Cluster) -> Self {
        Self {
            bounds: Bounds {
                min: c.center - c.radius,
                max: c.center + c.radius,
            },
            axis: c.axis,
            spread: c.cos_spread.clamp(-1.0, 1.0).acos(),
            strength: c.strength,
        }
    }

    fn union(&self, o: &Group) -> Group {
        let (axis, spread) = union_of_cones(self, o);
        Group {
            bounds: self.bounds.union(o.bounds),
            axis,
            spread,
            strength: self.strength + o.strength,
        }
    }

    fn cluster(&self) -> Cluster {
        Cluster {
            center: self.bounds.center(),
            radius: self.bounds.radius() * 1.000_01,
            axis: self.axis,
            // Widened by what the angles' rounding may have lost.
            cos_spread: (self.spread + 1e-3).min(PI).cos(),
            strength: self.strength,
        }
    }

    /// Strength times area times the measure of directions lit, for a surface that shines over a
    /// hemisphere.
    fn cost(&self) -> f32 {
        if self.bounds.is_empty() {
            return 0.0;
        }
        let d = self.bounds.max - self.bounds.min;
        let area = d.x * d.y + d.y * d.z + d.z * d.x;
        let o = self.spread.max(0.0);
        let w = (o + FRAC_PI_2).min(PI);
        let lit = 2.0 * PI * (1.0 - o.cos())
            + FRAC_PI_2 * (2.0 * w * o.sin() - (o - 2.0 * w).cos() - 2.0 * o * o.sin() + o.cos());
        self.strength * area * lit
    }
}

/// The smallest cone around both.
fn union_of_cones(a: &Group, b: &Group) -> (Vec3, f32) {
    if a.spread < 0.0 {
        return (b.axis, b.spread);
    }
    if b.spread < 0.0 {
        return (a.axis, a.spread);
    }
    let between = a.axis.dot(b.axis).clamp(-1.0, 1.0).acos();
    if (between + b.spread).min(PI) <= a.spread {
        return (a.axis, a.spread);
    }
    if (between + a.spread).min(PI) <= b.spread {
        return (b.axis, b.spread);
    }
    let spread = 0.5 * (a.spread + between + b.spread);
    if spread >= PI {
        return (a.axis, PI);
    }
    let across = a.axis.cross(b.axis).normalize_or_zero();
    if across == Vec3::ZERO {
        return (a.axis, PI);
    }
    let turn = spread - a.spread;
    let axis = a.axis * turn.cos() + across.cross(a.axis) * turn.sin();
    (axis.normalize(), spread)
}

/// A node of the binary tree that splitting makes.
#[derive(Clone, Copy, Debug)]
struct Fork {
    clusters: [Cluster; 2],
    children: [Child; 2],
    /// Lights below.
    count: u32,
}

impl LightTree {
    /// Builds a tree over leaves with these bounds. `None` without leaves.
    pub fn build(leaves: &[Cluster]) -> Option<Self> {
        let mut items: Vec<Item> = leaves
            .iter()
            .enumerate()
            .map(|(i, c)| Item {
                group: Group::of(c),
                leaf: i as u32,
            })
            .collect();
        let root = match leaves {
            [] => return None,
            [one] => *one,
            _ => total(&items).cluster(),
        };
        let blank = Fork {
            clusters: [root; 2],
            children: [Child::Leaf(0); 2],
            count: 0,
        };
        let mut forks = vec![blank; leaves.len() - 1];
        split(&mut items, &mut forks, 0, 0, leaves);
        let mut tree = LightTree::new(root, leaves.len());
        if !forks.is_empty() {
            widen(&forks, &mut tree);
        }
        Some(tree)
    }
}

/// Makes nodes of up to eight children from the binary tree, from the root down: the child with the
/// most lights is replaced by its own two until there is no more room.
fn widen(forks: &[Fork], tree: &mut LightTree) {
    let mut queue = std::collections::VecDeque::from([0u32]);
    let mut numbered = 1;
    while let Some(at) = queue.pop_front() {
        let fork = &forks[at as usize];
        let mut children: Vec<(Cluster, Child)> =
            fork.clusters.into_iter().zip(fork.children).collect();
        while children.len() < WIDTH {
            let lights = |child: &Child| match child {
                Child::Node(i) => forks[*i as usize].count,
                Child::Leaf(_) => 0,
            };
            let largest = (0..children.len()).max_by_key(|&i| lights(&children[i].1));
            let Some((i, Child::Node(index))) = largest.map(|i| (i, children[i].1)) else {
                break;
            };
            let fork = &forks[index as usize];
            children[i] = (fork.clusters[0], fork.children[0]);
            children.push((fork.clusters[1], fork.children[1]));
        }
        for (_, child) in &mut children {
            if let Child::Node(i) = child {
                queue.push_back(*i);
                *i = numbered;
                numbered += 1;
            }
        }
        tree.push(&children);
    }
}

fn total(items: &[Item]) -> Group {
    items
        .iter()
        .fold(Group::EMPTY, |g, item| g.union(&item.group))
}

/// Writes the tree over `items` into `forks` (one fewer than items), whose first has the index
/// `base`. A child with m lights takes m - 1 forks, so both halves know their place and are built
/// in parallel.
fn split(items: &mut [Item], forks: &mut [Fork], base: usize, depth: u32, leaves: &[Cluster]) {
    let count = items.len() as u32;
    let Some((fork, rest)) = forks.split_first_mut() else {
        return;
    };
    let middle = partition(items, depth);
    let (left, right) = items.split_at_mut(middle);
    let (left_forks, right_forks) = rest.split_at_mut(middle - 1);
    let bases = [base + 1, base + middle];
    let child = |part: &[Item], base: usize| match part {
        [one] => (leaves[one.leaf as usize], Child::Leaf(one.leaf)),
        _ => (total(part).cluster(), Child::Node(base as u32)),
    };
    let (a, b) = (child(left, bases[0]), child(right, bases[1]));
    *fork = Fork {
        clusters: [a.0, b.0],
        children: [a.1, b.1],
        count,
    };
    if count as usize > TASK {
        rayon::join(
            || split(left, left_forks, bases[0], depth + 1, leaves),
            || split(right, right_forks, bases[1], depth + 1, leaves),
        );
    } else {
        split(left, left_forks, bases[0], depth + 1, leaves);
        split(right, right_forks, bases[1], depth + 1, leaves);
    }
}

/// Orders `items` so that one child's come first; returns how many they are, at least one and not
/// all.
fn partition(items: &mut [Item], depth: u32) -> usize {
    let half = items.len() / 2;
    if items.len() == 2 {
        return 1;
    }
    let center = |item: &Item| item.group.bounds.center();
    let centers = items
        .iter()
        .fold(Bounds::EMPTY, |b, item| b.with(center(item)));
    let extent = centers.max - centers.min;
    // As many as one node holds are put side by side in it: how they are parted hardly matters.
    let search = depth < HALVE_FROM && items.len() > WIDTH;
    let best = search.then(|| best_split(items, centers, extent)).flatten();
    let Some((axis, bin)) = best else {
        let axis = extent.max_position();
        items.select_nth_unstable_by(half, |a, b| {
            let (x, y) = (center(a)[axis], center(b)[axis]);
            x.total_cmp(&y).then(a.leaf.cmp(&b.leaf))
        });
        return half;
    };
    let mut middle = 0;
    for i in 0..items.len() {
        if bin_of(center(&items[i])[axis], centers.min[axis], extent[axis]) <= bin {
            items.swap(i, middle);
            middle += 1;
        }
    }
    middle
}

fn bin_of(x: f32, min: f32, extent: f32) -> usize {
    (((x - min) / extent * BINS as f32) as usize).min(BINS - 1)
}

/// The axis and the last bin of the first child for the cheapest split; `None` if nothing separates
/// the lights.
fn best_split(items: &[Item], centers: Bounds, extent: Vec3) -> Option<(usize, usize)> {
    let longest = extent.max_element();
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in 0..3 {
        if extent[axis].is_nan() || extent[axis] <= longest * 1e-6 {
            continue;
        }
        let mut bins = [Group::EMPTY; BINS];
        for item in items.iter().step_by(items.len().div_ceil(LOOKED_AT)) {
            let x = item.group.bounds.center()[axis];
            let i = bin_of(x, centers.min[axis], extent[axis]);
            bins[i] = bins[i].union(&item.group);
        }
        // Long thin halves are worse than their area says: weigh by how much longer the longest
        // side is.
        let regularity = longest / extent[axis];
        for (bin, cost) in sweep(&bins) {
            let cost = cost * regularity;
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, bin));
            }
        }
    }
    best.map(|(_, axis, bin)| (axis, bin))
}

/// Each place between two bins that separates lights, by the bin before it, and the cost of parting
/// there.
fn sweep(bins: &[Group; BINS]) -> impl Iterator<Item = (usize, f32)> + '_ {
    let mut above = [0.0; BINS];
    let mut group = Group::EMPTY;
    for bin in (1..BINS).rev() {
        if bins[bin].spread >= 0.0 {
            group = group.union(&bins[bin]);
            above[bin - 1] = group.cost();
        } else {
            // The next filled bin beyond has the same lights above it; parting there is the same.
            above[bin - 1] = above[bin];
        }
    }
    let last = (0..BINS)
        .rev()
        .find(|&i| bins[i].spread >= 0.0)
        .unwrap_or(0);
    let mut below = Group::EMPTY;
    (0..last).filter_map(move |bin| {
        if bins[bin].spread < 0.0 {
            return None;
        }
        below = below.union(&bins[bin]);
        Some((bin, below.cost() + above[bin]))
    })
}
