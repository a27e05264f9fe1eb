//! From sums to something to sample: densities, cells, and who learns from whom.

use super::field::{Field, LEAF};
use super::link_index::Lists;
use super::links::Split;
use super::model::{LEVELS_UP, Neighbourhood};
use super::record::Origin;
use super::settings::Source;
use super::space::SpaceNode;
use super::train::{Trainer, region};
use crate::math::DVec3;
use std::collections::BTreeMap;

/// Path vertices a cell must have before they speak for it beside photons.
const ENOUGH_VISITS: u64 = 32;

impl Trainer {
    /// The immutable field for sampling. The trainer stays as it is and can go on.
    pub fn freeze(&self) -> Field {
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
        let regions = |l: u32| region(&self.space, &self.product.links[l as usize]);
        let neighbourhoods = || self.neighbourhoods(&order);
        let models = self.stats.freeze(&order, &regions, &neighbourhoods);
        let (lists, cell_flux) = if self.traits.splits_directions {
            let (lists, flux) = Lists::build(self, &order, &density, scale);
            (Some(lists), flux)
        } else {
            // Cells and links are the same, and in the same order.
            let flux = |&l: &u32| (density[l as usize] / scale).as_vec3().to_array();
            (None, order.iter().flat_map(flux).collect())
        };
        let (space, cell_key) = self.cells();
        Field {
            grid: self.space.grid,
            scale,
            defensive: self.settings.defensive,
            product: self.settings.product,
            space,
            cell_key,
            cell_flux,
            lists,
            models,
        }
    }

    /// R as the field has it, and a key in each of its cells.
    fn cells(&self) -> (Vec<u32>, Vec<u64>) {
        let nodes = &self.space.nodes;
        let mut keys = Vec::with_capacity(self.space.leaf_count());
        let mut space = Vec::with_capacity(nodes.len());
        for node in nodes {
            if node.first != 0 {
                space.push(node.first);
                continue;
            }
            space.push(keys.len() as u32 | LEAF);
            keys.push(node.prefix);
        }
        (space, keys)
    }

    /// Who may learn from whom: links whose larger cell of R, some levels up, is the same, on
    /// surfaces that face the same way, from all links in that cell.
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
            let top = grid.side_levels().min(node.level);
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
    pub(super) fn densities(&self) -> Vec<DVec3> {
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

    /// Fluxes of leaf links with a few records' worth of each P node's flux spread over its
    /// children by measure (a Polya tree): a child that met nothing yet is dim, not black.
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
