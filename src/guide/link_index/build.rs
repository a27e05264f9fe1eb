//! From links to lists.

use super::{Caps, Entry, GROUPS, Lists, NONE, PackedNode};
use crate::guide::links::{Product, ProductPosition, Split, step};
use crate::guide::space::SpaceNode;
use crate::guide::train::Trainer;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use crate::math::{DVec3, Vec3};

impl Lists {
    /// The lists of all links, `order` being their numbers sorted by R node and direction, with F
    /// in units of `scale`, and each cell's flux: all groups' red, then green, then blue.
    pub fn build(
        trainer: &Trainer,
        order: &[u32],
        density: &[DVec3],
        scale: f64,
    ) -> (Self, Vec<f32>) {
        let mut lists = Self {
            cell_list: Vec::new(),
            cell_entry: Vec::new(),
            lists: Vec::new(),
            prefix: Vec::new(),
            cells_q: Vec::new(),
            model_of: Vec::new(),
            nodes: Vec::new(),
            caps: Caps::new(),
        };
        let (list_of, slot_of) = lists.fill(trainer, order, density, scale);
        lists.nodes = pack_nodes(&trainer.product, &slot_of);
        if trainer.traits.stats_bytes == 0 {
            lists.model_of = Vec::new();
        }
        let flux = lists.fill_cells(trainer, &list_of);
        (lists, flux)
    }

    /// Appends each R-node's links, grouped by base direction cell, with running sums. Returns each
    /// node's list and each link's slot.
    fn fill(
        &mut self,
        trainer: &Trainer,
        order: &[u32],
        density: &[DVec3],
        scale: f64,
    ) -> (Vec<u32>, Vec<u32>) {
        let links = &trainer.product.links;
        let base_shift = 32 - GROUPS.ilog2();
        let group = |l: u32| (links[l as usize].q.start() >> base_shift) as usize;
        let mut list_of = vec![NONE; trainer.space.nodes.len()];
        let mut slot_of = vec![0u32; order.len()];
        let (mut count, mut position) = (0, 0);
        let r_of = |l: u32| links[l as usize].r;
        for run in order.chunk_by(|a, b| r_of(*a) == r_of(*b)) {
            list_of[r_of(run[0]) as usize] = count;
            count += 1;
            self.lists.push(NONE);
            let mut rest = run;
            for g in 0..GROUPS {
                self.lists.push(self.prefix.len() as u32);
                let n = rest.partition_point(|&l| group(l) <= g);
                let (mine, others) = rest.split_at(n);
                rest = others;
                if mine.is_empty() {
                    continue;
                }
                let mut sum = DVec3::ZERO;
                self.push_slot(sum.as_vec3());
                for &l in mine {
                    sum += density[l as usize] / scale;
                    // The running sum *before* a link is at its slot, the one after it follows.
                    let slot = self.prefix.len() - 1;
                    slot_of[l as usize] = slot as u32;
                    let q = links[l as usize].q;
                    // Levels up to 10 leave the 12 lowest bits of a start code free.
                    self.cells_q[slot] = q.start() | u32::from(q.level());
                    self.model_of[slot] = position;
                    self.push_slot(sum.as_vec3());
                    position += 1;
                }
            }
            self.lists.push(self.prefix.len() as u32);
        }
        (list_of, slot_of)
    }

    fn push_slot(&mut self, prefix: Vec3) {
        self.prefix.push(prefix);
        let sphere = DirectionCell::SPHERE;
        self.cells_q
            .push(sphere.start() | u32::from(sphere.level()));
        self.model_of.push(NONE);
    }

    /// One record for each leaf of R: where to enter P, and the deepest list on its path. Returns
    /// the flux of their whole paths by group.
    fn fill_cells(&mut self, trainer: &Trainer, list_of: &[u32]) -> Vec<f32> {
        let nodes = &trainer.space.nodes;
        let parent = parents(nodes);
        // Parents come before children in the arena, so one pass knows every path.
        let mut path_flux = vec![[Vec3::ZERO; GROUPS]; nodes.len()];
        let mut nearest = vec![NONE; nodes.len()];
        let mut cell_flux = Vec::new();
        for (i, node) in nodes.iter().enumerate() {
            if parent[i] != NONE {
                path_flux[i] = path_flux[parent[i] as usize];
                nearest[i] = nearest[parent[i] as usize];
            }
            let list = list_of[i];
            if list != NONE {
                self.lists[list as usize * (GROUPS + 2)] = nearest[i];
                nearest[i] = list;
                for (g, sum) in path_flux[i].iter_mut().enumerate() {
                    let range = self.bucket(list, g);
                    if !range.is_empty() {
                        *sum += self.prefix[range.end - 1];
                    }
                }
            }
            if node.first != 0 {
                continue;
            }
            self.cell_list.push(nearest[i]);
            let flux = &path_flux[i];
            cell_flux.extend(flux.iter().map(|f| f.x));
            cell_flux.extend(flux.iter().map(|f| f.y));
            cell_flux.extend(flux.iter().map(|f| f.z));
            for g in 0..GROUPS {
                let entry = self.entry(trainer, node.prefix, g);
                self.cell_entry.push(entry);
            }
        }
        cell_flux
    }

    /// The node of P below which only finer directions and this cell's own splits remain.
    fn entry(&self, trainer: &Trainer, key: u64, group: usize) -> Entry {
        let base = trainer.traits.base_level;
        let code = ((group as u64) << (2 * u32::from(CODE_LEVELS - base))) as u32;
        let nodes = &trainer.product.nodes;
        let mut at = ProductPosition::ROOT;
        loop {
            let n = nodes[at.node as usize];
            let done = n.split == Split::Direction && at.direction_level >= base;
            match step(nodes, &trainer.space.grid, key, code, at) {
                Some(next) if !done => at = next,
                _ => {
                    return Entry {
                        node: self.nodes[at.node as usize],
                        space_level: at.space_level,
                        direction_level: at.direction_level,
                    };
                }
            }
        }
    }
}

/// Of each node of R the one above it.
fn parents(nodes: &[SpaceNode]) -> Vec<u32> {
    let mut parent = vec![NONE; nodes.len()];
    for (i, n) in nodes.iter().enumerate() {
        if n.first != 0 {
            parent[n.first as usize..n.first as usize + 8].fill(i as u32);
        }
    }
    parent
}

/// P as the field has it. A node keeps its number, as `entry` knows it by that.
fn pack_nodes(product: &Product, slot_of: &[u32]) -> Vec<PackedNode> {
    product
        .nodes
        .iter()
        .map(|n| match n.split {
            Split::Leaf => PackedNode::new(slot_of[n.first as usize], 0),
            Split::Space => PackedNode::new(n.first, 1),
            Split::Direction => PackedNode::new(n.first, 2),
        })
        .collect()
}
