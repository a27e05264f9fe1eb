//! The short way for the commonest material: plain diffuse reflection, one- or two-sided.
//!
//! Most vertices of most scenes are diffuse. They skip the tree of [`super::tree`]: nothing is
//! built, and what is asked at a vertex is a handful of instructions.

use super::lobes::diffuse::DiffuseLobe;
use super::model::MAX_COLOR;
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
    Diffuse(DiffuseLobe),
    /// Anything else.
    Tree(Tree),
}

impl Materials {
    /// Frame and lobe of material `id`, if it is diffuse as seen from `wo`.
    #[inline(always)]
    pub(super) fn resolve_plain(
        &self,
        id: MaterialId,
        point: &SurfacePoint,
        wo: Vec3,
    ) -> Option<(Frame, DiffuseLobe)> {
        let mut frame = point.frame;
        let mut material = &self.list.get(id as usize)?.material;
        if let Material::TwoSided { front, back } = material {
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
            material = &self.list.get(side as usize)?.material;
        }
        let Material::Diffuse(diffuse) = material else {
            return None;
        };
        let reflectance = diffuse.reflectance.eval(point);
        let reflectance = reflectance.min(Rgb::splat(MAX_COLOR));
        Some((frame, DiffuseLobe { reflectance }))
    }
}
