//! One tree over everything that stands in one space: triangles of all meshes, exact shapes, instances.

use super::plan::{Built, Plan, params};
use super::walk::{BoxRay, Next, walk};
use super::woop::ShearedRay;
use crate::accel::{BuildSettings, Geometry, Shape};
use crate::math::Vec3;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::CwBvh;

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
    /// Several items that share one box: so many from there on in the tree's list of bundled ones.
    Bundle {
        /// The first.
        start: u32,
        /// How many.
        count: u32,
    },
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
    bundled: Vec<Item>,
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
        let Built {
            bvh,
            items,
            bundled,
        } = plan.build(&params);
        let corners = if settings.compact {
            Vec::new()
        } else {
            items.iter().map(|&i| corners_of(&parts, i)).collect()
        };
        Self {
            bvh,
            items,
            bundled,
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
            let mut next = Next::Within(limit);
            let leaf = leaf as usize;
            self.each_item(leaf, |item, corners| {
                if let Some(what) = self.meet(item, corners, ray, &sheared, limit) {
                    next = found(what, limit);
                }
                match next {
                    Next::Within(new) => {
                        limit = new;
                        true
                    }
                    Next::Stop => false,
                }
            });
            next
        });
    }

    /// Calls `visit` for the item of a leaf, or for those of its bundle until it says no.
    #[inline(always)]
    fn each_item(&self, leaf: usize, mut visit: impl FnMut(Item, Option<&[Vec3; 3]>) -> bool) {
        let Item::Bundle { start, count } = self.items[leaf] else {
            visit(self.items[leaf], self.corners.get(leaf));
            return;
        };
        for item in &self.bundled[start as usize..][..count as usize] {
            if !visit(*item, None) {
                return;
            }
        }
    }

    #[inline(always)]
    fn meet(
        &self,
        item: Item,
        corners: Option<&[Vec3; 3]>,
        ray: &LocalRay,
        sheared: &ShearedRay,
        limit: f32,
    ) -> Option<Found> {
        let ((t, u, v), part, prim) = match item {
            Item::Triangle { part, prim } => {
                let corners = match corners {
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
            Item::Bundle { .. } => return None,
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
            + (self.items.capacity() + self.bundled.capacity()) * std::mem::size_of::<Item>()
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
        _ => [Vec3::ZERO; 3],
    }
}
