//! One tree over everything that stands in one space: triangles of all meshes, exact shapes, instances.

use super::walk::{BoxRay, Next, walk};
use super::woop::ShearedRay;
use crate::accel::{
    BuildQuality, BuildSettings, ExactShape, Geometry, LARGEST, Shape, TriangleMesh,
};
use crate::math::{Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh};
use obvhs::ploc::PlocBuilder;
use obvhs::splits::split_aabbs_preset;
use obvhs::triangle::Triangle;
use std::sync::Arc;

/// What a leaf holds.
#[derive(Clone, Copy, Debug)]
pub enum Item {
    /// Triangle `prim` of part `part`.
    Triangle {
        /// Index into the tree's parts.
        part: u32,
        /// Index into the mesh.
        prim: u32,
    },
    /// The exact shape of a part.
    Exact {
        /// Index into the tree's parts.
        part: u32,
    },
    /// An instance, by its index in the world.
    Instance(u32),
}

/// A geometry of the tree.
pub struct Part {
    /// The caller's number.
    pub id: u32,
    /// Ask for opacity.
    pub masked: bool,
    shape: Shape,
}

/// The tree, its leaves in the order of its nodes.
pub struct Tree {
    bvh: CwBvh,
    items: Vec<Item>,
    /// The corners of each leaf's triangle, beside each other; empty for compact trees, which look
    /// them up in the mesh.
    corners: Vec<[Vec3; 3]>,
    /// Geometries that [`Item`]s point to.
    pub parts: Vec<Part>,
}

/// Where a ray meets an item.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// Distance in lengths of the direction.
    pub t: f32,
    /// First surface coordinate.
    pub u: f32,
    /// Second surface coordinate.
    pub v: f32,
    /// Index into [`Tree::parts`].
    pub part: u32,
    /// Triangle, or 0.
    pub prim: u32,
}

/// A ray in the space of one tree.
pub struct LocalRay {
    /// Origin.
    pub org: Vec3,
    /// Direction of any length.
    pub dir: Vec3,
    /// Smallest distance that counts.
    pub tmin: f32,
}

/// What a visitor of [`Tree::visit`] is given.
pub enum Found {
    /// A surface.
    Surface(Meeting),
    /// An instance's box.
    Instance(u32),
}

impl Tree {
    /// Builds the tree of `geometries`, and of instances by their boxes.
    pub fn build(
        geometries: &[Geometry],
        instances: impl Iterator<Item = (u32, Aabb)>,
        settings: &BuildSettings,
    ) -> Self {
        let parts: Vec<Part> = geometries
            .iter()
            .map(|g| Part {
                id: g.id,
                masked: g.masked,
                shape: g.shape.clone(),
            })
            .collect();
        let mut plan = Plan::default();
        for (index, part) in parts.iter().enumerate() {
            if let Shape::Triangles(mesh) = &part.shape {
                plan.add_mesh(mesh, index as u32);
            }
        }
        let params = params(settings.quality);
        if params.pre_split {
            plan.split();
        }
        for (index, part) in parts.iter().enumerate() {
            if let Shape::Exact(shape) = &part.shape {
                plan.add_exact(shape, index as u32);
            }
        }
        for (index, bounds) in instances {
            plan.add(Item::Instance(index), bounds);
        }
        let (bvh, items) = plan.build(&params);
        let corners = if settings.compact {
            Vec::new()
        } else {
            items.iter().map(|&i| corners_of(&parts, i)).collect()
        };
        Self {
            bvh,
            items,
            corners,
            parts,
        }
    }

    /// Calls `found` for all that `ray` meets within `limit`, roughly nearest first.
    #[inline]
    pub fn visit(&self, ray: &LocalRay, limit: f32, mut found: impl FnMut(Found, f32) -> Next) {
        let boxes = BoxRay::new(ray.org, ray.dir, ray.tmin);
        let sheared = ShearedRay::new(ray.org, ray.dir);
        let mut limit = limit;
        walk(&self.bvh, &boxes, limit, |leaf| {
            let Some(what) = self.meet(leaf as usize, ray, &sheared, limit) else {
                return Next::Within(limit);
            };
            let next = found(what, limit);
            if let Next::Within(new) = next {
                limit = new;
            }
            next
        });
    }

    #[inline]
    fn meet(&self, leaf: usize, ray: &LocalRay, sheared: &ShearedRay, limit: f32) -> Option<Found> {
        let item = self.items[leaf];
        let ((t, u, v), part, prim) = match item {
            Item::Triangle { part, prim } => {
                let corners = match self.corners.get(leaf) {
                    Some(corners) => *corners,
                    None => corners_of(&self.parts, item),
                };
                (sheared.meet(corners)?, part, prim)
            }
            Item::Exact { part } => {
                let Shape::Exact(shape) = &self.parts[part as usize].shape else {
                    return None;
                };
                let hit = shape.intersect(ray.org, ray.dir, ray.tmin, limit)?;
                (hit, part, 0)
            }
            Item::Instance(index) => return Some(Found::Instance(index)),
        };
        (t >= ray.tmin && t <= limit).then_some(Found::Surface(Meeting {
            t,
            u,
            v,
            part,
            prim,
        }))
    }

    /// Bytes held, without the meshes.
    pub fn memory_bytes(&self) -> usize {
        self.bvh.nodes.capacity() * 80
            + self.items.capacity() * std::mem::size_of::<Item>()
            + self.corners.capacity() * 36
    }

    /// The box around everything; none for an empty tree.
    pub fn bounds(&self) -> Option<Aabb> {
        (!self.bvh.nodes.is_empty()).then_some(self.bvh.total_aabb)
    }
}

fn corners_of(parts: &[Part], item: Item) -> [Vec3; 3] {
    match item {
        Item::Triangle { part, prim } => match &parts[part as usize].shape {
            Shape::Triangles(mesh) => mesh.corners(prim),
            Shape::Exact(_) => [Vec3::ZERO; 3],
        },
        Item::Exact { .. } | Item::Instance(_) => [Vec3::ZERO; 3],
    }
}

/// obvhs's presets for our three qualities.
fn params(quality: BuildQuality) -> BvhBuildParams {
    match quality {
        BuildQuality::Fast => BvhBuildParams::very_fast_build(),
        BuildQuality::Balanced => BvhBuildParams::medium_build(),
        BuildQuality::High => BvhBuildParams::slow_build(),
    }
}

/// Boxes on their way into a tree. Box `i` belongs to item `indices[i]`: splitting a long triangle
/// gives it several boxes.
#[derive(Default)]
struct Plan {
    items: Vec<Item>,
    boxes: Vec<Aabb>,
    indices: Vec<u32>,
    triangles: Vec<Triangle>,
}

impl Plan {
    fn add(&mut self, item: Item, bounds: Aabb) {
        let limit = Vec3A::splat(LARGEST);
        // Comparisons that a NaN fails.
        if !(bounds.min.cmpge(-limit).all() && bounds.max.cmple(limit).all()) {
            return;
        }
        self.indices.push(self.items.len() as u32);
        self.items.push(item);
        self.boxes.push(bounds);
    }

    fn add_mesh(&mut self, mesh: &Arc<TriangleMesh>, part: u32) {
        for prim in 0..mesh.triangles().len() as u32 {
            let [v0, v1, v2] = mesh.corners(prim).map(Vec3A::from);
            // min and max of a NaN and a number are the number: the corners are asked one by one.
            if !(v0.is_finite() && v1.is_finite() && v2.is_finite()) {
                continue;
            }
            let before = self.items.len();
            let bounds = Aabb::from_points(&[v0, v1, v2]);
            self.add(Item::Triangle { part, prim }, bounds);
            if self.items.len() > before {
                self.triangles.push(Triangle { v0, v1, v2 });
            }
        }
    }

    fn add_exact(&mut self, shape: &ExactShape, part: u32) {
        let b = shape.bounds();
        self.add(Item::Exact { part }, Aabb::new(b.min.into(), b.max.into()));
    }

    /// Splits the boxes of long triangles. Called while there are only triangles.
    fn split(&mut self) {
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

    fn build(self, params: &BvhBuildParams) -> (CwBvh, Vec<Item>) {
        if self.boxes.is_empty() {
            return (CwBvh::default(), Vec::new());
        }
        drop(self.triangles);
        let split = self.boxes.len() > self.items.len();
        let mut bvh2 = PlocBuilder::with_capacity(self.boxes.len()).build(
            params.ploc_search_distance,
            &self.boxes,
            self.indices,
            params.sort_precision,
            params.search_depth_threshold,
        );
        bvh2.uses_spatial_splits = split;
        ReinsertionOptimizer::default().run(&mut bvh2, params.reinsertion_batch_ratio, None);
        // Three primitives are the most that a leaf of the compressed tree can hold.
        let mut bvh = bvh2_to_cwbvh(&bvh2, params.max_prims_per_leaf.clamp(1, 3), true, false);
        let order = std::mem::take(&mut bvh.primitive_indices);
        let items = order.iter().map(|&i| self.items[i as usize]).collect();
        (bvh, items)
    }
}
