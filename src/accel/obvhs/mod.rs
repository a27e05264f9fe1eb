//! Rays through a tree in pure Rust, built by the crate obvhs: the second answer to every question
//! that Embree answers, and the only one where Embree is not installed.
//!
//! | file | idea |
//! |---|---|
//! | `plan` | from geometry to boxes, and from boxes to a tree |
//! | `tree` | one tree over all that stands in one space |
//! | `walk` | which leaves a ray meets, without losing one to rounding |
//! | `woop` | a ray and a triangle, watertight |

mod item;
mod plan;
mod tree;
mod walk;
mod woop;

use super::world::{check, transformed, world_bounds};
use super::{
    AccelError, Bounds, BuildSettings, Hit, NO_INSTANCE, Opacity, Ray, RayQuery, World, mask,
};
use crate::math::Affine3A;
use std::sync::Arc;
use tree::{Found, LocalRay, Meeting, Tree};
use walk::Next;

/// obvhs behind [`RayQuery`].
///
/// Always watertight: [`BuildSettings::robust`] changes nothing. Builds on one thread.
pub struct Obvhs {
    world: Tree,
    groups: Vec<Tree>,
    placed: Vec<Placed>,
    opacity: Option<Arc<dyn Opacity>>,
    bounds: Bounds,
    settings: BuildSettings,
}

/// An instance: which group, and the way into its space.
struct Placed {
    group: u32,
    to_group: Affine3A,
}

impl Obvhs {
    /// Builds the trees. Arguments and errors as for Embree.
    ///
    /// # Errors
    /// An instance without its group or with a singular transformation.
    pub fn build(
        world: World,
        settings: BuildSettings,
        opacity: Option<Arc<dyn Opacity>>,
    ) -> Result<Self, AccelError> {
        check(&world)?;
        too_many(&world)?;
        let groups: Vec<Tree> = world
            .groups
            .iter()
            .map(|group| Tree::build(group, std::iter::empty(), &settings))
            .collect();
        let boxes = world.instances.iter().enumerate().filter_map(|(i, p)| {
            let b = groups.get(p.group as usize)?.bounds()?;
            Some((i as u32, padded(transformed(b, &p.to_world))))
        });
        let tree = Tree::build(&world.geometries, boxes, &settings);
        let placed = world.instances.iter().map(|i| Placed {
            group: i.group,
            to_group: i.to_world.inverse(),
        });
        Ok(Self {
            world: tree,
            placed: placed.collect(),
            groups,
            opacity,
            bounds: world_bounds(&world),
            settings,
        })
    }

    /// The caller's hit for a meeting in `tree`, or none where the mask lets the ray through.
    #[inline]
    fn accept(&self, tree: &Tree, m: &Meeting, instance: u32, ray: &Ray) -> Option<Hit> {
        let part = &tree.parts[m.part as usize];
        let hit = Hit {
            t: m.t,
            u: m.u,
            v: m.v,
            prim: m.prim,
            shape: part.id,
            instance,
        };
        match &self.opacity {
            Some(opacity) if part.masked => {
                mask::keeps(&**opacity, ray, &hit, m.wall).then_some(hit)
            }
            _ => Some(hit),
        }
    }

    /// The ray in the space of an instance, and that instance's tree.
    #[inline]
    fn enter(&self, instance: u32, ray: &Ray) -> (&Tree, LocalRay) {
        let placed = &self.placed[instance as usize];
        let local = LocalRay {
            org: placed.to_group.transform_point3(ray.org),
            dir: placed.to_group.transform_vector3(ray.dir),
            tmin: ray.tmin.max(0.0),
        };
        (&self.groups[placed.group as usize], local)
    }

    /// Visits surfaces in `tree`; `best` keeps the nearest.
    #[inline]
    fn closest(&self, tree: &Tree, local: &LocalRay, instance: u32, ray: &Ray, best: &mut Hit) {
        tree.visit(local, best.t.min(ray.tmax), |found, limit| {
            match found {
                // Of two at the same distance the first one stays.
                Found::Surface(m) if m.t < best.t => {
                    *best = self.accept(tree, &m, instance, ray).unwrap_or(*best);
                }
                Found::Surface(_) => {}
                Found::Instance(index) => {
                    let (inner, moved) = self.enter(index, ray);
                    self.closest(inner, &moved, index, ray, best);
                }
            }
            Next::Within(limit.min(best.t))
        });
    }

    /// Whether anything in `tree` blocks the ray.
    #[inline]
    fn blocks(&self, tree: &Tree, local: &LocalRay, instance: u32, ray: &Ray) -> bool {
        let mut blocked = false;
        tree.visit(local, ray.tmax, |found, limit| {
            blocked = match found {
                Found::Surface(m) => self.accept(tree, &m, instance, ray).is_some(),
                Found::Instance(index) => {
                    let (inner, moved) = self.enter(index, ray);
                    self.blocks(inner, &moved, index, ray)
                }
            };
            if blocked {
                Next::Stop
            } else {
                Next::Within(limit)
            }
        });
        blocked
    }
}

impl RayQuery for Obvhs {
    fn intersect(&self, ray: &Ray) -> Hit {
        let mut best = Hit::NONE;
        if let Some(local) = localize(ray) {
            self.closest(&self.world, &local, NO_INSTANCE, ray, &mut best);
        }
        best
    }

    fn occluded(&self, ray: &Ray) -> bool {
        localize(ray).is_some_and(|local| self.blocks(&self.world, &local, NO_INSTANCE, ray))
    }

    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn memory_bytes(&self) -> usize {
        self.world.memory_bytes() + self.groups.iter().map(Tree::memory_bytes).sum::<usize>()
    }

    fn settings(&self) -> BuildSettings {
        self.settings
    }

    fn name(&self) -> String {
        "obvhs 0.2".into()
    }
}

/// The ray itself, if it can be traced.
#[inline]
fn localize(ray: &Ray) -> Option<LocalRay> {
    ray.is_traceable().then(|| LocalRay {
        org: ray.org,
        dir: ray.dir,
        tmin: ray.tmin.max(0.0),
    })
}

/// Room for the rounding of a box's and of a ray's transformation.
fn padded(b: Bounds) -> Bounds {
    let pad = (b.min.abs().max(b.max.abs()) + (b.max - b.min)) * (8.0 * f32::EPSILON);
    Bounds {
        min: b.min - pad,
        max: b.max + pad,
    }
}

/// Leaves are numbered with 32 bits, and splitting may double them.
fn too_many(world: &World) -> Result<(), AccelError> {
    let count = |geometries: &[super::Geometry]| -> usize {
        let one = |g: &super::Geometry| match &g.shape {
            super::Shape::Triangles(mesh) => mesh.triangles().len(),
            super::Shape::Analytic(_) => 1,
        };
        geometries.iter().map(one).sum()
    };
    let loose = count(&world.geometries) + world.instances.len();
    let largest = world
        .groups
        .iter()
        .map(|g| count(g))
        .fold(loose, usize::max);
    if largest >= (u32::MAX / 2) as usize {
        return Err(AccelError::TooMany {
            what: "primitives of one tree",
            count: largest,
        });
    }
    Ok(())
}
