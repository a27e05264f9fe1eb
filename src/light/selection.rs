//! What is known of the lights beside the light tree: factors for its topmost branches.
//!
//! The tree's importance knows no visibility. Whoever has sampled lights from a region of the scene
//! knows which of the tree's clusters are hidden from there (Vevoda, Kondapaneni, Krivanek,
//! "Bayesian online regression for adaptive direct illumination sampling", 2018), and weighs their
//! importance. A factor above zero keeps every light within reach: the tree is the prior.

use super::cluster::WIDTH;

/// Children that a node of the light tree has at most.
pub const CHILDREN: usize = WIDTH;

/// A factor for each of the tree's topmost clusters, all above 0 and up to 1: first the root's
/// children, then, child by child, the children of those.
pub type ClusterFactors = [[f32; CHILDREN]; 1 + CHILDREN];

/// Chooses among the children of the tree's topmost nodes. A node's number is that of its children
/// in [`ClusterFactors`].
pub trait LightSelection {
    /// The importances of a node's children, weighed by what is known of them.
    fn weighed(&self, node: usize, importance: [f32; CHILDREN]) -> [f32; CHILDREN];
    /// A child was chosen, and by how many times its probability is what the tree alone gives it.
    fn chosen(&mut self, node: usize, child: usize, ratio: impl FnOnce() -> f32);
}

/// The tree alone.
impl LightSelection for () {
    #[inline(always)]
    fn weighed(&self, _: usize, importance: [f32; CHILDREN]) -> [f32; CHILDREN] {
        importance
    }

    #[inline(always)]
    fn chosen(&mut self, _: usize, _: usize, _: impl FnOnce() -> f32) {}
}

/// The tree weighed by factors, if there are some.
impl LightSelection for Option<&ClusterFactors> {
    #[inline]
    fn weighed(&self, node: usize, mut importance: [f32; CHILDREN]) -> [f32; CHILDREN] {
        if let Some(factors) = self {
            for (w, f) in importance.iter_mut().zip(&factors[node]) {
                *w *= f;
            }
        }
        importance
    }

    #[inline]
    fn chosen(&mut self, _: usize, _: usize, _: impl FnOnce() -> f32) {}
}
