//! What a field looks like in numbers.

use super::links::Split;
use super::train::{Intakes, Trainer};

/// Sizes, depths and counts of a field, for reports.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct Stats {
    /// Nodes of R.
    pub space_nodes: u64,
    /// Leaves of R: cells that a query can end in.
    pub space_cells: u64,
    /// Nodes of P.
    pub product_nodes: u64,
    /// Leaves of P: links with a model.
    pub links: u64,
    /// Leaves of R by level.
    pub space_depths: Vec<u64>,
    /// Links by the level of their cell of R.
    pub link_space_depths: Vec<u64>,
    /// Links by the level of their direction cell.
    pub link_direction_depths: Vec<u64>,
    /// Mean number of links that partition the sphere around a point, over the cells of R.
    pub links_per_cell: f64,
    /// Bytes held while training, see [`Trainer::bytes`].
    pub training_bytes: u64,
    /// What came in.
    pub intakes: Intakes,
}

fn count(histogram: &mut Vec<u64>, level: u8) {
    let level = usize::from(level);
    if histogram.len() <= level {
        histogram.resize(level + 1, 0);
    }
    histogram[level] += 1;
}

impl Trainer {
    /// The field in numbers.
    pub fn stats(&self) -> Stats {
        let mut s = Stats {
            space_nodes: self.space.nodes.len() as u64,
            product_nodes: self.product.nodes.len() as u64,
            links: self.product.links.len() as u64,
            training_bytes: self.bytes(),
            intakes: self.intakes,
            ..Stats::default()
        };
        // Links of a path: each node's own plus its parent's, parents first.
        let mut along = vec![0u64; self.space.nodes.len()];
        for l in &self.product.links {
            count(
                &mut s.link_space_depths,
                self.space.nodes[l.r as usize].level,
            );
            count(&mut s.link_direction_depths, l.q.level());
            along[l.r as usize] += 1;
        }
        let mut total = 0;
        for (i, n) in self.space.nodes.iter().enumerate() {
            if n.first == 0 {
                s.space_cells += 1;
                count(&mut s.space_depths, n.level);
                total += along[i];
                continue;
            }
            for c in n.first..n.first + 8 {
                along[c as usize] += along[i];
            }
        }
        s.links_per_cell = total as f64 / s.space_cells.max(1) as f64;
        debug_assert_eq!(
            self.product
                .nodes
                .iter()
                .filter(|n| n.split == Split::Leaf)
                .count() as u64,
            s.links
        );
        s
    }
}
