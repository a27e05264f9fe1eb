//! One tree over everything that stands in one space: triangles of all meshes, exact shapes,
//! instances.

use super::item::Item;
use super::plan::{Built, Plan, params};
use super::walk::{BoxRay, Next, walk};
use super::woop::ShearedRay;
use crate::accel::{Bounds, BuildSettings, Geometry, Shape};
use crate::math::Vec3;
use obvhs::cwbvh::CwBvh;

/// A geometry of the tree.
pub struct TreeGeometry {
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
    /// The corners of each leaf's triangle, beside each other; NaN where the leaf is something
    /// else. Empty for compact trees, which look them up in the mesh.
    corners: Vec<[Vec3; 3]>,
    /// Geometries that [`Item`]s point to.
    pub parts: Vec<TreeGeometry>,
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
    /// Which wall of an exact shape; 0 for triangles.
    pub wall: u32,
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
        instances: impl Iterator<Item = (u32, Bounds)>,
        settings: &BuildSettings,
    ) -> Self {
        let parts: Vec<TreeGeometry> = geometries
            .iter()
            .map(|g| TreeGeometry {
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
            if let Shape::Analytic(shape) = &part.shape {
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
            let leaf = leaf as usize;
            let known = self.corners.get(leaf).filter(|c| !c[0].x.is_nan());
            if let Some(&corners) = known {
                // Most triangles are missed, and those need no look at the item.
                return match sheared.meet(corners) {
                    Some(hit) => self.report(self.items[leaf], hit, 0, ray, &mut limit, &mut found),
                    None => Next::Within(limit),
                };
            }
            let item = [self.items[leaf]];
            let items = match item[0] {
                Item::Bundle { start, count } => &self.bundled[start as usize..][..count as usize],
                _ => &item,
            };
            for &item in items {
                let next = self.meet(item, ray, &sheared, &mut limit, &mut found);
                if let Next::Stop = next {
                    return Next::Stop;
                }
            }
            Next::Within(limit)
        });
    }

    /// Meets one item that is not a bundle.
    #[inline]
    fn meet(
        &self,
        item: Item,
        ray: &LocalRay,
        sheared: &ShearedRay,
        limit: &mut f32,
        found: &mut impl FnMut(Found, f32) -> Next,
    ) -> Next {
        let hit = match item {
            Item::Triangle { .. } => sheared.meet(corners_of(&self.parts, item)),
            Item::Analytic { part } => return self.meet_exact(part, ray, limit, found),
            Item::Instance(index) => return note(found(Found::Instance(index), *limit), limit),
            Item::Bundle { .. } => None,
        };
        match hit {
            Some(hit) => self.report(item, hit, 0, ray, limit, found),
            None => Next::Within(*limit),
        }
    }

    /// Meets an exact shape: the nearest wall, and the other one in case that a mask lets the ray
    /// through the first.
    #[inline]
    fn meet_exact(
        &self,
        part: u32,
        ray: &LocalRay,
        limit: &mut f32,
        found: &mut impl FnMut(Found, f32) -> Next,
    ) -> Next {
        let TreeGeometry { shape, masked, .. } = &self.parts[part as usize];
        let Shape::Analytic(shape) = shape else {
            return Next::Within(*limit);
        };
        let walls = if *masked { 2 } else { 1 };
        let crossings = shape.crossings(ray.org, ray.dir, ray.tmin, *limit);
        for c in crossings.take(walls) {
            let hit = (c.t, c.u, c.v);
            let next = self.report(Item::Analytic { part }, hit, c.wall, ray, limit, found);
            if let Next::Stop = next {
                return Next::Stop;
            }
        }
        Next::Within(*limit)
    }

    /// Tells the visitor of a surface, if it lies in the ray's range.
    #[inline]
    fn report(
        &self,
        item: Item,
        (t, u, v): (f32, f32, f32),
        wall: u32,
        ray: &LocalRay,
        limit: &mut f32,
        found: &mut impl FnMut(Found, f32) -> Next,
    ) -> Next {
        let (part, prim) = match item {
            Item::Triangle { part, prim } => (part, prim),
            Item::Analytic { part } => (part, 0),
            Item::Instance(_) | Item::Bundle { .. } => return Next::Within(*limit),
        };
        if !(t >= ray.tmin && t <= *limit) {
            return Next::Within(*limit);
        }
        let surface = Found::Surface(Meeting {
            t,
            u,
            v,
            part,
            prim,
            wall,
        });
        note(found(surface, *limit), limit)
    }

    /// Bytes held, without the meshes.
    pub fn memory_bytes(&self) -> usize {
        self.bvh.nodes.capacity() * 80
            + (self.items.capacity() + self.bundled.capacity()) * std::mem::size_of::<Item>()
            + self.corners.capacity() * 36
    }

    /// The box around everything; none for an empty tree.
    pub fn bounds(&self) -> Option<Bounds> {
        let whole = &self.bvh.total_aabb;
        (!self.bvh.nodes.is_empty()).then(|| Bounds {
            min: whole.min.to_array().into(),
            max: whole.max.to_array().into(),
        })
    }
}

/// Keeps a new limit.
#[inline]
fn note(next: Next, limit: &mut f32) -> Next {
    if let Next::Within(new) = next {
        *limit = new;
    }
    next
}

fn corners_of(parts: &[TreeGeometry], item: Item) -> [Vec3; 3] {
    match item {
        Item::Triangle { part, prim } => match &parts[part as usize].shape {
            Shape::Triangles(mesh) => mesh.corners(prim),
            Shape::Analytic(_) => [Vec3::NAN; 3],
        },
        _ => [Vec3::NAN; 3],
    }
}
