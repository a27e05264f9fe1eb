//! From sums to something to sample: densities, lists of links, prefix sums.

use super::field::{Entry, Field, NONE, Node};
use super::links::{Place, Product, Split, step};
use super::model::{LEVELS_UP, Neighbourhood};
use super::record::Origin;
use super::settings::Source;
use super::space::SpaceNode;
use super::train::{Trainer, region};
use crate::math::DVec3;
use crate::math::Vec3;
use crate::math::equal_area::{CODE_LEVELS, DirectionCell};
use std::collections::BTreeMap;

/// Path vertices a cell must have before they speak for it beside photons.
const ENOUGH_VISITS: u64 = 32;

/// Where the lists of links are.
struct Lists {
    of_node: Vec<u32>,
    count: usize,
    /// Per list: the next list up the path, then where each bucket starts, then the end.
    table: Vec<u32>,
}

impl Trainer {
    /// The immutable field for sampling. The trainer stays as it is and can go on.
    pub fn freeze(&self) -> Field {
        let groups = 1usize << (2 * self.traits.base_level);
        let density = self.densities();
        let largest = density.iter().map(|d| d.max_element()).fold(0.0, f64::max);
        // Sums are brought near 1, so that neither 1e30 W nor 1e-30 W leave the range of f32.
        let scale = if largest > 0.0 && largest.is_finite() {
            largest
        } else {
            1.0
        };
        let mut order: Vec<u32> = (0..self.product.links.len() as u32).collect();
        order.sort_unstable_by_key(|&l| {
            let link = &self.product.links[l as usize];
            (link.r, link.q.start())
        });
        let mut field = Field::empty(self, groups, scale);
        let (lists, slot_of) = self.fill_lists(&mut field, &order, &density, groups);
        field.lists = lists.table;
        field.nodes = pack_nodes(&self.product, &slot_of);
        let regions = |l: u32| region(&self.space, &self.product.links[l as usize]);
        let neighbourhoods = || self.neighbourhoods(&order);
        field.models = self.stats.freeze(&order, &regions, &neighbourhoods);
        if self.traits.stats_bytes == 0 {
            field.model_of = Vec::new();
        }
        let children = self.parents();
        self.fill_cells(&mut field, &lists.of_node, &children, groups);
        field
    }

    /// Who may learn from whom: links whose larger cell of R, some levels up, is the same, on surfaces that face
    /// the same way, from all links in that cell.
    fn neighbourhoods(&self, order: &[u32]) -> Vec<Neighbourhood> {
        let grid = &self.space.grid;
        let node = |l: u32| &self.space.nodes[self.product.links[l as usize].r as usize];
        let within = |node: &SpaceNode, level: u8| match level {
            0 => (0, 0),
            level => (level, node.prefix >> grid.shift(level - 1)),
        };
        let mut found: BTreeMap<(u8, u64), Neighbourhood> = BTreeMap::new();
        for (place, &l) in order.iter().enumerate() {
            let node = node(l);
            let top = grid.normal_levels().min(node.level);
            let level = node.level.saturating_sub(LEVELS_UP).max(top);
            let learning = &mut found.entry(within(node, level)).or_default().learning;
            learning.push(place as u32);
        }
        for (place, &l) in order.iter().enumerate() {
            let node = node(l);
            for level in 0..=node.level {
                if let Some(cell) = found.get_mut(&within(node, level)) {
                    cell.known.push(place as u32);
                }
            }
        }
        found.into_values().collect()
    }

    /// F of each leaf link: flux over area, averaged with the mean over path vertices.
    fn densities(&self) -> Vec<DVec3> {
        let zero = || vec![DVec3::ZERO; self.tallies.len()];
        let source = self.settings.source;
        let photons = match self.photon_unit {
            Some(u) if source != Source::Paths => {
                self.smoothed(Origin::Photon, |l| self.tallies[l].photons.rgb(u))
            }
            _ => zero(),
        };
        let paths = match self.path_unit {
            Some(u) if source != Source::Photons => {
                self.smoothed(Origin::Path, |l| self.tallies[l].paths.rgb(u))
            }
            _ => zero(),
        };
        let emitted = match self.intakes.emitted {
            0 => self.intakes.photons.max(1),
            n => n,
        } as f64;
        let measure: Vec<(f64, u64)> = (0..self.space.nodes.len() as u32)
            .map(|r| (self.space.area(r), self.space.visits(r)))
            .collect();
        self.product
            .links
            .iter()
            .enumerate()
            .map(|(i, link)| {
                let (area, visits) = measure[link.r as usize];
                let by_photons = photons[i] / (emitted * area);
                let by_paths = paths[i] / visits.max(1) as f64;
                let density = match source {
                    Source::Photons => by_photons,
                    Source::Paths => by_paths,
                    Source::Both if visits >= ENOUGH_VISITS => 0.5 * (by_photons + by_paths),
                    Source::Both => by_photons,
                };
                if density.is_finite() {
                    density
                } else {
                    DVec3::ZERO
                }
            })
            .collect()
    }

    /// Fluxes of leaf links with a few records' worth of each P node's flux spread over its children
    /// by measure (a Polya tree): a child that met nothing yet is dim, not black.
    fn smoothed(&self, origin: Origin, leaf: impl Fn(usize) -> DVec3) -> Vec<DVec3> {
        let nodes = &self.product.nodes;
        let order = self.product.preorder();
        let mut flux = vec![DVec3::ZERO; nodes.len()];
        let mut count = vec![0f64; nodes.len()];
        let mut r_of = vec![0u32; nodes.len()];
        for &(i, split) in order.iter().rev() {
            let n = nodes[i as usize];
            if split == Split::Leaf {
                flux[i as usize] = leaf(n.first as usize);
                count[i as usize] = self.tallies[n.first as usize].count[origin as usize] as f64;
                continue;
            }
            for c in n.first..n.first + arity(split) {
                let child = flux[c as usize];
                flux[i as usize] += child;
                let child = count[c as usize];
                count[i as usize] += child;
            }
        }
        let strength = f64::from(self.settings.smoothing);
        let mut smooth = flux.clone();
        for &(i, split) in &order {
            let n = nodes[i as usize];
            let r = r_of[i as usize];
            let first_r = self.space.nodes[r as usize].first;
            let measure = match split {
                Split::Leaf => continue,
                Split::Space => self.octant_measure(r, origin),
                Split::Direction => [1.0; 8],
            };
            let k = arity(split);
            let total: f64 = measure[..k as usize].iter().sum();
            let weight = strength / (count[i as usize] + strength).max(1e-300);
            for c in 0..k {
                let child = (n.first + c) as usize;
                r_of[child] = if split == Split::Space {
                    first_r + c
                } else {
                    r
                };
                let m = if total > 0.0 {
                    measure[c as usize] / total
                } else {
                    1.0 / f64::from(k)
                };
                smooth[child] =
                    blend(flux[child], flux[i as usize], weight, m) * smooth[i as usize];
            }
        }
        let mut out = vec![DVec3::ZERO; self.tallies.len()];
        for &(i, split) in &order {
            if split == Split::Leaf {
                out[nodes[i as usize].first as usize] = smooth[i as usize];
            }
        }
        out
    }

    /// Appends each R-node's links to the field, grouped by base direction cell, with running sums.
    fn fill_lists(
        &self,
        field: &mut Field,
        order: &[u32],
        density: &[DVec3],
        groups: usize,
    ) -> (Lists, Vec<u32>) {
        let base_shift = 32 - 2 * u32::from(self.traits.base_level);
        let group = |q: DirectionCell| (u64::from(q.start()) >> base_shift) as usize;
        let mut lists = Lists {
            of_node: vec![NONE; self.space.nodes.len()],
            count: 0,
            table: Vec::new(),
        };
        let mut slot_of = vec![0u32; order.len()];
        let mut position = 0usize;
        for run in order.chunk_by(|a, b| self.r_of(*a) == self.r_of(*b)) {
            lists.of_node[self.r_of(run[0]) as usize] = lists.count as u32;
            lists.count += 1;
            lists.table.push(NONE);
            let mut rest = run;
            for g in 0..groups {
                lists.table.push(field.prefix.len() as u32);
                let n = rest.partition_point(|&l| group(self.product.links[l as usize].q) <= g);
                let (mine, others) = rest.split_at(n);
                rest = others;
                if mine.is_empty() {
                    continue;
                }
                let mut sum = DVec3::ZERO;
                field.push_slot(sum.as_vec3(), DirectionCell::SPHERE, NONE);
                for &l in mine {
                    sum += density[l as usize] / field.scale;
                    // The running sum *before* a link is at its slot, the one after it follows.
                    let slot = field.prefix.len() as u32 - 1;
                    slot_of[l as usize] = slot;
                    field.set_slot(slot, self.product.links[l as usize].q, position as u32);
                    field.push_slot(sum.as_vec3(), DirectionCell::SPHERE, NONE);
                    position += 1;
                }
            }
            lists.table.push(field.prefix.len() as u32);
        }
        (lists, slot_of)
    }

    fn r_of(&self, link: u32) -> u32 {
        self.product.links[link as usize].r
    }

    fn parents(&self) -> Vec<u32> {
        let mut parent = vec![NONE; self.space.nodes.len()];
        for (i, n) in self.space.nodes.iter().enumerate() {
            if n.first != 0 {
                parent[n.first as usize..n.first as usize + 8].fill(i as u32);
            }
        }
        parent
    }

    /// One record for each leaf of R: the flux of its whole path by group, where to enter P, and the
    /// deepest list on its path.
    fn fill_cells(&self, field: &mut Field, list_of: &[u32], parent: &[u32], groups: usize) {
        // Parents come before children in the arena, so one pass knows every path.
        let mut path_flux = vec![[Vec3::ZERO; 16]; self.space.nodes.len()];
        let mut nearest = vec![NONE; self.space.nodes.len()];
        for (i, node) in self.space.nodes.iter().enumerate() {
            if let Some(p) = parent.get(i).filter(|p| **p != NONE) {
                path_flux[i] = path_flux[*p as usize];
                nearest[i] = nearest[*p as usize];
            }
            let list = list_of[i];
            if list != NONE {
                field.chain(list, nearest[i]);
                nearest[i] = list;
                for (g, sum) in path_flux[i].iter_mut().enumerate().take(groups) {
                    let range = field.bucket(list, g);
                    *sum += field.bucket_total(&range);
                }
            }
            if node.first != 0 {
                field.space.push(node.first);
                continue;
            }
            field.space.push(Field::leaf_mark(field.cell_list.len()));
            field.cell_list.push(nearest[i]);
            field.cell_key.push(node.prefix);
            let flux = &path_flux[i][..groups];
            field.cell_flux.extend(flux.iter().map(|f| f.x));
            field.cell_flux.extend(flux.iter().map(|f| f.y));
            field.cell_flux.extend(flux.iter().map(|f| f.z));
            for g in 0..groups {
                let entry = self.entry(&field.nodes, node.prefix, g);
                field.cell_entry.push(entry);
            }
        }
    }

    /// The node of P below which only finer directions and this cell's own splits remain.
    fn entry(&self, packed: &[Node], key: u64, group: usize) -> Entry {
        let base = self.traits.base_level;
        let code = ((group as u64) << (2 * u32::from(CODE_LEVELS - base))) as u32;
        let mut at = Place::ROOT;
        loop {
            let n = self.product.nodes[at.node as usize];
            let done = n.split == Split::Direction && at.direction_level >= base;
            match step(&self.product.nodes, &self.space.grid, key, code, at) {
                Some(next) if !done => at = next,
                _ => {
                    return Entry {
                        node: packed[at.node as usize],
                        space_level: at.space_level,
                        direction_level: at.direction_level,
                    };
                }
            }
        }
    }
}

fn arity(split: Split) -> u32 {
    match split {
        Split::Leaf => 0,
        Split::Space => 8,
        Split::Direction => 4,
    }
}

/// The child's share of its parent's flux, drawn towards its share of the measure.
fn blend(child: DVec3, parent: DVec3, weight: f64, measure: f64) -> DVec3 {
    let share = |c: f64, p: f64| {
        if p > 0.0 {
            (1.0 - weight) * (c / p) + weight * measure
        } else {
            measure
        }
    };
    DVec3::new(
        share(child.x, parent.x),
        share(child.y, parent.y),
        share(child.z, parent.z),
    )
}

/// P as the field has it. A node keeps its number, as `entry` knows it by that.
fn pack_nodes(product: &Product, slot_of: &[u32]) -> Vec<Node> {
    product
        .nodes
        .iter()
        .map(|n| match n.split {
            Split::Leaf => Node::new(slot_of[n.first as usize], 0),
            Split::Space => Node::new(n.first, 1),
            Split::Direction => Node::new(n.first, 2),
        })
        .collect()
}
