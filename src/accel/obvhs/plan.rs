//! From geometry to the boxes that a tree is built over.

use super::item::Item;
use crate::accel::{AnalyticShape, Bounds, BuildQuality, LARGEST, TriangleMesh};
use crate::math::Vec3;
use crate::math::rng::hash_all;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh};
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;
use std::sync::Arc;

/// What a [`Plan`] becomes: a tree, the items of its leaves, and those that share a box.
#[derive(Default)]
pub struct Built {
    /// The tree.
    pub bvh: CwBvh,
    /// One for each leaf, in the tree's order.
    pub items: Vec<Item>,
    /// What [`Item::Bundle`] points to.
    pub bundled: Vec<Item>,
}

/// obvhs's presets for our three qualities.
pub fn params(quality: BuildQuality) -> BvhBuildParams {
    match quality {
        BuildQuality::Fast => BvhBuildParams::very_fast_build(),
        BuildQuality::Balanced => BvhBuildParams::medium_build(),
        BuildQuality::High => BvhBuildParams::slow_build(),
    }
}

/// Boxes on their way into a tree. Box `i` belongs to item `indices[i]`: splitting a long triangle
/// gives it several boxes.
#[derive(Default)]
pub struct Plan {
    items: Vec<Item>,
    boxes: Vec<Aabb>,
    indices: Vec<u32>,
    triangles: Vec<Triangle>,
}

impl Plan {
    /// An item and its box; nothing if the box is out of range.
    pub fn add(&mut self, item: Item, bounds: Bounds) {
        let limit = Vec3::splat(LARGEST);
        // Comparisons that a NaN fails.
        if !(bounds.min.cmpge(-limit).all() && bounds.max.cmple(limit).all()) {
            return;
        }
        let index = self.items.len() as u32;
        self.indices.push(index);
        self.items.push(item);
        self.boxes.push(aabb(bounds));
    }

    /// All triangles of a mesh that can be met.
    pub fn add_mesh(&mut self, mesh: &Arc<TriangleMesh>, part: u32) {
        for prim in 0..mesh.triangles().len() as u32 {
            let corners = mesh.corners(prim);
            if !has_area(corners) {
                continue;
            }
            let before = self.items.len();
            let bounds = corners.into_iter().fold(Bounds::EMPTY, Bounds::with);
            self.add(Item::Triangle { part, prim }, bounds);
            if self.items.len() > before {
                let [v0, v1, v2] = corners.map(|c| c.to_array().into());
                self.triangles.push(Triangle { v0, v1, v2 });
            }
        }
    }

    /// An exact shape.
    pub fn add_exact(&mut self, shape: &AnalyticShape, part: u32) {
        self.add(Item::Analytic { part }, shape.bounds());
    }

    /// Splits the boxes of long triangles. Called while there are only triangles.
    pub fn split(&mut self) {
        let areas = self.boxes.iter().map(|b| f64::from(b.half_area()));
        let mean = areas.clone().sum::<f64>() / self.boxes.len().max(1) as f64;
        let largest = areas.fold(0.0, f64::max);
        split_aabbs_preset(
            &mut self.boxes,
            &mut self.indices,
            &self.triangles,
            mean as f32,
            largest as f32,
        );
        // The clipped corners are rounded: neighbours must not leave a gap between them.
        for b in &mut self.boxes {
            b.min -= b.min.abs() * (2.0 * f32::EPSILON);
            b.max += b.max.abs() * (2.0 * f32::EPSILON);
        }
    }

    /// Builds the tree.
    pub fn build(mut self, params: &BvhBuildParams) -> Built {
        if self.boxes.is_empty() {
            return Built::default();
        }
        let bundled = self.bundle();
        let mut bvh2 = params.ploc_search_distance.build(
            &self.boxes,
            (0..self.boxes.len() as u32).collect(),
            params.sort_precision,
            params.search_depth_threshold,
        );
        ReinsertionOptimizer::run(&mut bvh2, params.reinsertion_batch_ratio, None);
        // Three primitives are the most that a leaf of the compressed tree can hold.
        let mut bvh = bvh2_to_cwbvh(&bvh2, params.max_prims_per_leaf.clamp(1, 3), true, false);
        let order = std::mem::take(&mut bvh.primitive_indices);
        let item = |&i: &u32| self.items[self.indices[i as usize] as usize];
        Built {
            items: order.iter().map(item).collect(),
            bvh,
            bundled,
        }
    }

    /// Leaves one box where many are the same, and returns the items behind it.
    ///
    /// The builder joins the neighbours whose common box is smallest. Among equal boxes all of them
    /// choose the neighbour on the same side and one pair is joined per pass: ten thousand
    /// triangles in one place would take seconds, a million for ever.
    fn bundle(&mut self) -> Vec<Item> {
        let mut order: Vec<(u64, u32)> = self.boxes.iter().map(hash_of).zip(0..).collect();
        order.sort_unstable();
        let mut bundled = Vec::new();
        let mut keep = vec![true; self.boxes.len()];
        for same in order.chunk_by(|a, b| a.0 == b.0) {
            if same.len() <= MOST_EQUAL {
                continue;
            }
            let start = bundled.len() as u32;
            let mut whole = Aabb::empty();
            for &(_, i) in same {
                bundled.push(self.items[self.indices[i as usize] as usize]);
                whole = whole.union(&self.boxes[i as usize]);
                keep[i as usize] = false;
            }
            let first = same[0].1 as usize;
            keep[first] = true;
            self.boxes[first] = whole;
            self.indices[first] = self.items.len() as u32;
            let count = same.len() as u32;
            self.items.push(Item::Bundle { start, count });
        }
        let mut kept = keep.iter();
        self.boxes.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = keep.iter();
        self.indices.retain(|_| *kept.next().unwrap_or(&true));
        bundled
    }
}

/// So many equal boxes are left to the builder.
const MOST_EQUAL: usize = 4;

/// A hash of a box's bits. Where two boxes share it by chance, their bundle gets a box around both.
fn hash_of(b: &Aabb) -> u64 {
    let bits = |v: [f32; 3]| v.map(|c| u64::from(c.to_bits()));
    let ([a, b, c], [d, e, f]) = (bits(b.min.to_array()), bits(b.max.to_array()));
    hash_all([a | b << 32, c | d << 32, e | f << 32])
}

/// Whether a triangle can be met: finite corners that are not in a line.
fn has_area(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners.map(|v| v.as_dvec3());
    // NaN and infinity fail the comparison.
    let doubled = (b - a).cross(c - a).length_squared();
    doubled > 0.0 && doubled < f64::INFINITY
}

/// Our box as obvhs's. Its vectors are of another version of glam than ours: they meet as arrays.
fn aabb(b: Bounds) -> Aabb {
    Aabb::new(b.min.to_array().into(), b.max.to_array().into())
}
