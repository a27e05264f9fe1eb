//! The short way for the commonest material: plain diffuse reflection, one- or two-sided.
//!
//! Most vertices of most scenes are diffuse. They skip the tree of [`super::tree`]: nothing is
//! built, and what is asked at a vertex is a handful of instructions.

use super::lobes::diffuse::Diffuse;
use super::lookup::MOST;
use super::tree::Tree;
use super::{Material, MaterialId, Materials};
use crate::math::{Frame, Rgb, Vec3};
use crate::texture::SurfacePoint;

/// What a [`super::Bsdf`] consists of.
///
/// The tree is held in place: a heap allocation at every vertex would cost more than its size.
#[allow(clippy::large_enum_variant)]
#[derive(Clone, Debug)]
pub(super) enum Form {
    /// Diffuse reflection on the side of the frame's normal.
    Diffuse(Diffuse),
    /// Anything else.
    Tree(Tree),
}

impl Materials {
    /// Frame and model of material `id`, if it is diffuse as seen from `wo`.
    #[inline(always)]
    pub(super) fn resolve_plain(
        &self,
        id: MaterialId,
        point: &SurfacePoint,
        wo: Vec3,
    ) -> Option<(Frame, Diffuse)> {
        let mut frame = point.frame;
        let mut model = &self.list.get(id as usize)?.model;
        if let Material::TwoSided { front, back } = model {
            let behind = frame.n.dot(wo) < 0.0;
            let side = if behind { *back } else { *front };
            if side >= id {
                return None;
            }
            if behind {
                // Seen from its back the surface is its own mirror image: turned, not mirrored,
                // which is the same for a lobe without a preferred tangent.
                frame = Frame {
                    s: frame.s,
                    t: -frame.t,
                    n: -frame.n,
                };
            }
            model = &self.list.get(side as usize)?.model;
        }
        let Material::Diffuse { reflectance } = model else {
            return None;
        };
        let reflectance = reflectance.eval(point).min(Rgb::splat(MOST));
        Some((frame, Diffuse { reflectance }))
    }
}
