//! From records of camera paths to trees.

use super::Settings;
use super::leaf::{Added, Leaf};
use super::quadtree::Quadtree;
use super::sd_tree::{SdTree, frozen};
use super::space::Space;
use crate::guide::quantise::batch_unit;
use crate::guide::{GuideError, PathSample, Stats};
use crate::math::equal_area::unit;
use crate::math::rng::{hash64, unit_f32};
use crate::math::{Rgb, Vec3};
use rayon::prelude::*;

/// Records that are looked at in one task. A power of two: a record's number is that of its piece
/// and its place there.
const PIECE: usize = 1 << 13;
/// Pieces that are taken at a time: their records' numbers fit in 32 bits.
const PIECES: usize = 1 << 18;
/// Records of a leaf that are added one after the other.
const RUN: usize = 1 << 13;
/// The iteration whose leaves are divided by [`Settings::threshold`] itself.
const ITERATION: f64 = (1 << 20) as f64;
/// Marks records that cannot be used.
const USELESS: u32 = u32::MAX;

/// An SD-tree that learns.
#[derive(Clone, Debug)]
pub struct PpgTrainer {
    settings: Settings,
    space: Space,
    leaves: Vec<Leaf>,
    /// A power of two near a typical radiance; none before there was light.
    unit: Option<f32>,
    /// Records of this iteration, earlier ones as far as they are kept.
    records: f64,
}

impl PpgTrainer {
    /// A tree that knows nothing.
    ///
    /// # Errors
    /// When a setting is out of range.
    pub fn new(settings: Settings) -> Result<Self, GuideError> {
        settings.validate()?;
        let space = Space::new(&settings);
        Ok(Self {
            leaves: vec![Leaf::new(); space.roots() as usize],
            space,
            settings,
            unit: None,
            records: 0.0,
        })
    }

    /// Learns from records: every sampled direction of every vertex, dark ones included. Nothing
    /// depends on where they are cut into parts.
    pub fn train(&mut self, parts: &[impl AsRef<[PathSample]> + Sync]) {
        let all = || parts.iter().flat_map(AsRef::as_ref);
        if self.unit.is_none() {
            let typical = batch_unit(all().map(|record| record.radiance));
            self.unit = typical.map(|unit| unit.value() as f32);
        }
        let cut = |part| <_ as AsRef<[PathSample]>>::as_ref(part).chunks(PIECE);
        let pieces: Vec<&[PathSample]> = parts.iter().flat_map(cut).collect();
        for pieces in pieces.chunks(PIECES) {
            self.take(pieces);
        }
    }

    fn take(&mut self, pieces: &[&[PathSample]]) {
        let leaf_of = |record: &PathSample| self.leaf_of(record).unwrap_or(USELESS);
        let leaves_of = |piece: &&[PathSample]| piece.iter().map(leaf_of).collect();
        let places: Vec<Vec<u32>> = pieces.par_iter().map(leaves_of).collect();
        let (order, ends) = by_leaf(&places, self.leaves.len());
        drop(places);
        self.records += order.len() as f64;
        let record = |&number: &u32| &pieces[number as usize / PIECE][number as usize % PIECE];
        let (unit, settings) = (self.unit.unwrap_or(1.0), &self.settings);
        let leaves = self.leaves.par_iter_mut().enumerate();
        leaves.for_each(|(i, leaf)| {
            let own = &order[ends[i]..ends[i + 1]];
            let runs = own.par_chunks(RUN);
            let look = |run: &[u32]| leaf.look(run.iter().map(record), unit, settings);
            let added: Vec<Added> = runs.map(look).collect();
            leaf.count += own.len() as f64;
            for run in added {
                leaf.tree.take(&run.sums);
                leaf.flux += run.flux;
            }
        });
    }

    /// The leaf that learns from a record; none does if it makes no sense.
    fn leaf_of(&self, record: &PathSample) -> Option<u32> {
        let PathSample {
            position,
            direction,
            radiance,
            pdf,
            normal,
            ..
        } = *record;
        let is_unit = |v: Vec3| (v.length_squared() - 1.0).abs() < 1e-2;
        let sound = position.is_finite()
            && radiance.is_finite()
            && (pdf > 0.0 && pdf.is_finite())
            && is_unit(normal)
            && is_unit(direction)
            && unit(direction).is_some();
        if !sound {
            return None;
        }
        let (root, place) = (self.space.root(normal), self.space.place(position));
        let found = self.space.find(root, place);
        if !self.settings.spatial_filter {
            return Some(found.leaf);
        }
        let beside = place + found.sides * (random(record) - 0.5);
        Some(self.space.find(root, Space::inside(beside)).leaf)
    }

    /// What is known so far, ready to be asked.
    pub fn freeze(&self) -> SdTree {
        let target = self.settings.target;
        let unit = f64::from(self.unit.unwrap_or(1.0));
        let freeze = |leaf: &Leaf| {
            let irradiance = (leaf.flux * (unit / leaf.count.max(1.0))).as_vec3();
            match irradiance.is_finite() {
                true => (irradiance, frozen(&leaf.tree, target)),
                false => (Rgb::ZERO, Vec::new()),
            }
        };
        let known = self.leaves.par_iter().map(freeze).collect();
        SdTree::new(self.space.clone(), known, self.settings.defensive)
    }

    /// Ends an iteration: divides space and directions by what it has told, and discounts that.
    pub fn refine(&mut self) {
        self.reshape();
        let threshold = self.threshold();
        let (leaves, space) = (&mut self.leaves, &mut self.space);
        space.divide(leaves.len() as u32, |leaf, _| {
            let leaf = &mut leaves[leaf as usize];
            let divides = leaf.count > threshold;
            if divides {
                leaf.count *= 0.5;
                leaf.flux *= 0.5;
                leaf.tree.scale(0.5);
                let half = leaf.clone();
                leaves.push(half);
            }
            divides
        });
        let kept = self.settings.kept;
        self.records *= f64::from(kept);
        self.leaves.par_iter_mut().for_each(|leaf| {
            leaf.count *= f64::from(kept);
            leaf.flux *= f64::from(kept);
            leaf.tree.scale(kept);
        });
    }

    /// Divides directions anew: less far where memory is short.
    fn reshape(&mut self) {
        let mut share = self.settings.share;
        loop {
            let reshaped = |leaf: &Leaf| leaf.tree.reshaped(&self.settings, share);
            let trees: Vec<Quadtree> = self.leaves.par_iter().map(reshaped).collect();
            let bytes: u64 = trees.iter().map(|t| Leaf::EMPTY + t.bytes()).sum();
            if bytes <= self.settings.memory || share >= 1.0 {
                for (leaf, tree) in self.leaves.iter_mut().zip(trees) {
                    leaf.tree = tree;
                }
                return;
            }
            share *= 2.0;
        }
    }

    /// Records that divide a leaf: as many as leave the trees within the memory.
    fn threshold(&self) -> f64 {
        let mut threshold = self.settings.threshold * (self.records / ITERATION).sqrt();
        let halves = |leaf: &Leaf, threshold: f64| {
            let halvings = (leaf.count / threshold).log2().ceil();
            leaf.bytes() as f64 * halvings.max(0.0).exp2()
        };
        let bytes = |threshold| -> f64 { self.leaves.iter().map(|l| halves(l, threshold)).sum() };
        let least = self.bytes() as f64;
        let memory = (self.settings.memory as f64).max(least);
        while bytes(threshold) > memory && threshold < self.records {
            threshold *= 2.0;
        }
        threshold
    }

    /// The trees in numbers: a link is a cell of directions of a leaf.
    pub fn stats(&self) -> Stats {
        let cells = |leaf: &Leaf| leaf.tree.cells();
        Stats {
            space_nodes: self.space.node_count(),
            space_cells: self.leaves.len() as u64,
            links: self.leaves.iter().map(cells).sum(),
            training_bytes: self.bytes(),
            ..Stats::default()
        }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        self.space.bytes() + self.leaves.iter().map(Leaf::bytes).sum::<u64>()
    }
}

/// The records' numbers by leaf, those of each leaf in their order, and where the leaves' begin and
/// the last ends.
fn by_leaf(places: &[Vec<u32>], leaves: usize) -> (Vec<u32>, Vec<usize>) {
    let mut ends = vec![0usize; leaves + 1];
    for &leaf in places.iter().flatten().filter(|l| **l != USELESS) {
        ends[leaf as usize + 1] += 1;
    }
    for i in 1..ends.len() {
        ends[i] += ends[i - 1];
    }
    let mut next = ends.clone();
    let mut order = vec![0u32; ends[leaves]];
    for (piece, of_piece) in places.iter().enumerate() {
        for (i, &leaf) in of_piece.iter().enumerate() {
            if leaf != USELESS {
                let at = &mut next[leaf as usize];
                order[*at] = (piece * PIECE + i) as u32;
                *at += 1;
            }
        }
    }
    (order, ends)
}

/// Three uniform numbers of a record's own: whatever comes before and after it, they are the same.
fn random(record: &PathSample) -> Vec3 {
    let bits = |a: f32, b: f32| (u64::from(a.to_bits()) << 32) | u64::from(b.to_bits());
    let (p, w) = (record.position, record.direction);
    let first = hash64(bits(p.x, p.y) ^ bits(w.x, w.y).rotate_left(17) ^ u64::from(p.z.to_bits()));
    let second = hash64(first ^ u64::from(w.z.to_bits()));
    let numbers = [first >> 32, first, second].map(|bits| unit_f32(bits as u32));
    Vec3::from_array(numbers)
}
