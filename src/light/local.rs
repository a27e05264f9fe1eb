//! The lights in the scene, and how one of them is chosen.

use super::EmitterId;
use super::leaf::Leaf;
use super::nearby::Nearby;
use super::selection::LightSelection;
use super::tree::LightTree;
use crate::math::distribution::widen;
use crate::math::{Vec2, Vec3};

/// The lights in the scene.
#[derive(Debug)]
pub(super) struct Local {
    pub leaves: Vec<(EmitterId, Leaf)>,
    pub tree: LightTree,
    /// Strengths in the tree are relative to this, so that no product of them leaves the range of
    /// `f32`.
    pub unit: f32,
    /// The strongest of the leaves, in order.
    pub strongest: Vec<Nearby>,
}

impl Local {
    /// Chooses a leaf that may send light to `p`.
    #[inline]
    pub fn choose(
        &self,
        (p, n): (Vec3, Vec3),
        selection: &mut impl LightSelection,
        pick: f32,
        u: Vec2,
    ) -> Option<(usize, f32)> {
        if self.leaves.len() == 1 {
            return Some((0, 1.0));
        }
        // 24 bits are too few to tell millions of lights apart: the others' hash extends them.
        let salt = u64::from(u.x.to_bits()) << 32 | u64::from(u.y.to_bits());
        let wide = widen(pick, salt) >> 11;
        let u = wide as f64 * (1.0 / (1u64 << 53) as f64);
        self.tree.sample(p, n, selection, u)
    }

    /// A leaf, if it is among the strongest.
    pub fn nearby(&self, leaf: u32) -> Option<&Nearby> {
        let lights = &self.strongest;
        let place = lights.binary_search_by_key(&leaf, |light| light.leaf);
        place.ok().map(|place| &lights[place])
    }
}
